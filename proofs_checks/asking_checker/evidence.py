r"""The evidence of the answers from below, in balls: :math:`E_q[\ell_t] - KL(q \| \nu)` (companion G1'), any q.

q = N(m, L L'), with m and L exact floats. For a question x the expectation is that of :math:`\log \sigma(\mu + s u)`,
u a standard normal, :math:`\mu = \langle x, m \rangle`, :math:`s = \| L' x \|`. It grows in mu and falls in s (log
sigma is increasing and concave), so that a float below mu and one above s serve.

The integral of :math:`f(u) = \log \sigma(\mu + s u) \varphi(u)` is computed by the trapezoidal rule with step h, which
errs by at most :math:`2 M / (e^{2 \pi a / h} - 1)` where f is analytic for :math:`|Im\,u| < a + \epsilon` and
:math:`M \ge \int |f(u + i b)| du`, |b| <= a (Trefethen and Weideman 2014, theorem 5.1). With :math:`a \le \pi / (2 s)`
the real part of :math:`1 + e^{-z}` is at least 1 there, so that :math:`|\log \sigma(z)| \le \log 2 + |Re\, z| + \pi/2`
and :math:`M = e^{a^2/2} (\log 2 + |\mu| + s + \pi/2)` serves. Terms beyond T = n h >= 1 add up to at most
:math:`2 \varphi(T) ((\log 2 + |\mu|) / T + s)`.
"""

from __future__ import annotations

from fractions import Fraction
from math import ceil, log, pi

import numpy as np

from bridge_theory.arithmetic.flint_balls import Ball, ball, ends, pi_ball
from proofs_checks.asking_checker.fit import fitted_normal
from proofs_checks.asking_checker.log import Log
from proofs_checks.verify.enclosed import UNIT, FloatArray
from proofs_checks.verify.features import IntArray

WIDEST = 16.0
"""Largest s that is integrated; beyond, E log sigma >= -log 2 - max(0, -mu) - s phi(0) serves."""


def exact(x: float) -> Ball:
    """A float as a ball of radius zero."""
    return ball(Fraction(x))


def level(log_: Log, precisions: tuple[float, ...], delta: float, until: int | None = None) -> float:
    """A float below Q_t - log(1/delta), for the first ``until`` answers; the prior mixes the precisions equally."""
    ones, zeros = log_.counts(until)
    asked = np.flatnonzero(ones + zeros)
    x, ones, zeros = log_.x[asked], ones[asked], zeros[asked]
    parts = [component(x, ones, zeros, k, *fitted_normal(x, ones, zeros, k)) for k in precisions]
    mixed = sum((part.exp() for part in parts), start=ball(0)) / len(parts)
    return ends(mixed.log() + exact(delta).log())[0]


def component(
    x: FloatArray, ones: IntArray, zeros: IntArray, precision: float, mean: FloatArray, root: FloatArray
) -> Ball:
    """A ball below the log evidence under the prior N(0, I / precision)."""
    middle, spread = laws(x, mean, root)
    total = ball(0)
    for low, high, s, n1, n0 in zip(*middle, spread, ones.tolist(), zeros.tolist(), strict=True):
        if n1:
            total += n1 * expectation(low, s)
        if n0:
            total += n0 * expectation(-high, s)
    return total - divergence(precision, mean, root)


def laws(x: FloatArray, mean: FloatArray, root: FloatArray) -> tuple[tuple[list[float], list[float]], list[float]]:
    """For each row x floats below and above <x, m>, and above || L' x ||."""
    d = x.shape[1]
    mu, wrong = x @ mean, (d + 4) * UNIT * (np.abs(x) @ np.abs(mean)) * (1 + 1e-9) + 1e-280
    y, off = x @ root, (d + 4) * UNIT * (np.abs(x) @ np.abs(root)).max(axis=1, initial=0.0)
    s = np.sqrt((y**2).sum(axis=1)) * (1 + (d + 8) * UNIT) + d * off * (1 + 1e-9) + 1e-280
    low, high = np.nextafter(mu - wrong, -np.inf), np.nextafter(mu + wrong, np.inf)
    return (low.tolist(), high.tolist()), np.nextafter(s, np.inf).tolist()


def divergence(precision: float, mean: FloatArray, root: FloatArray) -> Ball:
    """KL(N(m, L L') || N(0, I / precision))."""
    squares = sum((exact(v) ** 2 for v in [*root[np.tril_indices(len(mean))].tolist(), *mean.tolist()]), start=ball(0))
    log_det = 2 * sum((exact(abs(v)).log() for v in np.diag(root).tolist()), start=ball(0))
    k = exact(precision)
    return (k * squares - len(mean) * (1 + k.log()) - log_det) / 2


def expectation(mu: float, s: float) -> Ball:
    """A ball below E log sigma(mu + s u)."""
    middle = exact(mu)
    if s > WIDEST:
        return -ball(2).log() - exact(max(0.0, -mu)) - exact(s) / (2 * pi_ball()).sqrt()
    width, nodes, wrong, tail_flat, tail_steep = _rule(max(0, ceil(log(max(s, 1e-300) / 0.25, 2))))
    spread, total = exact(s), ball(0)
    for node, mass in nodes:
        total -= mass * (-(middle + spread * node)).exp().log1p()
    size = ball(2).log() + abs(middle)
    return total * width - wrong * (size + spread + pi_ball() / 2) - tail_flat * size - tail_steep * spread


_RULES: dict[int, tuple[Ball, list[tuple[Ball, Ball]], Ball, Ball, Ball]] = {}


def _rule(size: int) -> tuple[Ball, list[tuple[Ball, Ball]], Ball, Ball, Ball]:
    """Step, nodes with masses, and factors of the error, for s <= 2^size / 4."""
    if size not in _RULES:
        strip = 0.99 * min(pi / (2 * 0.25 * 2.0**size), 5.0)
        step = 2 * pi * strip / (strip**2 / 2 + 24)
        count = ceil(8.5 / step)
        h, a = exact(step), exact(strip)
        normal = (2 * pi_ball()).sqrt()
        nodes = [(h * j, (-((h * j) ** 2) / 2).exp() / normal) for j in range(-count, count + 1)]
        wrong = 2 * (a**2 / 2).exp() / ((2 * pi_ball() * a / h).exp() - 1)
        edge = nodes[-1][1]
        _RULES[size] = h, nodes, wrong, 2 * edge / (h * count), 2 * edge
    return _RULES[size]
