"""SymPy identities: the difference of two sides simplifies to zero."""

from __future__ import annotations

from typing import Any

import sympy

from proofs_checks.outcome import Outcome

_POINTS = (sympy.Rational(3, 7), sympy.Rational(11, 5), sympy.Rational(29, 9), sympy.Rational(1, 8))


def identity(name: str, left: Any, right: Any) -> Outcome:
    """Whether two expressions are equal for all values of their symbols.

    >>> x = sympy.Symbol("x", positive=True)
    >>> identity("square", (x + 1) ** 2, x**2 + 2 * x + 1).holds
    True
    >>> identity("square", (x + 1) ** 2, x**2 + 1).failures
    ('square: the sides differ by 0.857143 at x = 3/7',)
    """
    difference = left - right
    symbols = sorted(difference.free_symbols, key=str)
    for shift in range(len(_POINTS)):  # a point where the sides differ is found faster than a simplification fails
        point = {symbol: _POINTS[(i + shift) % len(_POINTS)] for i, symbol in enumerate(symbols)}
        value = sympy.N(difference.subs(point), 40)
        if value.is_number and abs(value) > sympy.Float("1e-25"):
            where = ", ".join(f"{symbol} = {number}" for symbol, number in point.items())
            number = float(value) if value.is_real else complex(value)
            return Outcome(1, (f"{name}: the sides differ by {number:.6g} at {where}",))
    if simplified_to_zero(difference):
        return Outcome(1, details=f"{name}: identical")
    return Outcome(1, (f"{name}: SymPy cannot reduce the difference to zero",))


def simplified_to_zero(difference: Any) -> bool:
    """Whether SymPy reduces the expression to 0, directly or after writing hyperbolic functions as exponentials.

    >>> x = sympy.Symbol("x")
    >>> simplified_to_zero(sympy.cosh(x) ** 2 - sympy.sinh(x) ** 2 - 1)
    True
    """
    if sympy.simplify(difference) == 0:
        return True
    return bool(sympy.simplify(sympy.expand(difference.rewrite(sympy.exp))) == 0)
