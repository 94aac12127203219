r"""The certified gap of the recommended candidate: every contender gets its own bound (companion G3 and G3').

.. math:: U(\pi^*) - U(\hat\pi) - \rho\,(U(\hat\pi) - U(\pi_0))
          \le \max_\pi \max_{w \in C_t} \langle \phi(\pi) - (1 + \rho) \phi(\hat\pi) + \rho \phi(\pi_0), w \rangle

A contender matters only if it is the best one; so its maximum is taken over the weights under which it beats its
rivals. The bounds hold for all t at once, so that a bound found earlier stays valid: each is only ever lowered, and
only those that decide whether to stop are worked on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from itertools import product

import numpy as np

from bridge_algos.asking.dual import PENALTY, Certificates, LikelihoodSet, search
from bridge_algos.asking.feature_errors import FeatureErrors
from bridge_algos.mdp import FloatArray, IntArray

Rivals = Callable[[IntArray], FloatArray]
"""Features (B, k, d) of policies that each of B candidates must beat if it is the best."""

MOST_ROWS = 16
"""Rivals used at a time: those that the candidate violates most at the point found without them."""

BATCHES = (8, 32, 64)
"""Contenders searched at a time, after the one of the largest bound; the more, the longer none is above the target."""

SHARED, SHARED_BLOCK = 32, 4096
"""Contenders from which on certificates are tried on their neighbours, and neighbours tried at a time."""

LOOK_AGAIN = 1.03
"""Growth of the answers after which the critical contender is searched for afresh, even if it stands.

