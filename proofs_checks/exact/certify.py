"""Deciding ``truth <= bound`` between exact numbers and formulas of ``bridge_theory``, at rising precision."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from bridge_theory.arithmetic import flint_balls
from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.arithmetic.flint_balls import Ball, ball, working_precision
from bridge_theory.formula import Formula
from proofs_checks.exact.surd import Surd

Number = Surd | Fraction | int | Callable[[], Ball]
"""An exact number, or a computation that encloses one at the working precision."""

_BITS = (96, 384, 1536)
_EQUAL = ball(Fraction(1, 2**1200))


def at_most(left: Number, right: Number) -> bool:
    """Whether one number is at most another; equality to 360 digits counts as such, indecision does not.

    >>> at_most(lambda: ball(2).sqrt(), Fraction(3, 2)), at_most(lambda: ball(2).sqrt() ** 2, 2)
    (True, True)
    >>> at_most(2, lambda: ball(3).sqrt())
    False
    """
    for bits in _BITS:
        with working_precision(bits):
            gap = as_ball(right) - as_ball(left)
            if gap >= 0 or gap < 0:
                return bool(gap >= 0)
    return bool(abs(gap) < _EQUAL)


def within(truth: Number, bound: Formula, **values: Number | tuple[Fraction | int, ...]) -> bool:
    """Whether an exact number is at most a bound at the given parameters (array parameters are tuples).

    >>> from bridge_theory import row_error_at_step
    >>> within(Fraction(3, 4), row_error_at_step, R=Fraction(1, 2))
    True
    >>> within(Fraction(751, 1000), row_error_at_step, R=Fraction(1, 2))
    False
    """
    return at_most(truth, lambda: value_of(bound, **values))


def attained(truth: Number, bound: Formula, **values: Number | tuple[Fraction | int, ...]) -> bool:
    """Whether the bound equals an exact number to 360 digits.

    >>> from bridge_theory import row_error_at_step
    >>> attained(Fraction(3, 4), row_error_at_step, R=Fraction(1, 2))
    True
    """
    with working_precision(_BITS[-1]):
        return bool(abs(value_of(bound, **values) - as_ball(truth)) < _EQUAL)


def value_of(bound: Formula, **values: Number | tuple[Fraction | int, ...]) -> Ball:
    """The bound as a ball at the working precision; parameters may be irrational."""
    value = bound(BALLS, **{k: v if isinstance(v, tuple) else as_ball(v) for k, v in values.items()})
    return flint_balls.as_ball(value)


def scaled(factor: Fraction, bound: Formula, **values: Number | tuple[Fraction | int, ...]) -> Ball:
    """A multiple of the bound: a mutant of it."""
    return ball(factor) * value_of(bound, **values)


def as_ball(value: Any) -> Ball:
    """A `Number` as a ball at the working precision."""
    if isinstance(value, Surd):
        return value.ball()
    return value() if callable(value) else ball(value)
