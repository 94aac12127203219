r"""Pi_t of a run with ``confidence="likelihood"`` (companion G6), found a second time to contradict the run's claims.

.. math:: \Pi_t = \{\pi \in \Pi_{t-1} : \max_{w \in C_t} \langle \phi(\pi) - \phi(\hat\pi), w \rangle \ge 0\}

after the ellipsoid of :mod:`proofs_checks.verify.around` has ruled out what it can, where :math:`\hat\pi` is best at
its middle. The answers are looked at when they have grown by 2 %. No bound of a certificate uses any of this.
"""

from __future__ import annotations

import numpy as np
from flint import arb

from proofs_checks.verify.around import Around, ellipsoid_around
from proofs_checks.verify.enclosed import Enclosed, FloatArray
from proofs_checks.verify.evidence import Answers
from proofs_checks.verify.farthest import expansion, farthest, fit_in_ball
from proofs_checks.verify.features import IntArray
from proofs_checks.verify.likelihood import dual_bounds, tangent
from proofs_checks.verify.policies import worst_margins

GROWTH = 1.02
CLOSE = 1e-4
"""Relative to W ||v||: a maximum nearer to 0 than this is one that the run may have judged either way."""

ROUNDED = 1e-6
"""Relative to the largest margin: how far outside of the ellipsoid's set a policy may be that the run still keeps."""


class Remaining:
    """Which policies the run should still consider.

    Args:
        weight_bound, delta, slope: of the run.
        policies: N.
    """

    def __init__(self, weight_bound: float, delta: float, slope: float, policies: int) -> None:
        self.weight_bound, self.delta, self.slope = weight_bound, delta, slope
        self.inside, self.perhaps = np.ones(policies, dtype=bool), np.ones(policies, dtype=bool)
        self.looked = -1
        self.around = Around(np.zeros(0), np.zeros((0, 0)), 0.0, 0.0)
        self.answers: Answers | None = None

    def look(self, differences: IntArray, outcomes: FloatArray) -> Around:
        """The ellipsoid after the answers (m,) to differences (m, d), or after the last look."""
        if self.looked < 0 or len(outcomes) > GROWTH * self.looked:
            self.looked = len(outcomes)
            telling = differences.any(axis=1) & np.isin(outcomes, (0.0, 1.0))
            x, outcomes = differences[telling], outcomes[telling]
            self.answers = Answers.counted(x, outcomes) if len(x) else None
            self.around = ellipsoid_around(self.slope * x.astype(np.float64), outcomes, self.weight_bound, self.delta)
        return self.around

    def settle(self, features: FloatArray, z: FloatArray, bonus: FloatArray) -> None:
        """Rule out what the look allows, of policies with features and whitened features (N, d) and bonuses (N,)."""
        members = np.flatnonzero(self.perhaps)
        scores = (features @ self.around.center)[members]
        own, extra = z[members], bonus[members]
        reach = 2 * float(np.linalg.norm(own - own.mean(axis=0), axis=1).max())
        size = float(np.abs(scores).max() + extra.max()) + self.around.radius * reach
        lowest, highest = worst_margins(Enclosed(scores, 0.0), Enclosed(own, 0.0), self.around.radius, extra)
        self.inside[members] &= lowest >= -1e-9 * size - 1e-12  # rounding may keep a policy, but never rules one out
        self.perhaps[members] &= highest >= -ROUNDED * size - 1e-12
        if self.answers is not None and not bonus.any():
            self._compare(self.answers, features)
            self.answers = None

    def _compare(self, answers: Answers, features: FloatArray) -> None:
        """Rule out policies that do worse than the best at the ellipsoid's middle under all weights left."""
        members = np.flatnonzero(self.perhaps)
        scores = features[members] @ self.around.center
        v = features[members] - features[members[int(scores.argmax())]]
        # weights times the slope explain the differences themselves
        weight_bound, level = self.slope * self.weight_bound, self.around.level
        nearly = CLOSE * weight_bound * np.linalg.norm(v, axis=1)
        start = fit_in_ball(answers, weight_bound, np.zeros(v.shape[1]))
        if not expansion(answers, start)[0] > level:
            self.inside[members[nearly > 0]] = False
            return
        best, worst = v @ start, weight_bound * np.linalg.norm(v, axis=1)
        while True:
            open_ = (best <= nearly) & (worst >= -nearly) & (nearly > 0)
            if not open_.any():
                break
            i = int(np.flatnonzero(open_)[0])
            w = farthest(answers, level, weight_bound, v[i], start)
            worst = np.minimum(worst, dual_bounds(Enclosed(v, 0.0), tangent(answers, arb(level), w), weight_bound))
            best = np.maximum(best, v @ w)
            if best[i] <= nearly[i] and worst[i] >= -nearly[i]:  # too near to tell
                self.inside[members[i]] = False
                nearly[i] = 0.0
        self.perhaps[members] &= worst >= -nearly
        self.inside &= self.perhaps
