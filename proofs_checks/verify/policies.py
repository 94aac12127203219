r"""Which policies may be in :math:`\Pi_t`, and which cannot be.

.. math:: \Pi_t = \{i : \forall j: s_i - s_j + \gamma\|z_i - z_j\| + b_i + b_j \ge 0\}

All pairs are looked at, in tiles. Squared distances come from products of the rows z, whose rounding is bounded once
for all of them.
"""

from __future__ import annotations

import numpy as np

from proofs_checks.verify.enclosed import UNIT, Enclosed, FloatArray, enlarged

TILE = 2**21
"""Pairs looked at together."""


def squared_distances(z: Enclosed, rows: slice) -> tuple[FloatArray, float]:
    """||z_i - z_j||^2 for some rows i and all j, and the radius of all of them."""
    d = z.mid.shape[1]
    squares = (z.mid**2).sum(axis=1)
    values = squares[rows, None] + squares - 2 * (z.mid[rows] @ z.mid.T)
    top = float(squares.max())
    spread = 2 * np.sqrt(d) * z.rad  # of ||z_i - z_j||, whose square moves by at most (2 diameter + spread) spread
    return values, enlarged(4 * (d + 6) * UNIT * top + (4 * np.sqrt(top) + spread) * spread)


def worst_margins(scores: Enclosed, z: Enclosed, gamma: float, bonus: FloatArray, upper: bool) -> FloatArray:
    """For each policy the smallest of s_i - s_j + gamma ||z_i - z_j|| + b_i + b_j over j, (N,).

    Args:
        scores: (N,) midpoints.
        z: (N, d), such that distances of z are at least those in the inverse data matrix.
        bonus: (N,) at least the true bonuses.
        upper: give upper bounds, by which a negative margin excludes a policy for certain; else estimates.
    """
    n = len(scores.mid)
    margins, height = np.empty(n), max(1, TILE // n)
    centred = Enclosed(z.mid - z.mid.mean(axis=0), enlarged(z.rad + 4 * UNIT * z.size))
    for first in range(0, n, height):
        rows = slice(first, first + height)
        squares, radius = squared_distances(centred, rows)
        norms = np.sqrt(np.maximum(squares, 0) + (radius if upper else 0.0))
        margins[rows] = (gamma * norms - (scores.mid - bonus)).min(axis=1) + (scores.mid + bonus)[rows]
    if upper:
        size = scores.size + float(bonus.max(initial=0.0)) + gamma * (centred.size * np.sqrt(z.mid.shape[1]))
        margins += enlarged(2 * scores.rad + 16 * UNIT * 2 * size)
    return margins


def widest(z: FloatArray, gamma: float, bonus: FloatArray) -> float:
    """An estimate of the largest gamma ||z_i - z_j|| + b_i + b_j over all pairs."""
    best, height = -np.inf, max(1, TILE // len(z))
    centred = Enclosed(z - z.mean(axis=0), 0.0)
    for first in range(0, len(z), height):
        rows = slice(first, first + height)
        norms = np.sqrt(np.maximum(squared_distances(centred, rows)[0], 0))
        best = max(best, float((gamma * norms + bonus + bonus[rows, None]).max()))
    return best
