r"""The test of the model, recomputed from questions and answers (companion G4): how strongly they speak against it.

Forecasters bet on each answer before it is known: the model itself, and half of the stake outside of it. With Q the log
of what the stakes have become, :math:`Q - \max_w \ell_t(w)` exceeds :math:`\log(1/\delta_M)` at any time with
probability at most :math:`\delta_M` under the model. Nothing is read but questions and answers; the maximum is bounded
from above by a tangent. Forecasts sum to 1, so that errors in them cost power only.

The forecasters are tables of Krichevsky and Trofimov, and two normal approximations of logistic regressions, updated
answer by answer: one that answers are flipped of, and one of larger weights. Sessions bet with more, which look at the
whole pool, of which a file holds what was shown: a contradiction that only those find is told, as not confirmed.
"""

from __future__ import annotations

from fractions import Fraction
from math import log

import numpy as np

from proofs_checks.asking_checker.barrier import Region
from proofs_checks.asking_checker.fit import sigmoid
from proofs_checks.asking_checker.log import Log
from proofs_checks.asking_checker.slopes import tangents
from proofs_checks.verify.enclosed import Enclosed, FloatArray, largest_norms
from proofs_checks.verify.features import IntArray

REFUTED = log(100.0)
"""Nats against the model at which it is refuted: delta_M is .01."""

FLIPPED = 0.1
SHARES = np.array([0.5, 0.25, 0.25])

LOST = 1e-9
"""Nats subtracted for each answer, far above what rounding adds."""


def evidence_against(log_: Log, pool: IntArray, region: Region, delta: float) -> float:
    """Nats against the model, from below.

    Args:
        log_: questions and answers.
        pool: (M, d) features of the items.
        region: of the likelihood set, whose level is the log evidence within the model less log(1/delta).
        delta: of the session.
    """
    g, h = tangents(log_, region.inside[None])
    top = float(largest_norms(Enclosed(g, 0.0))[0])
    highest = Fraction(float(h[0])) + Fraction(region.weight_bound) * Fraction(top)
    within = region.level + log(1 / delta)
    stakes = float(np.logaddexp(within, outside(log_, pool, region.weight_bound)) - log(2))
    return stakes - float(highest) - LOST * (1 + abs(stakes))


def outside(log_: Log, pool: IntArray, weight_bound: float) -> float:
    """The log forecast of all answers by the forecasters outside of the model."""
    d = pool.shape[1]
    kind = np.unique(pool, axis=0, return_inverse=True)[1].ravel()
    own = np.full(d, weight_bound**2 / d)
    narrow, wide = _Normal(own / 4), _Normal(4 * own)
    wins: dict[tuple[int, int], int] = {}
    stakes = np.log(SHARES)
    for (first, second), answer in zip(log_.pairs.tolist(), log_.said.tolist(), strict=True):
        x = (pool[first] - pool[second]).astype(np.float64)
        own_kinds = int(kind[first]), int(kind[second])
        for_, against = wins.get(own_kinds, 0), wins.get(own_kinds[::-1], 0)
        table = (for_ + 0.5) / (for_ + against + 1)
        chances = np.array([table, FLIPPED + (1 - 2 * FLIPPED) * narrow.chance(x), wide.chance(x)])
        stakes += np.log(chances if answer else 1 - chances) - LOST
        winner = own_kinds if answer else own_kinds[::-1]
        wins[winner] = wins.get(winner, 0) + 1
        for law in (narrow, wide):
            law.update(x, answer)
    return float(np.logaddexp.reduce(stakes))


class _Normal:
    """A normal law of a logistic regression's weights, with answers taken in one by one."""

    def __init__(self, variances: FloatArray) -> None:
        self.mean, self.covariance = np.zeros(len(variances)), np.diag(variances)

    def chance(self, x: FloatArray) -> float:
        """Of the answer 1, kept away from 0 and 1."""
        spread = max(float(x @ self.covariance @ x), 0.0)
        chance = float(sigmoid(np.array(x @ self.mean / np.sqrt(1 + np.pi * spread / 8))))
        return min(max(chance, 1e-6), 1 - 1e-6)

    def update(self, x: FloatArray, answer: int) -> None:
        """Move to the mode along x, z' = z + s (answer - sigma(z')), and take in the curvature there."""
        along = self.covariance @ x
        s, z = float(along @ x), float(self.mean @ x)
        if s <= 0:
            return
        low, high = (z, z + s) if answer else (z - s, z)
        for _ in range(30):
            middle = 0.5 * (low + high)
            if middle - z < s * (answer - float(sigmoid(np.array(middle)))):
                low = middle
            else:
                high = middle
        p = float(sigmoid(np.array(0.5 * (low + high))))
        self.mean = self.mean + along * (answer - p)
        self.covariance = self.covariance - np.outer(along, along) * (p * (1 - p) / (1 + p * (1 - p) * s))
