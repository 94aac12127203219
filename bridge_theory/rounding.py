"""Six digits of a number for people, rounded so that a bound stays a bound."""

from __future__ import annotations

import sys
from decimal import MAX_EMAX, MIN_EMIN, ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from math import isfinite

_DIGITS = 6


def rounded_up(value: float | Fraction) -> str:
    """The smallest decimal of six significant digits that is at least ``value``: for upper bounds.

    >>> rounded_up(1.0000029999), rounded_up(Fraction(1, 20)), rounded_up(1e-9 / 3), rounded_up(Fraction(1, 10**400))
    ('1.00001', '0.05', '3.33334e-10', '1e-400')
    """
    return _rounded(value, ROUND_CEILING)


def rounded_down(value: float | Fraction) -> str:
    """The largest decimal of six significant digits that is at most ``value``: for lower bounds and guarantees.

    >>> rounded_down(1 - Fraction(1, 10**9)), rounded_down(float("inf"))
    ('0.999999', 'inf')
    """
    return _rounded(value, ROUND_FLOOR)


def _rounded(value: float | Fraction, rounding: str) -> str:
    if isinstance(value, float) and not isfinite(value):
        return str(value)
    context = Context(prec=_DIGITS, rounding=rounding, Emin=MIN_EMIN, Emax=MAX_EMAX)
    quotient = context.divide(*map(Decimal, value.as_integer_ratio()))
    if quotient and not sys.float_info.min <= abs(quotient) <= sys.float_info.max:
        return f"{context.normalize(quotient):g}"
    return f"{float(quotient):.{_DIGITS}g}"  # six digits survive a normal float64, whose format is the familiar one