In between, weights that still are in the set and above the target show that nothing can be certified, but for rivals
that were not among the rows: a session may stop up to 3 % later than it could.
"""

TOLERANCE = 0.02
"""How exactly a bound above the target is computed, relative to the scale."""


@dataclass(frozen=True, eq=False)
class Critical:
    """The contender that a certificate fails at.

    Args:
        contender: its index.
        direction: (d,) v, its difference to what it is compared with.
        weights: (d,) weights in the likelihood set under which it is too good.
        rows: (k, d) what it must be better at than its rivals.
        ease: (k,) how far below 0 these may be, where features are estimates.
        allowed: nats that the direction's utility may reach.
        recommended: what was recommended then.
        answers: how many there were.
    """

    contender: int
    direction: FloatArray
    weights: FloatArray
    rows: FloatArray
    ease: FloatArray
    allowed: float
    recommended: int
    answers: int


class Gap:
    """Bounds on how much better each candidate can be than the recommended one.

    Args:
        features: (N, d) of the candidates, distinct rows.
        weight_bound: W.
        target: the bound at which to stop.
        scale: nats, what bounds are computed to a fraction of.
        rivals: features of policies that a candidate must beat, besides the candidates themselves; None for none.
        reference: (d,) features of the reference and rho; None for the gap alone. With rivals, the reference must be a
            policy, or a mixture, that the best candidate beats too.
        errors: where features are estimates: maps the recommended candidate to the errors of the differences to it.
    """

    def __init__(
        self,
        features: FloatArray,
        weight_bound: float,
        target: float,
        scale: float,
        rivals: Rivals | None = None,
        reference: tuple[FloatArray, float] | None = None,
        errors: Callable[[int], FeatureErrors] | None = None,
    ) -> None:
        self.features, self.weight_bound, self.target, self.rivals = features, weight_bound, target, rivals
        self.tolerance = TOLERANCE * scale
        self.reference, self.errors = reference, errors
        self.recommended, self._errors = 0, None if errors is None else errors(0)
        self.bounds = self._widest(0)
        self.critical: Critical | None = None

    @property
    def value(self) -> float:
        """The largest bound: the certified gap in nats, where there is no reference."""
        return max(0.0, float(self.bounds.max()))

    @property
    def open(self) -> bool:
        """Whether answers could still lower the gap to the target: not where errors of features alone exceed it."""
        return self._radii()[self.recommended] <= self.target and len(self._above()) > 0

    def anchor(self, candidate: int) -> FloatArray:
        """(d,) what contenders are compared with when that candidate is recommended."""
        own = self.features[candidate]
        if self.reference is None:
            return np.asarray(own)
        features, rho = self.reference
        return np.asarray((1 + rho) * own - rho * features)

    def recommend(self, candidate: int, region: LikelihoodSet) -> None:
        """Recommend another candidate; what is known about the old differences is carried over."""
        if candidate == self.recommended:
            return
        v = (self.anchor(self.recommended) - self.anchor(candidate))[None]
        shift = float(search(region, v, np.zeros((1, 0, v.shape[1])), self.tolerance).bound[0])
        shift += float(self._radii()[candidate])
        self.recommended, self._errors = candidate, None if self.errors is None else self.errors(candidate)
        self.bounds = np.minimum(self.bounds + shift, self._widest(candidate))

    def tighten(self, region: LikelihoodSet) -> None:
        """Lower the largest bounds until all are at most the target, or one is known to lie above it."""
        if not self.open or self._still_above(region):
            return
        if self._work_on_the_largest(region):
            return
        passed = 0
        while len(above := self._above()):
            size = min(BATCHES[min(passed, len(BATCHES) - 1)], len(above))
            chosen = above[np.argpartition(-self.bounds[above], size - 1)[:size]]
            if size >= SHARED:  # far from each other rather than near the top, so that their certificates reach further
                chosen = above[np.linspace(0, len(above) - 1, size).astype(np.int64)]
            if self._work_on(region, chosen):
                return
            passed += 1

    def _still_above(self, region: LikelihoodSet) -> bool:
        """Whether the weights found last still show a bound above the target; looked at afresh as answers grow."""
        last = self.critical
        if last is None or last.recommended != self.recommended or self.bounds[last.contender] <= self.target:
            return False
        if region.answers.total > LOOK_AGAIN * last.answers:
            return False
        w = last.weights
        inside = w @ w < region.weight_bound**2 and region.answers.log_likelihood(w[None])[0] > region.level
        short = float(np.maximum(0, -(last.rows @ w) - last.ease).max(initial=0.0))
        return bool(inside and last.direction @ w - PENALTY * short > last.allowed)

    def _above(self) -> IntArray:
        """Contenders whose bounds are above the target."""
        above = self.bounds > self.target
        if self.errors is not None:  # no answer lowers the error of the features, which is the recommended one's bound
            above[self.recommended] = False
        return np.flatnonzero(above)

    def tight(self, region: LikelihoodSet) -> float:
        """The certified gap in nats with every contender's bound computed to the tolerance, not only as far as decides.

        Nothing is remembered: a session asks the same questions whether or not this is looked at. The set may have
        another W; bounds found for this one hold for smaller ones only.
        """
        known = self.bounds if region.weight_bound <= self.weight_bound else np.full(len(self.features), np.inf)
        open_ = np.flatnonzero(known > 0)
        if not len(open_):
            return 0.0
        nothing = np.zeros((len(open_), 0))
        alone, _, _ = self._search(region, open_, nothing[..., None] * self.features[0], nothing, decide=False)
        rows, _, ease = self._rows(open_, alone.points)
        bounds = np.minimum(alone.bound, self._search(region, open_, rows, ease, decide=False)[0].bound)
        return max(0.0, float(np.minimum(bounds, known[open_]).max()))

    def _work_on(self, region: LikelihoodSet, chosen: IntArray) -> bool:
        """Bound some contenders; whether one of them lies above the target."""
        nothing = np.zeros((len(chosen), 0))
        found, v, rest = self._search(region, chosen, nothing[..., None] * self.features[0], nothing)
        self.bounds[chosen] = np.minimum(self.bounds[chosen], found.bound)
        self._share(chosen, found, v, rest, np.ones(len(chosen)))
        left = np.flatnonzero(self.bounds[chosen] > self.target)
        if not len(left):
            return False
        return self._work_with_rivals(region, chosen[left], found.points[left])

    def _work_with_rivals(self, region: LikelihoodSet, chosen: IntArray, points: FloatArray) -> bool:
        """Bound contenders over the weights under which they beat their rivals; whether one lies above the target."""
        rows, norms, ease = self._rows(chosen, points)
        found, v, rest = self._search(region, chosen, rows, ease)
        self.bounds[chosen] = np.minimum(self.bounds[chosen], found.bound)
        self._share(chosen, found, v, rest, 1 + (found.rival_multipliers / norms).sum(axis=1))
        worst = int(self.bounds[chosen].argmax())
        if self.bounds[chosen][worst] <= self.target:
            return False
        contender = int(chosen[worst])
        total, allowed = region.answers.total, self.target - float(rest[worst])
        self.critical = Critical(
            contender, v[worst], found.inside[worst], rows[worst], ease[worst], allowed, self.recommended, total
        )
        return True

    def _work_on_the_largest(self, region: LikelihoodSet) -> bool:
        """Bound the contender of the largest bound, with the rivals that it violates where the curvature leads.

        Bounds are lowered one at a time, so that the largest one is also the oldest: all contenders get their turn.
        """
        chosen = self._above()[[self.bounds[self._above()].argmax()]]
        v, center = self.features[chosen[0]] - self.anchor(self.recommended), region.interior
        value, _, curvature = region.answers.derivatives(center[None])
        step = np.linalg.solve(curvature[0] + 2 / region.weight_bound**2 * np.eye(len(center)), v)
        reach = np.sqrt(2 * (value[0] - region.level) / max(float(v @ step), 1e-300))
        return self._work_with_rivals(region, chosen, (center + reach * step)[None])

    def _radii(self) -> FloatArray:
        """(N,) nats by which the difference of each candidate to the recommended one may be off, over the ball."""
        if self._errors is None:
            return np.zeros(len(self.features))
        return np.asarray(self.weight_bound * self._errors.radii * (1 + 1e-12))

    def _search(
        self, region: LikelihoodSet, chosen: IntArray, rows: FloatArray, ease: FloatArray, decide: bool = True
    ) -> tuple[Certificates, FloatArray, FloatArray]:
        """Certificates of contenders, their directions (B, d), and the nats (B,) that were added to bounds.

        Where features are estimates a contender's difference to the recommended candidate lies among the corners of its
        axes, within a rest; the certificate is that of the worst corner, and its bound, with the rest, holds for all.
        """
        v = self.features[chosen] - self.anchor(self.recommended)
        if self._errors is None:
            found = search(region, v, rows, self.tolerance, self.target if decide else None)
            return found, v, np.zeros(len(chosen))
        axes, rest = self._errors.axes(chosen, v.shape[1])
        rest = self.weight_bound * rest * (1 + 1e-12)
        signs = np.array(list(product((1.0, -1.0), repeat=axes.shape[1])))
        corners = v[:, None] + signs @ axes
        size, count = corners.shape[:2]
        every, d, allowed = np.repeat(np.arange(size), count), v.shape[1], self.target - rest
        until = allowed[every] if decide else None
        tried = search(region, corners.reshape(-1, d), rows[every], self.tolerance, until, ease[every])
        worst = np.arange(size) * count + tried.bound.reshape(size, count).argmax(axis=1)
        parts = {field.name: getattr(tried, field.name)[worst] for field in fields(tried)}
        return replace(Certificates(**parts), bound=tried.bound[worst] + rest), corners.reshape(-1, d)[worst], rest

    def _share(
        self, chosen: IntArray, found: Certificates, v: FloatArray, added: FloatArray, factor: FloatArray
    ) -> None:
        """Bound the neighbours of contenders by their certificates, which lose W (1 + sum mu) per unit of distance.

        Every rival of a contender is a rival of its neighbour too; so the same dual point bounds both. Where features
        are estimates the neighbour's radius counts 1 + sum mu times, instead of the contender's in the rows of rivals.
        """
        others = np.flatnonzero(self.bounds > self.target)
        if len(chosen) < SHARED or len(others) < SHARED:
            return
        good = found.bound <= self.target
        rest, factor, bound = found.rest[good], factor[good], (found.bound - added)[good]
        own, origin, radii = np.vecdot(rest, rest), v[good] + self.anchor(self.recommended), self._radii()
        bound = bound - (factor - 1) * radii[chosen[good]]
        for part in range(0, len(others), SHARED_BLOCK):
            at = others[part : part + SHARED_BLOCK]
            # || rest + factor (phi' - phi) ||^2, expanded so that it is one product
            shift = rest - factor[:, None] * origin
            squares = np.vecdot(shift, shift)[:, None] + 2 * factor[:, None] * (shift @ self.features[at].T)
            squares += factor[:, None] ** 2 * np.vecdot(self.features[at], self.features[at])
            size = np.abs(squares).max(initial=0.0) + np.vecdot(self.features[at], self.features[at]).max(initial=0.0)
            lengths = np.sqrt(np.maximum(squares, 0) + 1e-13 * size * factor[:, None] ** 2)
            bounds = bound[:, None] + self.weight_bound * (lengths - np.sqrt(own)[:, None])
            bounds += factor[:, None] * radii[at]
            self.bounds[at] = np.minimum(self.bounds[at], bounds.min(axis=0, initial=np.inf) * (1 + 1e-12) + 1e-12)

    def _rows(self, contenders: IntArray, points: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Unit rows phi(contender) - phi(rival), (B, k, d), the most violated at the points, their lengths, and ease.

        Zero rows, of length infinity, fill up. The ease (B, k) is how far below 0 a row's product with the weights may
        be where features are estimates: both differences to the recommended candidate may be off.
        """
        ahead = (points @ self.features.T).argmax(axis=1)
        others = np.stack(
            [self.features[ahead], np.broadcast_to(self.features[self.recommended], points.shape)], axis=1
        )
        radii = self._radii()
        wide = np.stack([radii[ahead], np.zeros(len(ahead))], axis=1)
        if self.rivals is not None:
            others = np.concatenate([others, self.rivals(contenders)], axis=1)
            more = np.zeros((len(ahead), others.shape[1] - 2))
            if self._errors is not None and self._errors.rivals is not None:
                more = self.weight_bound * self._errors.rivals(contenders) * (1 + 1e-12)
            wide = np.concatenate([wide, more], axis=1)
        rows = self.features[contenders][:, None] - others
        norms = np.linalg.norm(rows, axis=2)
        norms = np.where(norms > 1e-9, norms, np.inf)
        rows, ease = rows / norms[..., None], (wide + radii[contenders, None]) / norms
        keep = np.argsort(np.einsum("bkd,bd->bk", rows, points) + ease, axis=1)[:, :MOST_ROWS]
        norms, ease = (np.take_along_axis(part, keep, axis=1) for part in (norms, ease))
        return np.take_along_axis(rows, keep[..., None], axis=1), norms, ease

    def _widest(self, recommended: int) -> FloatArray:
        """Bounds that hold before any answer: W ||v||."""
        lengths = np.linalg.norm(self.features - self.anchor(recommended), axis=1)
        radii = self._radii()
        bounds = np.asarray(self.weight_bound * lengths * (1 + 1e-12)) + radii
        if self.reference is None:
            bounds[recommended] = radii[recommended]
        elif self.rivals is not None:
            bounds[recommended] = 0.0  # if it is the best of all policies, no reference is above it
        return bounds
