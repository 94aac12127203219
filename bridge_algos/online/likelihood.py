r"""Pi_t from the likelihood set of the answers (companion G6), which needs no kappa.

With :math:`C_t` the weights of norm at most W that the answers leave (companion G1'), :math:`\pi^*` stays in

.. math:: \Pi_t = \{\pi \in \Pi_{t-1} : \max_{w \in C_t} \langle \phi(\pi) - \phi(\hat\pi), w \rangle \ge 0\}

as long as :math:`w^* \in C_t`, for any :math:`\hat\pi` of :math:`\Pi_{t-1}`: here the one that the middle of the
ellipsoid around :math:`C_t` (companion G5) holds for best. A policy goes by the ellipsoid, which is loose and cheap, or
by a dual certificate (companion G2). Weights of the set under which a policy is better keep it without a search.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bridge_algos.asking.answers import Answers
from bridge_algos.asking.dual import LikelihoodSet, search, shared_bounds
from bridge_algos.asking.ellipsoid import Ellipsoid, likelihood_ellipsoid
from bridge_algos.asking.region import likelihood_set
from bridge_algos.mdp import FloatArray
from bridge_algos.online.cholesky import inverse_root
from bridge_algos.online.policy_filter import surviving
from bridge_algos.shapes import Kept

LOOK_AGAIN = 1.02
"""Growth of the answers after which they are looked at again: until 50 of them, after each."""

BATCH = 16
"""Policies searched at a time."""

MOST_WITNESSES = 256
"""Weights remembered that keep policies."""


class LikelihoodFilter:
    """What the answers of a run leave of weights and policies; the sets only shrink, and the last policy stays.

    Args:
        weight_bound: W.
        delta: probability that the weights leave the set after some answer.

    >>> answers = LikelihoodFilter(4.0, 0.05)
    >>> _ = answers.look(np.ones((60, 1)), np.ones(60))  # the first item won sixty times
    >>> answers.survivors(np.array([[0.0], [1.0]]), np.zeros(2), np.array([True, True]))
    array([False,  True])
    """

    def __init__(self, weight_bound: float, delta: float) -> None:
        self.weight_bound, self.delta = weight_bound, delta
        self._ellipsoid: Ellipsoid | None = None
        self._region: LikelihoodSet | None = None
        self._answers: Answers | None = None
        self._told = self._looked = 0
        self._witnesses = np.zeros((0, 0))
        self._kept: Kept | None = None

    def look(self, x: FloatArray, outcomes: FloatArray) -> Ellipsoid:
        """The ellipsoid after all answers (m,) to differences (m, d), or one of nearly as many.

        Equal trajectories, and answers but 0 and 1, tell nothing.
        """
        if self._ellipsoid is None or len(outcomes) > LOOK_AGAIN * self._looked:
            self._looked = len(outcomes)
            telling = x.any(axis=1) & np.isin(outcomes, (0.0, 1.0))
            self._ellipsoid = likelihood_ellipsoid(x[telling], outcomes[telling], self.weight_bound, self.delta)
            self._region = self._set(x, outcomes, telling, self._ellipsoid)
        return self._ellipsoid

    def survivors(self, features: FloatArray, bonus: FloatArray, challenging: NDArray[np.bool_]) -> Kept:
        """Pi_t of policies with features and bonuses, (N,), by what was looked at last.

        Args:
            features: (N, d).
            bonus: (N,) how far features may be off, in utility; dual certificates are for exact ones alone.
            challenging: (N,) which policies may rule others out; the others are only told about.
        """
        kept = np.ones(len(features), dtype=bool) if self._kept is None else self._kept.copy()
        ellipsoid = self._ellipsoid
        if ellipsoid is not None and not ellipsoid.empty:
            scores, z = features @ ellipsoid.center, features @ inverse_root(ellipsoid.matrix).T
            others = np.flatnonzero(kept & challenging)
            upper, lower = (scores + bonus)[kept], (scores - bonus)[others]
            kept[kept] = surviving(upper, lower, z[kept], ellipsoid.radius, z[others])
            if self._region is not None and not bonus.any():
                others = np.flatnonzero(kept & challenging)
                best = features[others[int(scores[others].argmax())]]
                kept[kept] = ~self._dominated(self._region, features[kept] - best)
                self._region = None  # until the next look nothing changes
        self._kept = kept
        return kept

    def _set(
        self, x: FloatArray, outcomes: FloatArray, telling: NDArray[np.bool_], around: Ellipsoid
    ) -> LikelihoodSet | None:
        """The set with a point inside; None where none is found."""
        answers = self._answers or Answers(x.shape[1])
        for s in np.flatnonzero(telling[self._told :]) + self._told:
            answers.add(x[s], int(outcomes[s]))
        self._answers, self._told = answers, len(outcomes)
        if around.empty or not answers.total:
            return None
        norm = float(np.linalg.norm(around.center))
        start = around.center * min(1.0, 0.99 * self.weight_bound / max(norm, 1e-300))
        return likelihood_set(answers, around.level, self.weight_bound, start)

    def _dominated(self, region: LikelihoodSet, v: FloatArray) -> NDArray[np.bool_]:
        """Which directions (N, d) are negative for all weights of the set, (N,)."""
        known = self._witnesses.reshape(-1, v.shape[1])
        known = known[region.answers.log_likelihood(known) >= region.level]
        known = np.concatenate([known, region.interior[None]])[-MOST_WITNESSES:]
        gone, open_ = np.zeros(len(v), dtype=bool), (v @ known.T).max(axis=1) < 0
        while open_.any():
            chosen = np.flatnonzero(open_)[:BATCH]
            found = search(region, v[chosen], np.zeros((len(chosen), 0, v.shape[1])), 0.0, target=0.0)
            open_[chosen] = False
            gone[chosen] = found.bound < 0
            for point in found.points[found.bound < 0]:
                rest = np.flatnonzero(open_)
                ruled = rest[shared_bounds(region, v[rest], point) < 0]
                gone[ruled], open_[ruled] = True, False
            inside = found.inside[found.reached >= 0]
            open_ &= ~((v @ inside.T) >= 0).any(axis=1)
            known = np.concatenate([known, inside])[-MOST_WITNESSES:]
        self._witnesses = known
        return gone
