r"""The online confidence set Pi_t and the pair to ask about, exactly over all pairs but without forming them all.

With whitened features z (so that :math:`\|\phi - \phi'\|_{V^{-1}} = \|z - z'\|`), scores :math:`s = \phi^T w` and
bonuses b, the set is (lem:online_confidence_set)

.. math:: \Pi_t = \{i : \forall j: s_i - s_j + \gamma \|z_i - z_j\| + b_i + b_j \ge 0\} .
"""

from __future__ import annotations

import numpy as np

from bridge_algos.mdp import FloatArray, IntArray
from bridge_algos.online.cholesky import inverse_root
from bridge_algos.shapes import DataMatrix, Features, Kept, PerChallenger, PerPolicy

TILE = 64
FIRST_TILE = 16
"""The best few challengers beat most policies that are beaten at all."""
EPSILON = float(np.finfo(float).eps)
TIE = 1e-9
"""Relative difference below which two values count as equal: far above rounding, far below what a run can tell."""


def whiten(features: Features, matrix: DataMatrix) -> Features:
    """Rows z with ||z_i - z_j||_2 = ||phi_i - phi_j||_{V^{-1}}."""
    return np.asarray(features @ inverse_root(matrix).T)


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
    upper, lower = upper - lower[order[0]], lower[order] - lower[order[0]]
    largest = max(float(upper.max()), float(-upper.min()), float(-lower[-1]))
    lower -= 1e-12 * (1 + largest)
    kept = np.ones(len(z), dtype=bool)
    open_ = np.flatnonzero(upper < lower[0])
    if not len(open_):
        return kept
    upper, others = upper[open_], others[order]
    left, right = _excess_factors(upper, gamma * (z[open_] - others[0]), lower, gamma * (others - others[0]), largest)
    start, size = 0, FIRST_TILE
    while len(open_) and start < len(order):
        tile, start, size = slice(start, start + size), start + size, TILE
        beaten = ((left @ right[tile].T > 0) & (lower[tile] > upper[:, None])).any(axis=1)
        kept[open_[beaten]] = False
        if start < len(order):
            rest = ~beaten & (upper < lower[start])
            open_, upper, left = open_[rest], upper[rest], left[rest]
    return kept


def _excess_factors(
    upper: FloatArray, a: FloatArray, lower: FloatArray, b: FloatArray, largest: float
) -> tuple[FloatArray, FloatArray]:
    """Matrices whose product is (lower_j - upper_i)^2 - ||a_i - b_j||^2, less an allowance for its rounding.

    ``largest`` is that of the absolute values of upper and lower.
    """
    d = a.shape[1]
    squares_a, squares_b = np.vecdot(a, a), np.vecdot(b, b)
    allowance = 8 * EPSILON * (d + 4) * float(squares_a.max() + squares_b.max() + 3 * largest**2)
    left, right = np.empty((len(a), d + 3)), np.empty((len(b), d + 3))
    left[:, :d], left[:, d], left[:, d + 1], left[:, d + 2] = 2 * a, -2 * upper, 1, upper * upper - squares_a
    right[:, :d], right[:, d], right[:, d + 1], right[:, d + 2] = b, lower, lower * lower - squares_b - allowance, 1
    return left, right


def first_best(values: PerPolicy) -> int:
    """Index of the first value that is the largest to rounding, so that no tie is decided by rounding."""
    largest = float(values.max())
    return int((values >= largest - TIE * (1 + abs(largest))).argmax())


def widest_pair(z: Features, gamma: float, bonus: PerPolicy, scores: PerPolicy | None = None) -> tuple[int, int]:
    r"""The pair i != j maximising :math:`\gamma \|z_i - z_j\| + b_i + b_j` (algo:main line 7), to rounding.

    A policy is no partner of itself, which the paper's maximum allows; (0, 0) only where there is one policy. With
    scores s the objective is :math:`s_i - s_j` more. A triangle inequality through the mean bounds each pair by
    u_i + v_j with u = gamma ||z - mean|| + b + s and v likewise with -s; tiles of the orders by falling u and v are
    skipped once that bound cannot beat the best pair found. Values that agree to rounding count as equal, and the first
    in these orders wins.
    """
    away = z - np.add.reduce(z) / len(z)
    squares = np.vecdot(away, away)
    centred = 0.0 if scores is None else scores - scores.mean()
    ahead, behind = bonus + centred, bonus - centred
    reach = gamma * np.sqrt(squares)
    noise = 16 * EPSILON * (z.shape[1] + 4) * float(squares.max())  # of squared distances: below it they are equal
    sizes = gamma * np.linalg.norm(z, axis=1), bonus, 0.0 if scores is None else np.abs(scores)
    slack = TIE * sum(float(np.max(size)) for size in sizes) + 1e-300
    firsts, u = _falling(reach + ahead, slack)
    seconds, v = (firsts, u) if scores is None else _falling(reach + behind, slack)
    best, pair = -np.inf, (0, 0)
    for start in range(0, len(z), TILE):
        rows = seconds[start : start + TILE]
        if v[start] + u[0] + 3 * slack < best:
            break
        for other in range(0, start + 1 if scores is None else len(z), TILE):  # without scores (j, i) is as good
            columns = firsts[other : other + TILE]
            if v[start] + u[other] + 3 * slack < best:
                break
            squared = squares[rows, None] + squares[columns] - 2 * (away[rows] @ away[columns].T)
            values = gamma * np.sqrt(np.where(squared > noise, squared, 0.0)) + behind[rows, None] + ahead[columns]
            values[rows[:, None] == columns] = -np.inf
            largest = float(values.max())
            if largest > best + slack:
                i, j = divmod(int((values >= largest - slack).argmax()), len(columns))
                best, pair = largest, (int(columns[j]), int(rows[i]))
    return pair


def _falling(values: PerPolicy, slack: float) -> tuple[IntArray, PerPolicy]:
    """Indices by falling values, equal to within the slack by index, and the values in that order."""
    order = np.argsort(-np.rint(values / slack), kind="stable")
    return order, values[order]
