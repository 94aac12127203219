r"""The online confidence set Pi_t and the pair to ask about, exactly over all pairs but without forming them all.

With whitened features z (so that :math:`\|\phi - \phi'\|_{V^{-1}} = \|z - z'\|`), scores :math:`s = \phi^T w` and
bonuses b, the set is (lem:online_confidence_set)

.. math:: \Pi_t = \{i : \forall j: s_i - s_j + \gamma \|z_i - z_j\| + b_i + b_j \ge 0\} .
"""

from __future__ import annotations

import numpy as np

from bridge_algos.mdp import FloatArray
from bridge_algos.shapes import DataMatrix, Features, Kept, PerChallenger, PerPolicy

TILE = 64


def whiten(features: Features, matrix: DataMatrix) -> Features:
    """Rows z with ||z_i - z_j||_2 = ||phi_i - phi_j||_{V^{-1}}."""
    return np.asarray(features @ np.linalg.inv(np.linalg.cholesky(matrix)).T)


def surviving(
    upper: PerPolicy, lower: PerChallenger, z: Features, gamma: float, challengers: FloatArray | None = None
) -> Kept:
    """Which policies no challenger beats: no j with lower_j > upper_i + gamma ||z_i - z_j||.

    Challengers come in falling order of ``lower``; a policy whose ``upper`` reaches the best remaining ``lower``
    is safe from all that follow, whatever the distances, so that most policies meet only a few tiles. Rounding may keep
    a policy, never rule one out: a confidence set may only err on the large side.

    Args:
        upper: (N,) scores plus bonus, s + b.
        lower: (M,) scores minus bonus of the challengers, s - b.
        z: (N, d) whitened features.
        gamma: multiplier of the norm, at least 0.
        challengers: (M, d) whitened features of the challengers; the policies themselves by default.

    Returns:
        (N,) booleans.
    """
    others = z if challengers is None else challengers
    order = np.argsort(-lower, kind="stable")
    upper, lower = upper - upper.mean(), lower - upper.mean()
    lower = lower - 1e-12 * (1 + max(float(np.abs(upper).max()), float(np.abs(lower).max())))
    origin = z.mean(axis=0)
    left, right = _excess_factors(upper, gamma * (z - origin), lower[order], gamma * (others[order] - origin))
    lower = lower[order]
    kept = np.ones(len(z), dtype=bool)
    open_ = np.arange(len(z))
    for start in range(0, len(order), TILE):
        tile = slice(start, start + TILE)
        open_ = open_[kept[open_] & (upper[open_] < lower[start])]
        if not len(open_):
            break
        ahead = upper[open_] < lower[tile][-1]
        excess = left[open_] @ right[tile].T
        partly = np.flatnonzero(~ahead)
        excess[partly] = np.where(lower[tile] > upper[open_[partly], None], excess[partly], -1.0)
        kept[open_[excess.max(axis=1) > 0]] = False
    return kept


def _excess_factors(
    upper: FloatArray, a: FloatArray, lower: FloatArray, b: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Matrices whose product is (lower_j - upper_i)^2 - ||a_i - b_j||^2, less an allowance for its rounding."""
    squares_a, squares_b = (a**2).sum(axis=1), (b**2).sum(axis=1)
    largest = squares_a.max() + squares_b.max() + (upper**2).max() + (lower**2).max()
    allowance = 8 * np.finfo(float).eps * (a.shape[1] + 4) * largest
    left = np.column_stack([2 * a, -2 * upper, np.ones(len(a)), upper**2 - squares_a])
    right = np.column_stack([b, lower, lower**2 - squares_b - allowance, np.ones(len(b))])
    return left, right


def widest_pair(z: Features, gamma: float, bonus: PerPolicy) -> tuple[int, int]:
    r"""The pair maximising :math:`\gamma \|z_i - z_j\| + b_i + b_j` (algo:main line 7), exactly.

    A triangle inequality through the mean bounds each pair by u_i + u_j with u = gamma ||z - mean|| + b; tiles of the
    order by falling u are skipped once that bound cannot beat the best pair found.
    """
    reach = gamma * np.linalg.norm(z - z.mean(axis=0), axis=1) + bonus
    order = np.argsort(-reach, kind="stable")
    best, pair = -np.inf, (int(order[0]), int(order[0]))
    slack = 1e-9 * (1 + float(np.abs(reach).max()))
    for start in range(0, len(order), TILE):
        rows = order[start : start + TILE]
        if reach[rows[0]] + reach[order[0]] + slack < best:
            break
        for other in range(0, start + 1, TILE):
            columns = order[other : other + TILE]
            if reach[rows[0]] + reach[columns[0]] + slack < best:
                break
            values = gamma * _distances(z[rows], z[columns]) + bonus[rows, None] + bonus[columns]
            i, j = np.unravel_index(int(values.argmax()), values.shape)
            if values[i, j] > best:
                best, pair = float(values[i, j]), (int(columns[j]), int(rows[i]))
    return pair


def _distances(a: FloatArray, b: FloatArray) -> FloatArray:
    squared = (a**2).sum(axis=1)[:, None] + (b**2).sum(axis=1) - 2 * (a @ b.T)
    return np.asarray(np.sqrt(np.maximum(squared, 0)))
