r"""Forecasters of answers that the model test bets with. Each says :math:`q(1)` before the answer is known.

Any forecast is valid; a good one refutes a wrong model sooner. All are *antisymmetric*: the same question shown in the
other order gets :math:`1 - q(1)`. So it cannot matter in which order the two items of a pair were written down.
"""

from __future__ import annotations

from math import exp, pi, sqrt

import numpy as np

from bridge_algos.mdp import FloatArray

DIRECTIONS = 6
"""Directions of the pool (principal ones) whose products the interactions are made of."""

BISECTIONS = 30

LEAST = 1e-6
"""No forecast is nearer to 0 or 1 than this."""


class Tables:
    """One table for each distinct question: (ones + 1/2) / (answers + 1), the rule of Krichevsky and Trofimov.

    >>> tables = Tables()
    >>> tables.forecast((0, 1)), tables.forecast((1, 0))
    (0.5, 0.5)
    >>> tables.learn((0, 1), 1)
    >>> tables.forecast((0, 1)), tables.forecast((1, 0))
    (0.75, 0.25)
    """

    def __init__(self) -> None:
        self._counts: dict[tuple[int, int], float] = {}

    def forecast(self, question: tuple[int, int]) -> float:
        """q(1) for the question (first, second)."""
        won, lost = self._counts.get(question, 0.0), self._counts.get(question[::-1], 0.0)
        return (won + 0.5) / (won + lost + 1)

    def learn(self, question: tuple[int, int], answer: int) -> None:
        """Count an answer."""
        winner = question if answer else question[::-1]
        self._counts[winner] = self._counts.get(winner, 0.0) + 1


class Logistic:
    """A logistic regression with a normal prior, updated after each answer; no intercept.

    Args:
        variances: (D,) of the prior.

    >>> logistic = Logistic(np.ones(1))
    >>> logistic.learn(np.ones(1), 1)
    >>> round(logistic.forecast(np.ones(1)), 3), round(logistic.forecast(-np.ones(1)), 3)
    (0.587, 0.413)
    """

    def __init__(self, variances: FloatArray) -> None:
        self.mean = np.zeros(len(variances))
        self.covariance = np.diag(variances)

    def forecast(self, x: FloatArray) -> float:
        """q(1) for features (D,), the average over the weights that are still likely."""
        spread = max(float(x @ self.covariance @ x), 0.0)
        return _clip(_sigmoid(float(x @ self.mean) / sqrt(1 + pi * spread / 8)))

    def learn(self, x: FloatArray, answer: int) -> None:
        """Move the mean to where prior and answer balance along x, and narrow the covariance there."""
        along = self.covariance @ x
        spread, z = float(x @ along), float(x @ self.mean)
        if spread <= 0:
            return
        low, high = sorted((z, z + spread * (2 * answer - 1)))
        for _ in range(BISECTIONS):  # z' = z + spread (answer - sigma(z')), whose solution lies between
            middle = (low + high) / 2
            low, high = (middle, high) if middle < z + spread * (answer - _sigmoid(middle)) else (low, middle)
        p = _sigmoid((low + high) / 2)
        self.mean = self.mean + (answer - p) * along
        self.covariance = self.covariance - np.outer(along, along * (p * (1 - p) / (1 + p * (1 - p) * spread)))


class Interactions:
    r"""Features of a question beyond the linear ones, (cycles, bends), negated when its items are exchanged.

    With y, the principal directions of the pool, the question (a, b) has the features
    :math:`y_i(a) y_j(b) - y_j(a) y_i(b)`, which preferences in a cycle need, and :math:`y_i(a) y_j(a) - y_i(b) y_j(b)`,
    which a utility that is not linear in the features needs.

    Args:
        pool: (M, d) features of the items.
    """

    def __init__(self, pool: FloatArray) -> None:
        centred = pool - pool.mean(axis=0)
        _, sizes, directions = np.linalg.svd(centred, full_matrices=False)
        kept = min(DIRECTIONS, int((sizes > 1e-9 * max(float(sizes[0]), 1e-300)).sum()))
        parts = centred @ directions[:kept].T
        self._parts = parts / np.sqrt((parts**2).mean(axis=0))
        i, j = np.triu_indices(kept)
        self._products = self._parts[:, i] * self._parts[:, j]
        self._i, self._j = np.triu_indices(kept, 1)

    def features(self, first: int, second: int) -> tuple[FloatArray, FloatArray]:
        """The features of a question: r (r - 1) / 2 for cycles, r (r + 1) / 2 for bends."""
        a, b = self._parts[first], self._parts[second]
        cycles = a[self._i] * b[self._j] - a[self._j] * b[self._i]
        return np.asarray(cycles), np.asarray(self._products[first] - self._products[second])


def _sigmoid(z: float) -> float:
    return 1 / (1 + exp(-z)) if z >= 0 else exp(z) / (1 + exp(z)) if z > -700 else 0.0


def _clip(q: float) -> float:
    return min(max(q, LEAST), 1 - LEAST)
