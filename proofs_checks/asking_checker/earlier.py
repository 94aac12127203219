"""What earlier answers alone have shown: the weights lie in every set so far, so that all tangents count.

A session stops when its last bound falls, and other bounds may have fallen before, in a set that later answers widened.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from proofs_checks.asking_checker.barrier import Region, log_likelihood
from proofs_checks.asking_checker.evidence import level
from proofs_checks.asking_checker.fit import log_sigmoid
from proofs_checks.asking_checker.log import Log
from proofs_checks.asking_checker.slopes import tangents
from proofs_checks.verify.enclosed import FloatArray

TRIED, MOST_LEVELS = 3, 60
"""Earlier sets looked at for a point, and in all."""


@dataclass(eq=False)
class Earlier:
    """Tangents of earlier sets.

    Args:
        log, precisions, delta: what their levels rest on.
        region: the present set.
    """

    log: Log
    precisions: tuple[float, ...]
    delta: float
    region: Region
    levels: dict[int, float] = field(init=False, default_factory=dict)

    def cuts(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Tangents g (J, d), and h less the level (J,), of earlier sets that some of the points (B, d) are not in."""
        g, h = [np.zeros((0, points.shape[1]))], [np.zeros(0)]
        for w in points:
            for until in self._likeliest(w):
                least = self._level(until)
                if least is None:
                    continue
                slope, height = tangents(self.log, w[None], until)
                room = np.nextafter(height - least, np.inf)
                if slope[0] @ w + room[0] < 0:
                    g, h = [*g, slope], [*h, room]
        return np.concatenate(g), np.concatenate(h)

    def _level(self, until: int) -> float | None:
        if until not in self.levels and len(self.levels) < MOST_LEVELS:
            self.levels[until] = level(self.log, self.precisions, self.delta, until)
        return self.levels.get(until)

    def _likeliest(self, w: FloatArray) -> list[int]:
        """Numbers of answers after which the point seems to be furthest outside; a guess."""
        total = len(self.log.answers)
        if total < 2:
            return []
        signs = 2.0 * self.log.answers - 1
        z, best = (self.log.x @ w)[self.log.rows] * signs, (self.log.x @ self.region.inside)[self.log.rows] * signs
        lost = np.cumsum(log_sigmoid(z) - log_sigmoid(best))[:-1]
        margin = float(log_likelihood(self.region, self.region.inside[None])[0]) - self.region.level
        flat = np.log(1 / self.delta)
        allowed = flat + max(0.0, margin - flat) * np.log1p(np.arange(1, total)) / np.log1p(total)
        return [int(i) + 1 for i in np.argsort(lost + allowed, kind="stable")[:TRIED]]
