"""From exact numbers to the sides of an inequality."""

from __future__ import annotations

from fractions import Fraction

from bridge_theory.arithmetic.flint_balls import Ball, ball
from proofs_checks.counterexample import Number
from proofs_checks.evaluators.online_numbers import enclosed
from proofs_checks.exact.surd import Surd


def side(value: Surd | Fraction | int) -> Number:
    """A rational number as it is, an irrational one as an enclosure."""
    if isinstance(value, Surd):
        return value.rational() if all(radicand == 1 for radicand, _ in value.terms) else enclosed(value.ball())
    return Fraction(value)


def log(value: Fraction | int) -> Ball:
    """The natural logarithm of a rational number, as a ball."""
    return ball(value).log()
