r"""Companion G6 from a log: the regret of all rounds at once, from questions and answers alone, rounded up.

With :math:`\ell_t(w^*) \ge L := Q_t - \log(1/\delta)` (companion G1'), :math:`\|w^*\| \le W`, and
:math:`m_\pi = \sum_t(\phi(\pi) - (\phi(\pi_t^1) + \phi(\pi_t^2))/2)` under the known dynamics, the regret
:math:`\langle m_{\pi^*}, w^*\rangle` is at most the largest value over all candidates of (companion G2)

.. math:: \max_{w} \langle m_\pi, w\rangle \le c\,(\ell_t(w_0) - \langle\nabla\ell_t(w_0), w_0\rangle - L)
          + W\|m_\pi + c\nabla\ell_t(w_0)\|_2

for any point :math:`w_0` and any :math:`c \ge 0`: each candidate takes its best c at every point that was found for
some candidate, whoever found it. No pair rule, no multiplier, no fitted weights and no exploration bonus enters.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import arb, arb_mat

from bridge_theory.arithmetic.flint_balls import Ball, ball, ends, midpoint
from bridge_theory.errors import ComputationError
from proofs_checks.verify.enclosed import UNIT, Enclosed, FloatArray, enlarged, largest_norms
from proofs_checks.verify.evidence import Answers, log_evidence
from proofs_checks.verify.farthest import farthest, fit_in_ball

MOST_POINTS = 20
"""Points w_0 that are searched after a round."""

CLOSE = 1e-3
"""The search ends when the bound is within this share of a value that some weights of the set attain."""

GRID = 40
"""Rounds after which the bound is computed, spaced evenly, and as many on a logarithmic scale: all of a short run."""


def checked_rounds(last: int) -> set[int]:
    """After which rounds the bound is computed; after another it is at most that after the next of them.

    >>> sorted(checked_rounds(3)), len(checked_rounds(10**4)) <= 80
    ([1, 2, 3], True)
    """
    spaced = np.concatenate([np.linspace(1, last, GRID), np.geomspace(1, last, GRID)])
    return set(np.round(spaced).astype(np.int64).tolist())


@dataclass(frozen=True, eq=False)
class Tangent:
    """What a point w_0 says of the set: 0 <= height + <gradient, w> for every w in it.

    Args:
        height: l(w_0) - <gradient, w_0> - L, rounded up.
        gradient: (1, d) of l at w_0.
    """

    height: float
    gradient: Enclosed


def tangent(answers: Answers, level: Ball, w: FloatArray) -> Tangent:
    """The tangent of the log-likelihood at any point, in balls."""
    margins = answers.margins(w)
    value = answers.log_likelihood(margins)
    if not margins:
        return Tangent(ends(value - level)[1], Enclosed(np.zeros((1, len(w))), 0.0))
    pulls = [
        one - (one + zero) / (1 + (-z).exp())
        for z, one, zero in zip(margins, answers.ones.tolist(), answers.zeros.tolist(), strict=True)
    ]
    gradient = (answers.rows.transpose() * arb_mat(len(pulls), 1, pulls)).entries()
    along = sum((g * arb(entry) for g, entry in zip(gradient, w.tolist(), strict=True)), start=arb(0))
    middle = [midpoint(g) for g in gradient]
    spread = max(ends(abs(g - arb(mid)))[1] for g, mid in zip(gradient, middle, strict=True))
    return Tangent(ends(value - along - level)[1], Enclosed(np.array([middle]), spread))


def dual_bounds(v: Enclosed, at: Tangent, weight_bound: float) -> FloatArray:
    """Upper bounds on <v, w> over the set for all directions (N, d), each with its best c at this point, (N,)."""
    g = at.gradient.mid[0]
    c = _best_multipliers(v.mid, g, at.height, weight_bound)
    shifted = v.mid + c[:, None] * g
    most = float(c.max(initial=0.0))
    size = v.size + most * at.gradient.size
    rad = enlarged(v.rad + most * at.gradient.rad + 4 * UNIT * size)
    norms = largest_norms(Enclosed(shifted, rad))
    values = c * at.height + weight_bound * norms
    return np.asarray(values + 8 * UNIT * (c * abs(at.height) + weight_bound * norms))


def _best_multipliers(v: FloatArray, g: FloatArray, height: float, weight_bound: float) -> FloatArray:
    """The c >= 0 with the least c height + W ||v + c g||, in closed form; 0 where none is better."""
    squared = float(g @ g)
    if squared == 0:
        return np.zeros(len(v))
    ratio = -height / (weight_bound * np.sqrt(squared))
    if not ratio > -1:  # the bound only grows with c
        return np.zeros(len(v))
    along = v @ g / np.sqrt(squared)
    across = np.sqrt(np.maximum((v**2).sum(axis=1) - along**2, 0))
    # where ratio >= 1 no weights of the ball are in the set, which emptiness() tells; any c will do
    ratio = min(ratio, 1 - 1e-9)
    return np.asarray(np.maximum(ratio * across / np.sqrt(1 - ratio**2) - along, 0) / np.sqrt(squared))


def likelihood_bound(answers: Answers, directions: Enclosed, weight_bound: Fraction, delta: Fraction) -> float:
    """An upper bound on the largest <m, w> over all directions (N, d) and all w of the likelihood set.

    Raises:
        ComputationError: when no w of norm at most W is in the set: the answers refute the model, or W.
    """
    level = log_evidence(answers, weight_bound) + ball(delta).log()
    # a bound holds for any larger set, so that the level may be rounded down once for all
    level = arb(ends(level)[0])
    highest = ends(ball(weight_bound))[1]
    start = fit_in_ball(answers, float(weight_bound), np.zeros(directions.mid.shape[1]))
    at = tangent(answers, level, start)
    most = highest * enlarged(float(largest_norms(at.gradient)[0])) * (1 + 8 * UNIT)  # of <gradient, w> in the ball
    if most + at.height < -8 * UNIT * abs(at.height):
        raise ComputationError(
            "no weights of norm at most W are as likely as the answers demand, so that they contradict the "
            "Bradley-Terry model or W"
        )
    bounds = np.minimum(highest * largest_norms(directions) * (1 + 8 * UNIT), dual_bounds(directions, at, highest))
    floor, inside = midpoint(level), at.height + float(at.gradient.mid[0] @ start) > 0
    reached, nothing = 0.0, 1e-9 * highest * directions.size
    for _ in range(MOST_POINTS if inside else 0):
        top = int(bounds.argmax())
        if bounds[top] <= reached + CLOSE * abs(reached) + nothing or not directions.mid[top].any():
            break
        w = farthest(answers, floor, float(weight_bound), directions.mid[top], start)
        reached = max(reached, float((directions.mid @ w).max()))
        bounds = np.minimum(bounds, dual_bounds(directions, tangent(answers, level, w), highest))
    return enlarged(max(0.0, float(bounds.max())))
