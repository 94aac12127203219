"""What the online evaluators share: rational enclosures, and the paper's formulas written a second time.

They are written from the paper alone, so that they can be held against ``bridge_theory``.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from bridge_theory.arithmetic.flint_balls import Ball, ball, ends

Enclosed = tuple[Fraction, Fraction]


def enclosed(value: Ball) -> Enclosed:
    """Two rational numbers on either side of the ball."""
    low, high = ends(value)
    return Fraction(low), Fraction(high)


def numbers(data: Mapping[str, Any], names: str) -> list[Ball]:
    """The named entries of an instance as balls."""
    return [ball(Fraction(data[name])) for name in names.split()]


def inverse_slope(x: Ball) -> Ball:
    """1 / sigma'(x) by the definition of the sigmoid."""
    sigma = 1 / (1 + (-x).exp())
    return 1 / (sigma * (1 - sigma))


def beta(t: Ball, *, B: Ball, W: Ball, lam: Ball, d: Ball, delta: Ball, kappa: Ball) -> Ball:
    """The paper's beta_t."""
    return lam.sqrt() * W + ((1 / delta).log() + 2 * d * (1 + t * B * B / (kappa * lam * d)).log()).sqrt()


def alpha(T: Ball, *, B: Ball, W: Ball, d: Ball, delta: Ball) -> Ball:
    """The paper's alpha_{d,T}."""
    return 20 * B * W * (d * (T * (1 + 2 * T) / delta).log()).sqrt()


def offline_logarithm(T: Ball, *, B: Ball, lam: Ball, d: Ball, S: Ball, A: Ball, n: Ball, delta: Ball) -> Ball:
    """log(1 + 192 B^2 T S log(A / delta) / (n d lambda))."""
    return (1 + 192 * B * B * T * S * (A / delta).log() / (n * d * lam)).log()


def bonus_logarithm(t: Ball, *, S: Ball, A: Ball, H: Ball, eta: Ball, epsilon: Ball, delta: Ball) -> Ball:
    """U = H log(S A H) + S log(4 eta H / epsilon) + log(6 log t / delta)."""
    return H * (S * A * H).log() + S * (4 * eta * H / epsilon).log() + (6 * t.log() / delta).log()
