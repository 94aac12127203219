"""The fourth interpretation: formulas as terms of Coq over its standard library's real numbers.

The operations that Coq lacks are defined in ``proofs_checks/kernel/Arithmetic.v``. An integer parameter is a natural
number there, a table of counts a list of them; an argument that only an expression gives is made whole by ``whole``.
"""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce
from itertools import groupby
from typing import Any

from bridge_theory.arithmetic.protocol import FloatArray, Value
from bridge_theory.parameters import Parameter, parameter
from bridge_theory.terms import combined

_SUM, _PRODUCT, _POWER, _APPLIED, _CLOSED = range(5)
_TAKEN = {"R"}  # the type of the reals; a variable of that name would hide it


@dataclass(frozen=True)
class Term:
    """The text of a real-valued term, how tightly its outermost operation binds, and the natural number it is."""

    text: str
    binds: int = _CLOSED
    natural: str = ""

    def within(self, binds: int) -> str:
        """The text, in parentheses unless it binds at least as tightly as ``binds``."""
        return self.text if self.binds >= binds else f"({self.text})"

    def __add__(self, other: Value) -> Term:
        return _infix(self, "+", other, _SUM)

    def __radd__(self, other: Value) -> Term:
        return _infix(other, "+", self, _SUM)

    def __sub__(self, other: Value) -> Term:
        return _infix(self, "-", other, _SUM)

    def __rsub__(self, other: Value) -> Term:
        return _infix(other, "-", self, _SUM)

    def __mul__(self, other: Value) -> Term:
        return _infix(self, "*", other, _PRODUCT)

    def __rmul__(self, other: Value) -> Term:
        return _infix(other, "*", self, _PRODUCT)

    def __truediv__(self, other: Value) -> Term:
        return _infix(self, "/", other, _PRODUCT)

    def __rtruediv__(self, other: Value) -> Term:
        return _infix(other, "/", self, _PRODUCT)

    def __neg__(self) -> Term:
        return Term(f"(- {self.within(_POWER)})")

    def __pow__(self, exponent: Value) -> Term:
        if isinstance(exponent, int) and exponent >= 0:
            return Term(f"{self.within(_APPLIED)} ^ {exponent}", _POWER)
        return NotImplemented


def natural(name: str) -> Term:
    """A variable that is a natural number, as a real.

    >>> (2 * natural("n") - 1).text
    '2 * INR n - 1'
    """
    return Term(f"INR {name}", _APPLIED, name)


def _term(x: Value) -> Term:
    if isinstance(x, Term):
        return x
    if isinstance(x, int | Fraction):
        return number(x)
    raise TypeError(f"a term of Coq is made of terms and exact numbers, got {x!r}")


def number(value: int | Fraction) -> Term:
    """An exact constant.

    >>> number(3).text, number(Fraction(-1, 2)).text
    ('3', '(- (1 / 2))')
    """
    if value < 0:
        return -number(-value)
    numerator, denominator = value.numerator, value.denominator
    return Term(str(numerator)) if denominator == 1 else Term(f"{numerator} / {denominator}", _PRODUCT)


def _infix(x: Value, sign: str, y: Value, binds: int) -> Term:
    return Term(f"{_term(x).within(binds)} {sign} {_term(y).within(binds + 1)}", binds)


def _apply(name: str, *arguments: Value) -> Term:
    return Term(" ".join([name, *(_term(argument).within(_CLOSED) for argument in arguments)]), _APPLIED)


def _function(inputs: str, body: Value) -> str:
    return f"(fun {inputs} => {_term(body).text})"


