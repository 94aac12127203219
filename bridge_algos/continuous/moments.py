"""Running means and variances, merged batch by batch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridge_algos.mdp import FloatArray


@dataclass
class Moments:
    """Mean and sum of squared deviations of the rows seen so far (Chan et al., 1983).

    Args:
        count: number of rows.
        mean: (d,).
        squares: (d,) sums of squared deviations from the mean.
    """

    count: float
    mean: FloatArray
    squares: FloatArray

    @classmethod
    def none(cls, size: int) -> Moments:
        """The moments of no rows of ``size`` entries."""
        return cls(0.0, np.zeros(size), np.zeros(size))

    @property
    def variance(self) -> FloatArray:
        """(d,); zero where nothing was seen."""
        return self.squares / max(self.count, 1.0)

    def add(self, rows: FloatArray) -> None:
        """Take (m, d) rows into account.

        >>> moments = Moments.none(1)
        >>> moments.add(np.array([[1.0], [2.0]])); moments.add(np.array([[6.0]]))
        >>> float(moments.mean[0]), round(float(moments.variance[0]), 12)
        (3.0, 4.666666666667)
        """
        mean, total = rows.mean(axis=0), self.count + len(rows)
        difference = mean - self.mean
        self.squares = (
            self.squares + np.square(rows - mean).sum(axis=0) + np.square(difference) * (self.count * len(rows) / total)
        )
        self.mean = self.mean + difference * (len(rows) / total)
        self.count = total
