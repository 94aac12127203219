"""The likelihood set: how high its level is, a point proved to be inside, or the proof that it is empty."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from bridge_theory.arithmetic.flint_balls import ball, ends
from proofs_checks.asking_checker.barrier import Region, log_likelihood
from proofs_checks.asking_checker.fit import sigmoid
from proofs_checks.asking_checker.log import Log
from proofs_checks.asking_checker.slopes import tangents
from proofs_checks.verify.enclosed import UNIT, Enclosed, FloatArray, largest_norms


def region_at(log: Log, level: float, weight_bound: float) -> Region:
    """The set with the weights of the ball under which the answers are nearly likeliest."""
    ones, zeros = (part.astype(np.float64) for part in log.counts())
    d = log.differences.shape[1]
    empty = Region(log.x, ones, zeros, level, weight_bound, np.zeros(d))
    w = np.zeros(d)
    for weight in (1.0, 0.1, 0.01, 1e-4):
        w = _inner_fit(empty, w, weight)
    return Region(log.x, ones, zeros, level, weight_bound, w)


def _inner_fit(region: Region, w: FloatArray, weight: float) -> FloatArray:
    """Damped Newton steps on l(w) + weight log(W^2 - ||w||^2)."""

    def height(w: FloatArray) -> float:
        room = region.weight_bound**2 - w @ w
        return float(log_likelihood(region, w[None])[0] + weight * np.log(room)) if room > 0 else -np.inf

    x, total, here = region.x, region.ones + region.zeros, height(w)
    for _ in range(60):
        p, room = sigmoid(x @ w), region.weight_bound**2 - w @ w
        slope = (region.ones - total * p) @ x - 2 * weight * w / room
        bend = (x.T * (total * p * (1 - p))) @ x + weight * (2 / room * np.eye(len(w)) + np.outer(w, w) * 4 / room**2)
        step = np.linalg.solve(bend, slope)
        length, gain = 1.0, float(step @ slope)
        while length > 1e-6 and not height(w + length * step) >= here + 0.1 * length * gain:
            length /= 2
        if gain < 1e-9 or length <= 1e-6:
            break
        w = w + length * step
        here = height(w)
    return w


def is_empty(log: Log, region: Region) -> bool:
    """Whether a tangent proves that no weights of the ball reach the level (companion G2 with v = 0)."""
    g, h = tangents(log, region.inside[None])
    top = float(largest_norms(Enclosed(g, 0.0))[0])
    return Fraction(float(h[0])) + Fraction(region.weight_bound) * Fraction(top) < Fraction(region.level)


def proved_log_likelihood(log: Log, w: FloatArray) -> float:
    """A float below l_t(w)."""
    ones, zeros = log.counts()
    z = log.x @ w
    wrong = (len(w) + 4) * UNIT * (np.abs(log.x) @ np.abs(w)) * (1 + 1e-9) + 1e-280
    total = ball(0)
    for low, high, n1, n0 in zip(
        (z - wrong).tolist(), (z + wrong).tolist(), ones.tolist(), zeros.tolist(), strict=True
    ):
        if n1:
            total -= n1 * (-ball(Fraction(low))).exp().log1p()
        if n0:
            total -= n0 * ball(Fraction(high)).exp().log1p()
    return ends(total)[0]


def is_inside(log: Log, w: FloatArray, level: float, weight_bound: float) -> bool:
    """Whether these weights are proved to be in the set."""
    return float(largest_norms(Enclosed(w[None], 0.0))[0]) <= weight_bound and proved_log_likelihood(log, w) >= level
