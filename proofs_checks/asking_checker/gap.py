"""The certified gap: a bound for every candidate, from dual certificates found by search, evaluated rigorously."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from proofs_checks.asking_checker.barrier import Found, Region, search
from proofs_checks.asking_checker.candidates import Candidates
from proofs_checks.asking_checker.dual import Duals, bounds, duals, nearest
from proofs_checks.verify.enclosed import Enclosed, FloatArray
from proofs_checks.verify.features import IntArray

Deviations = Callable[[IntArray], Enclosed]
"""Features (B, k, d) of policies of Pi near each of B policies (B, S)."""

Tangents = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""For points (B, d) tangents g (B, i, d) and h less the level (B, i), valid for every w of the set."""

ROWS = 24
"""Rivals used at a time."""

SIZES = (1, 4, 16, 64)
"""Candidates searched at a time, the more the longer it takes."""

TURNS, AT_ONCE, NEAR = 12, 8, 1.5
"""Searches for a candidate; candidates whose points are looked up in earlier sets at a time; and up to which multiple
of the target that may help."""

MOST_STUCK = 32
"""Candidates found above the target after which the search ends: no certificate is in sight."""


@dataclass(eq=False)
class Gap:
    """Upper bounds on how much better than the anchor each candidate is, if it is the best.

    Args:
        candidates: contenders.
        anchor: (d,) what contenders are compared with.
        recommended: index of the recommended candidate.
        region: the set, in floats, for searches.
        tangents: what is known about the set.
        deviations: further rivals, or None where only candidates count.
        target: the bound to reach.
        earlier: for points (B, d) what earlier sets say, tangents (J, d) and (J,); None to leave that aside.
    """

    candidates: Candidates
    anchor: Enclosed
    recommended: int
    region: Region
    tangents: Tangents
    deviations: Deviations | None
    target: float
    earlier: Tangents | None = None
    bounds: FloatArray = field(init=False)
    cuts: tuple[FloatArray, FloatArray] = field(init=False)

    def __post_init__(self) -> None:
        d = self.candidates.features.shape[1]
        self.cuts = np.zeros((0, d)), np.zeros(0)
        nothing = np.zeros((1, 0))
        trivial = duals(
            self.anchor, (np.zeros((1, 0, d)), nothing), nothing, Enclosed(np.zeros((1, 0, d)), 0.0), nothing
        )
        self.bounds = np.full(len(self.candidates.features), np.inf)
        self._apply(trivial, np.arange(len(self.bounds)))
        if self.deviations is not None:
            self.bounds[self.recommended] = 0.0  # if it is the best of all policies, the reference is one that it beats

    @property
    def value(self) -> float:
        """The largest bound, at least 0."""
        return max(0.0, float(self.bounds.max()))

    def tighten(self, accuracy: float) -> None:
        """Lower the bounds until all are at most the target, or those above it have been searched themselves."""
        stuck = np.zeros(len(self.bounds), dtype=bool)
        for turn in range(10**6):
            above = np.flatnonzero((self.bounds > self.target) & ~stuck)
            if not len(above) or stuck.sum() >= MOST_STUCK:
                return
            size = min(SIZES[min(turn, len(SIZES) - 1)], len(above))
            order = above[np.argsort(-self.bounds[above], kind="stable")]
            chosen = order[np.linspace(0, len(order) - 1, size).astype(np.int64)]
            self._work_on(chosen, accuracy)
            stuck[chosen] = self.bounds[chosen] > self.target

    def _work_on(self, chosen: IntArray, accuracy: float) -> None:
        """Search for certificates of some candidates, first without rivals, then with those that are violated, and with
        earlier sets that the points found are not in."""
        d = self.candidates.features.shape[1]
        rivals = Enclosed(np.zeros((len(chosen), 0, d)), 0.0)
        found = self._search(chosen, rivals, accuracy)
        for turn in range(TURNS):
            left = self.bounds[chosen] > self.target
            chosen, points = chosen[left], found.points[left]
            if not len(chosen):
                return
            kept = (rivals.mid[left], found.mu[left])
            rivals, news = self._rivals(chosen, points, *kept, rivals.rad)
            near = self.bounds[chosen] <= max(NEAR * self.target, 0.1)
            if self.earlier is not None and near.any() and (turn or not news):
                g, h = self.earlier(points[near][:AT_ONCE])
                self.cuts = np.concatenate([self.cuts[0], g]), np.concatenate([self.cuts[1], h])
                news |= len(h) > 0
            if not news:
                return
            found = self._search(chosen, rivals, accuracy)

    def _search(self, chosen: IntArray, rivals: Enclosed, accuracy: float) -> Found:
        own = self.candidates.features[chosen]
        rows = own[:, None] - rivals.mid
        lengths = np.linalg.norm(rows, axis=2)
        lengths = np.where(lengths > 1e-6, lengths, np.inf)
        size, k = lengths.shape
        g, h = (np.repeat(part[None], size, axis=0) for part in self.cuts)
        steep = np.maximum(np.linalg.norm(g, axis=2), 1e-12)
        offsets = np.concatenate([np.zeros((size, k)), h / steep], axis=1)
        unit = np.concatenate([rows / lengths[..., None], g / steep[..., None]], axis=1)
        found = search(self.region, own - self.anchor.mid, unit, offsets, accuracy, self.target)
        own_g, own_h = self.tangents(found.points)
        c = np.concatenate([found.c[:, None], found.mu[:, k:] / steep], axis=1)
        both = np.concatenate([own_g, g], axis=1), np.concatenate([own_h, h], axis=1)
        dual = duals(self.anchor, both, c, rivals, found.mu[:, :k] / lengths)
        self._apply(dual, np.flatnonzero(self.bounds > self.target))
        return Found(found.points, found.c, found.mu[:, :k])

    def _apply(self, dual: Duals, to: IntArray) -> None:
        features, radii = self.candidates.features[to], self.candidates.radii[to]
        weight_bound = self.region.weight_bound
        best = nearest(dual, features, weight_bound)
        self.bounds[to] = np.minimum(self.bounds[to], bounds(dual, best, features, radii, weight_bound))

    def _rivals(
        self, chosen: IntArray, points: FloatArray, old: FloatArray, mu: FloatArray, radius: float
    ) -> tuple[Enclosed, bool]:
        """The rivals that bind or are violated at the points, and whether any is violated that was not there before."""
        features = self.candidates.features
        ahead = np.stack([(points @ features.T).argmax(axis=1), np.full(len(chosen), self.recommended)], axis=1)
        others, radius = features[ahead], max(radius, float(self.candidates.radii[ahead].max()))
        if self.deviations is not None:
            near = self.deviations(self.candidates.policies[chosen])
            others, radius = np.concatenate([others, near.mid], axis=1), max(radius, near.rad)
        both = np.concatenate([old, others], axis=1)
        rows = features[chosen][:, None] - both
        lengths = np.maximum(np.linalg.norm(rows, axis=2), 1e-6)
        value = np.einsum("bkd,bd->bk", rows, points) / lengths
        binding = np.concatenate(
            [mu > 1e-3 * mu.max(axis=1, initial=1e-12, keepdims=True), np.zeros(others.shape[:2])], 1
        )
        score = np.where(binding > 0, -np.inf, value)
        keep = np.argsort(score, axis=1, kind="stable")[:, :ROWS]
        news = bool((value[:, old.shape[1] :] < -1e-6 * self.region.weight_bound).any())
        return Enclosed(np.take_along_axis(both, keep[..., None], axis=1), radius), news