class CoqTerms:
    """Every value is a ``Term``; an array-valued argument is a ``Table``."""

    def __init__(self) -> None:
        self.definitions: dict[str, str] = {}

    def number(self, value: int | Fraction) -> Value:
        return number(value)

    def power(self, x: Value, exponent: Value) -> Value:
        if not _term(exponent).natural:
            raise TypeError(f"an exponent must be a natural variable, got {_term(exponent).text}")
        return Term(f"{_term(x).within(_APPLIED)} ^ {exponent.natural}", _POWER)

    def power_near_one(self, x: Value, exponent: Value) -> Value:
        return self.power(1 + x, exponent)

    def sqrt(self, x: Value) -> Value:
        return _apply("sqrt", x)

    def log(self, x: Value) -> Value:
        return _apply("ln", x)

    def log1p(self, x: Value) -> Value:
        return _apply("ln", 1 + _term(x))

    def log1p_ratio(self, x: Value, y: Value) -> Value:
        return self.log1p(x) / self.log1p(y)

    def exp(self, x: Value) -> Value:
        return _apply("exp", x)

    def expm1(self, x: Value) -> Value:
        return _apply("exp", x) - 1

    def one_minus_root(self, x: Value, degree: Value) -> Value:
        return 1 - _apply("Rpower", x, 1 / _term(degree))

    def cosh(self, x: Value) -> Value:
        return _apply("cosh", x)

    def sin(self, x: Value) -> Value:
        return _apply("sin", x)

    def arcsin(self, x: Value) -> Value:
        return _apply("asin", x)

    def arccos(self, x: Value) -> Value:
        return _apply("acos", x)

    def pi(self) -> Value:
        return Term("PI")

    def min(self, *values: Value) -> Value:
        return reduce(lambda x, y: _apply("Rmin", x, y), values)

    def max(self, *values: Value) -> Value:
        return reduce(lambda x, y: _apply("Rmax", x, y), values)

    def ceil(self, x: Value) -> Value:
        return _apply("ceiling", x)

    def log_binomial(self, top: Value, bottom: Value) -> Value:
        return _apply("log_binomial", top, bottom)

    def if_at_most(self, x: Value, y: Value, then: Callable[[], Value], otherwise: Callable[[], Value]) -> Value:
        return _apply("if_at_most", x, y, then(), otherwise())

    def sum(self, summand: Callable[..., Value], *arrays: Value) -> Value:
        names = list(inspect.signature(summand).parameters)
        cells = [natural(name) if array.integer else Term(name) for name, array in zip(names, arrays, strict=True)]
        function = _function(" ".join(names), summand(*cells))
        suffix = "" if len(arrays) == 1 else str(len(arrays))
        return Term(" ".join([f"sum_over{suffix}", function, *(array.name for array in arrays)]), _APPLIED)

    def minimum_over_integers(
        self,
        objective: Callable[[Value], Value],
        step: Callable[[Value], Value],
        near: Callable[..., FloatArray],
        *arguments: Value,
    ) -> Value:
        return Term(f"least_over_positive {_function('k', objective(natural('k')))}", _APPLIED)

    def applied(self, formula: Any, values: Mapping[str, Value]) -> Value:
        """One formula in terms of another: the name of its definition, applied."""
        self.define(formula)
        return Term(" ".join([formula.name, *(_argument(name, values[name]) for name in formula.parameters)]), _APPLIED)

    def define(self, formula: Any) -> None:
        """Add the definition of a formula, after those it uses."""
        if formula.name in self.definitions:
            return
        rows = [parameter(name) for name in formula.parameters]
        body = combined(self, formula.function(self, **{row.name: _variable(row) for row in rows}))
        groups = groupby(rows, _type)
        binders = "".join(f" ({' '.join(map(_name, group))} : {kind})" for kind, group in groups)
        lines = textwrap.wrap(_term(body).text, 116, break_long_words=False, break_on_hyphens=False)
        self.definitions[formula.name] = "\n  ".join([f"Definition {formula.name}{binders} : R :=", *lines]) + "."


@dataclass(frozen=True)
class Table:
    """A parameter with one entry per cell."""

    name: str
    integer: bool = field(compare=False)


def _name(row: Parameter) -> str:
    return f"{row.name}_" if row.name in _TAKEN else row.name


def _type(row: Parameter) -> str:
    entry = "nat" if row.domain.integer else "R"
    return f"list {entry}" if row.array else entry


def _variable(row: Parameter) -> Term | Table:
    if row.array:
        return Table(_name(row), row.domain.integer)
    return natural(_name(row)) if row.domain.integer else Term(_name(row))


def _argument(name: str, value: Value) -> str:
    if isinstance(value, Table):
        return value.name
    term, row = _term(value), parameter(name)
    if not row.domain.integer:
        return term.within(_CLOSED)
    if isinstance(value, int):
        return term.text
    return term.natural or f"(whole {term.within(_CLOSED)})"
