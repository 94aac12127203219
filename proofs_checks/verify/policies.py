r"""Which policies may be in :math:`\Pi_t`, and which cannot be.

.. math:: \Pi_t = \{i : \forall j: s_i - s_j + \gamma\|z_i - z_j\| + b_i + b_j \ge 0\}

All pairs are looked at, in tiles. Squared distances come from products of the rows z, whose rounding is bounded once
for all of them.
"""

from __future__ import annotations

import numpy as np

from proofs_checks.verify.enclosed import UNIT, Enclosed, FloatArray, enlarged

TILE = 2**16
"""Pairs looked at together: what a processor's cache holds."""


def squared_distances(z: Enclosed, rows: slice) -> tuple[FloatArray, float]:
    """||z_i - z_j||^2 for some rows i and all j, and the radius of all of them."""
    d = z.mid.shape[1]
    squares = (z.mid**2).sum(axis=1)
    values = (-2 * z.mid[rows]) @ z.mid.T
    values += squares
    values += squares[rows, None]
    top = float(squares.max())
    spread = 2 * np.sqrt(d) * z.rad  # of ||z_i - z_j||, whose square moves by at most (2 diameter + spread) spread
    return values, enlarged(4 * (d + 6) * UNIT * top + (4 * np.sqrt(top) + spread) * spread)


def worst_margins(scores: Enclosed, z: Enclosed, gamma: float, bonus: FloatArray) -> tuple[FloatArray, FloatArray]:
    """For each policy bounds on the smallest of s_i - s_j + gamma ||z_i - z_j|| + b_i + b_j over j.

    Args:
        scores: (N,) midpoints.
        z: (N, d) whitened features.
        gamma: multiplier of the norm, at least 0.
        bonus: (N,) at least 0.

    Returns:
        Lower and upper bounds, both (N,): a policy with a negative upper bound is outside for certain.
    """
    n = len(scores.mid)
    low, high, height = np.empty(n), np.empty(n), max(1, TILE // n)
    centred = Enclosed(z.mid - z.mid.mean(axis=0), enlarged(z.rad + 4 * UNIT * z.size))
    against, own = scores.mid - bonus, scores.mid + bonus
    for first in range(0, n, height):
        rows = slice(first, first + height)
        squares, radius = squared_distances(centred, rows)
        for shift, margins in ((-radius, low), (radius, high)):
            norms = squares + shift
            np.sqrt(np.maximum(norms, 0, out=norms), out=norms)
            norms *= gamma
            norms -= against
            margins[rows] = norms.min(axis=1) + own[rows]
    size = scores.size + float(bonus.max(initial=0.0)) + gamma * (centred.size * np.sqrt(z.mid.shape[1]))
    slack = enlarged(2 * scores.rad + 32 * UNIT * size)
    return low - slack, high + slack


def widest(z: FloatArray, gamma: float, bonus: FloatArray, scores: FloatArray | None = None) -> float:
    """An estimate of the largest gamma ||z_i - z_j|| + b_i + b_j over i != j, with s_i - s_j where scores count.

    Minus infinity for one policy.
    """
    best, height = -np.inf, max(1, TILE // len(z))
    centred = Enclosed(z - z.mean(axis=0), 0.0)
    ahead, behind = (bonus, bonus) if scores is None else (bonus + scores, bonus - scores)
    for first in range(0, len(z), height):
        rows = slice(first, first + height)
        values, _ = squared_distances(centred, rows)
        np.sqrt(np.maximum(values, 0, out=values), out=values)
        values *= gamma
        values += behind
        values[np.arange(len(values)), np.arange(first, first + len(values))] = -np.inf
        best = max(best, float((values.max(axis=1) + ahead[rows]).max()))
    return best
