"""The SymPy interpretation: formulas as expressions, for LaTeX, limits and derivatives. Loaded only when asked for."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import sympy

from bridge_theory.arithmetic.protocol import FloatArray, Value


class MinimumOverIntegers(sympy.Function):  # type: ignore[misc]  # SymPy is untyped
    r"""``min_{k >= 1} objective(k)`` as an unevaluated expression ``MinimumOverIntegers(objective, k)``.

    Source: the infimum over covers in the audit's T6(ii) and T11. Arguments: an expression that strictly falls and then
    strictly rises in ``k``, and the symbol ``k``. Returns on ``evalf`` the minimum, found by exact bisection over the
    integers on high-precision values. Errors: none.

    >>> k = sympy.Symbol("k", positive=True, integer=True)
    >>> MinimumOverIntegers(k + sympy.Integer(10) / k, k).evalf()
    6.33333333333333
    """

    nargs = 2
    is_real = True  # so that a comparison of numbers is decided

    @property
    def is_number(self) -> bool:
        return not self.free_symbols

    @property
    def free_symbols(self) -> set[sympy.Symbol]:
        return set(self.args[0].free_symbols) - {self.args[1]}

    def _eval_subs(self, old: Value, new: Value) -> Value:
        objective, k = self.args
        return self if old == k else MinimumOverIntegers(objective.subs(old, new), k)

    def _eval_evalf(self, precision: int) -> Value:
        if self.free_symbols:
            return None
        digits = (
            2 * int(precision * 0.30103) + 20
        )  # the objective is flat at its minimum: differences need twice as many

        def value(k: int) -> Value:
            return self.args[0].subs(self.args[1], k).evalf(digits)

        high = 1
        while value(high + 1) < value(high):
            high *= 2
        low = max(1, high // 2)
        while low < high:
            middle = (low + high) // 2
            if value(middle + 1) < value(middle):
                low = middle + 1
            else:
                high = middle
        return sympy.Float(value(low), precision=precision)

    def _latex(self, printer: Value) -> str:
        objective, k = (printer._print(part) for part in self.args)
        return rf"\min_{{{k} \geq 1}} \left[ {objective} \right]"


class Root(sympy.Function):  # type: ignore[misc]  # SymPy is untyped
    r"""``x ** (1 / degree)`` as an unevaluated expression: SymPy would write a rational root out.

    Source: elementary. Arguments: ``x`` > 0 and ``degree`` > 0. Returns on ``evalf`` the root, on ``doit`` the power.
    Errors: none.

    >>> Root(sympy.Rational(1, 4), 2).evalf()
    0.500000000000000
    >>> Root(sympy.Symbol("x"), 1), Root(sympy.Integer(1), sympy.Symbol("n"))
    (x, 1)
    """

    nargs = 2
    is_real = True  # so that a comparison of numbers is decided

    @classmethod
    def eval(cls, x: Value, degree: Value) -> Value:
        return x if degree == 1 or x == 1 else None

    def doit(self, **hints: Value) -> Value:
        x, degree = self.args
        return x ** (1 / degree)

    def fdiff(self, argindex: int = 1) -> Value:
        x, degree = self.args
        return self / (x * degree) if argindex == 1 else -self * sympy.log(x) / degree**2

    def _eval_is_positive(self) -> Value:
        return self.args[0].is_positive

    def _eval_evalf(self, precision: int) -> Value:
        if self.free_symbols:
            return None
        x, degree = (part.evalf(int(precision * 0.30103) + 20) for part in self.args)
        return sympy.Float(sympy.exp(sympy.log(x) / degree), precision=precision)

    def _latex(self, printer: Value, exp: Value = None) -> str:
        return str(printer._print(self.doit() if exp is None else self.doit() ** exp))


class Symbols:
    """Every value is a SymPy expression; array-valued arguments are ``IndexedBase`` objects or tuples of numbers."""

    def number(self, value: int | Fraction) -> Value:
        return sympy.Rational(value.numerator, value.denominator)

    def power(self, x: Value, exponent: Value) -> Value:
        return x**exponent

    def power_near_one(self, x: Value, exponent: Value) -> Value:
        return (1 + x) ** exponent

    def sqrt(self, x: Value) -> Value:
        return sympy.sqrt(x)

    def log(self, x: Value) -> Value:
        return sympy.log(x)

    def log1p(self, x: Value) -> Value:
        return sympy.log(1 + x)

    def log1p_ratio(self, x: Value, y: Value) -> Value:
        return self.log1p(x) / self.log1p(y)

    def exp(self, x: Value) -> Value:
        return sympy.exp(x)

    def expm1(self, x: Value) -> Value:
        return sympy.exp(x) - 1

    def one_minus_root(self, x: Value, degree: Value) -> Value:
        return 1 - Root(x, degree)

    def cosh(self, x: Value) -> Value:
        return sympy.cosh(x)

    def sin(self, x: Value) -> Value:
        return sympy.sin(x)

    def arcsin(self, x: Value) -> Value:
        return sympy.asin(x)

    def arccos(self, x: Value) -> Value:
        return sympy.acos(x)

    def pi(self) -> Value:
        return sympy.pi

    def min(self, *values: Value) -> Value:
        return sympy.Min(*values)

    def max(self, *values: Value) -> Value:
        return sympy.Max(*values)

    def ceil(self, x: Value) -> Value:
        return sympy.ceiling(x)

    def log_binomial(self, top: Value, bottom: Value) -> Value:
        return sympy.log(sympy.binomial(top, bottom))

    def if_at_most(self, x: Value, y: Value, then: Callable[[], Value], otherwise: Callable[[], Value]) -> Value:
        condition = sympy.Le(x, y)
        if condition in (True, False):  # numbers: the other branch may have no value at all
            return then() if condition else otherwise()
        return sympy.Piecewise((then(), condition), (otherwise(), True))

    def sum(self, summand: Callable[..., Value], *arrays: Value) -> Value:
        if isinstance(arrays[0], tuple):
            return sympy.Add(*(summand(*map(self.number, cell)) for cell in zip(*arrays, strict=True)))
        i, cells = sympy.Symbol("i", integer=True, positive=True), sympy.Symbol("K", integer=True, positive=True)
        return sympy.Sum(summand(*(array[i] for array in arrays)), (i, 1, cells))

    def minimum_over_integers(
        self,
        objective: Callable[[Value], Value],
        step: Callable[[Value], Value],
        near: Callable[..., FloatArray],
        *arguments: Value,
    ) -> Value:
        k = sympy.Symbol("k", integer=True, positive=True)
        return MinimumOverIntegers(objective(k), k)


SYMBOLS = Symbols()
