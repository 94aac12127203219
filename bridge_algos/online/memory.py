"""What a learner has seen: comparisons, their data matrices, transition counts, and the pairs it played."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bridge_algos.mdp import FloatArray, IntArray


class Rows:
    """An array (n, ...) that grows at its end, in a store that doubles when full: n appends copy O(n) rows in all."""

    def __init__(self, *shape: int) -> None:
        self._store = np.empty((64, *shape))
        self._used = 0

    def append(self, rows: FloatArray) -> None:
        end = self._used + len(rows)
        if end > len(self._store):
            grown = np.empty((max(end, 2 * len(self._store)), *self._store.shape[1:]))
            grown[: self._used] = self.values
            self._store = grown
        self._store[self._used : end] = rows
        self._used = end

    @property
    def values(self) -> FloatArray:
        """A view of the rows so far; it stays valid and unchanged when more are appended."""
        return self._store[: self._used]


@dataclass
class Memory:
    """Grows by one entry a round.

    Args:
        x: (m, d) scaled feature differences of the trajectories compared.
        outcomes: (m,) answers.
        counts: (S, A, S) pooled transition counts, or None where the dynamics are known.
        matrix: (d, d) data matrix of the confidence set.
        observed: (d, d) data matrix of the observed differences, in whose norm weights are projected.
        played_visits: (2, S, A) expected visits of each round's pair, where the multiplier needs them.
        counts_then: (S, A) pair counts before each round, likewise.
    """

    x: Rows
    outcomes: Rows
    counts: IntArray | None
    matrix: FloatArray
    observed: FloatArray
    played_visits: list[FloatArray] = field(default_factory=list)
    counts_then: list[IntArray] = field(default_factory=list)
