r"""Ask and tell: a session that asks preference questions and says when the answers certify a recommendation.

>>> import numpy as np
>>> from scipy.special import expit
>>> rng = np.random.default_rng(0)
>>> features = rng.normal(size=(6, 3))
>>> truth = np.array([1.0, -0.5, 0.2])
>>> session = Elicitation(features, weights=Ball(2.0), pool=rng.normal(size=(200, 3)), delta=0.05,
...                       until="0.5nats", rng=rng)
>>> while not session.done:
...     question = session.ask()
...     session.tell(question, int(rng.random() < expit(question.difference @ truth)))
>>> bool((features @ truth).max() - features[session.recommended] @ truth <= 0.5)
True
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from math import log
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import expit

from bridge_algos.asking.answers import Answers
from bridge_algos.asking.candidates import distinct_rows
from bridge_algos.asking.certificate import Certificate
from bridge_algos.asking.consistency import Consistency
from bridge_algos.asking.dual import LikelihoodSet, search
from bridge_algos.asking.evidence import Evidence
from bridge_algos.asking.feature_errors import FeatureErrors
from bridge_algos.asking.gap import Gap, Rivals
from bridge_algos.asking.goal import goal
from bridge_algos.asking.model_test import ModelTest, empty_in_words, nobody_in_words, refuted_in_words
from bridge_algos.asking.region import highest, is_empty, likelihood_set, needs_weight_bound, span_of_differences
from bridge_algos.asking.rules import State, check_rule, choose
from bridge_algos.asking.skips import skip_warning
from bridge_algos.asking.vacuous import best_somewhere
from bridge_algos.mdp import FloatArray, IntArray
from bridge_theory.errors import InputError

PRIOR_SCALES = (1.0, 4.0, 16.0)
"""Precisions of the prior's components, in units of d / W^2: weights of norm W, W/2 and W/4."""


@dataclass(frozen=True)
class Ball:
    """Weights of norm at most W, an assumption about the teacher."""

    radius: float


@dataclass(frozen=True, eq=False)
class Question:
    """Which of two items of the pool is better?

    Args:
        number: 0, 1, ... in the order in which answers count.
        first, second: indices into the pool.
        difference: (d,) features of the first minus those of the second.
    """

    number: int
    first: int
    second: int
    difference: FloatArray


class Elicitation:
    """One session; with one delta, spent once.

    Args:
        features: (N, d) expected features of the candidates; equal rows must be merged beforehand.
        weights: the assumption about the teacher's weights.
        pool: (M, d) features of the items that questions show, or a function that draws them with the generator; items
            of equal features are shown by the first of them.
        delta: failure probability of the session.
        until: when to stop, see :func:`bridge_algos.asking.goal.goal`.
        rng: the source of all randomness.
        utility_range: best minus worst utility over all policies, for ``until="10%"``.
        reference: (d,) features of the policy that shares are measured against.
        rivals: features of further policies that the best candidate is known to beat; None for none.
        owners: (M,) candidate that each item was drawn from, for the rule ``challenger``.
        asking: one of the rules of :mod:`bridge_algos.asking.rules`.
        fresh: whether the same pair asked again is a fresh draw, as with a simulated teacher; a person remembers.
        offline: what the candidates rest on and its failure probability, for the certificate.
        errors: where features are estimates: maps a candidate to the errors of the differences to it, for example
            :attr:`bridge_algos.asking.rollout_estimates.Estimate.errors`; equal rows need not be merged then.

    Raises:
        InputError: for values out of range, one candidate, equal candidates, or shapes that do not fit.
    """

    def __init__(
        self,
        features: ArrayLike,
        weights: Ball,
        pool: ArrayLike | Callable[[np.random.Generator], ArrayLike],
        delta: float,
        until: str,
        rng: np.random.Generator,
        *,
        utility_range: float | None = None,
        reference: ArrayLike | None = None,
        rivals: Rivals | None = None,
        owners: ArrayLike | None = None,
        asking: str = "pool",
        fresh: bool = False,
        offline: tuple[str, float] | None = None,
        errors: Callable[[int], FeatureErrors] | None = None,
    ) -> None:
        self.features = _matrix("features", features)
        self.pool = _matrix("pool", pool(rng) if callable(pool) else pool)
        self.reference = None if reference is None else _matrix("reference", np.atleast_2d(reference))[0]
        _check(self.features, self.pool, weights, delta, self.reference, estimated=errors is not None)
        self.goal = goal(until, utility_range)
        if self.goal.rho and reference is None:
            raise InputError(f"until={until!r} needs a reference; give reference=, the features of a policy.")
        if errors is not None and reference is not None:
            raise InputError("shares need exact features; leave out reference= where features have errors.")
        self.asking, self.delta, self.weight_bound, self.fresh = check_rule(asking), delta, weights.radius, fresh
        self.rng, self.offline = rng, offline
        dimension = self.features.shape[1]
        unit = dimension / weights.radius**2
        self.answers = Answers(dimension)
        self.evidence = Evidence([scale * unit for scale in PRIOR_SCALES], dimension)
        self._center = np.zeros(dimension)
        self._region: LikelihoodSet | None = None
        self._somebody = True  # whether a candidate is known to be best under weights that are left
        self._items, self._shown, groups = np.unique(self.pool, axis=0, return_index=True, return_inverse=True)
        self._groups = groups.ravel()
        self._span = span_of_differences(np.concatenate([self.features, self._items]))
        self.test = ModelTest(self.pool, self._groups, weights.radius)
        self.check = Consistency(self.pool, self._groups, PRIOR_SCALES[1] * unit, fresh)
        self._owners = np.full(len(self.pool), -1) if owners is None else np.asarray(owners)
        aim = None if self.reference is None or not self.goal.rho else (self.reference, self.goal.rho)
        spread = 0.0 if aim is None else float(np.linalg.norm(self.features - aim[0], axis=1).max())
        scale = self.goal.nats or 0.1 * spread * weights.radius
        self.gap = Gap(self.features, weights.radius, self.goal.nats, scale, rivals, aim, errors)
        self.history: list[tuple[int, int, int | None]] = []
        self.contradiction: str | None = None  # in words, and for good
        self._pending: Question | None = None
        self._asked: set[tuple[int, int]] = set()
        self._look()

    @property
    def recommended(self) -> int:
        """Index of the candidate to take."""
        return self.gap.recommended

    @property
    def contradicted(self) -> bool:
        """Whether the answers contradict the model or W; then nothing is certified, whatever is answered later."""
        return self.contradiction is not None

    @property
    def reached(self) -> bool:
        """Whether the answers so far show the goal, if they follow the model."""
        return not self.contradicted and self.gap.value <= self.goal.nats and self._somebody

    @property
    def certified(self) -> bool:
        """Whether the goal is reached, and check questions bear the model out."""
        return self.reached and (self.check.passed or not self.answers.total)

    @property
    def done(self) -> bool:
        """Whether there is nothing more to ask: the goal is reached, the answers contradict the model, or what is left
        is the error of features, which only more rollouts lower.
        """
        low = self.gap.value <= self.goal.nats
        return self.contradicted or self.certified or not (low or self.gap.open)

    def ask(self) -> Question:
        """The next question; the same one until it is told."""
        if self.contradicted:
            raise InputError(f"{self.contradiction}; no question can certify anything.")
        if self._pending is None:
            if self.done and not self.certified:
                raise InputError("the errors of the features alone exceed the goal; give features from more rollouts.")
            if self.gap.critical is None:
                raise InputError("nothing is left to ask: every candidate is certified.")
            if self.reached and not self.certified and self.check.question is not None:
                self._pending = self._question(*self.check.question)
                return self._pending
            asked = None if self.fresh else self._asked
            state = State(self._items, self._items_of, *self._fit(), self.gap.critical, self.recommended)
            first, second = choose(self.asking, state, self.rng, asked)
            self._pending = self._question(int(self._shown[first]), int(self._shown[second]))
        return self._pending

    def tell(self, question: Question, answer: int | None) -> None:
        """Record the answer to the pending question: 1, the first is better; 0, the second; None, no answer.

        Leaving out an answer is legitimate only when the decision does not depend on what the answer would be.

        Raises:
            InputError: for another answer, or a question that is not the pending one.
        """
        if question is not self._pending:
            raise InputError("tell() takes the question that ask() gave last, once; ask again.")
        if answer is not None and (isinstance(answer, bool | float) or answer not in (0, 1)):
            raise InputError(f"the answer must be 1 (the first is better), 0 (the second) or None, got {answer!r}.")
        self._pending = None
        self.history.append((question.first, question.second, None if answer is None else int(answer)))
        first, second = sorted((int(self._groups[question.first]), int(self._groups[question.second])))
        self._asked.add((first, second))
        self.check.tell(question.first, question.second, answer)
        if answer is None:
            self.check.prepare(self.reached)
            return
        self.test.tell(question.first, question.second, int(answer))
        self.evidence.tell(*self.answers.add(question.difference, int(answer)))
        self._look()
        self.check.prepare(self.reached)

    @property
    def tight_gap(self) -> float:
        """The certified gap in nats, as small as these answers show it; a certificate's is only as tight as decides.

        With a share as the goal, the gap beyond what the share allows.
        """
        return self.gap.value if self._region is None else self.gap.tight(self._region)

    def gap_under(self, weight_bound: float) -> float | None:
        """The gap in nats that the same answers certify for weights of another norm: what the assumption W decides.

        The likelihood set is the same, since its prior was fixed before the first answer; only the ball differs. None
        where no weights so short were found that explain the answers.

        Args:
            weight_bound: instead of W; W/2 and 2 W, say.

        Raises:
            InputError: for a bound that is not positive, features with errors, or before the first answer.
        """
        if not 0 < weight_bound < np.inf:
            raise InputError(f"the weight bound must be a positive number, got {weight_bound}.")
        if self.gap.errors is not None or self._region is None or not self.answers.total:
            raise InputError("gap_under() needs exact features and at least one answer.")
        near = self._center * min(1.0, 0.9 * weight_bound / max(float(np.linalg.norm(self._center)), 1e-300))
        region = likelihood_set(self.answers, self._level, weight_bound, near)
        return None if region is None else self.gap.tight(region)

    @property
    def certificate(self) -> Certificate:
        """What is certified now."""
        gap, share = self._gap_and_share()
        reached, best = highest(self.answers, self.weight_bound, self._center)
        bounded = True  # errors of features, too, are nats over the ball
        if self._region is not None and self.gap.errors is None:
            bounded = needs_weight_bound(self._region, self._span)
        words, chance = self.offline or ("the best of these candidates is meant, not of all policies", 0.0)
        return Certificate(
            certified=self.certified,
            recommended=self.recommended,
            gap=gap,
            share=share,
            failure_probability=self.delta + chance,
            assumptions=(
                "answers follow P(first is better) = sigma(<x, w>)"
                + (f" with ||w|| <= {self.weight_bound:.4g}" if bounded else ""),
                "all answers come from one teacher, or from several who share w",
                "questions are left unanswered for no reason that depends on the answer",
                words,
            ),
            needs_weight_bound=bounded,
            answers=self.answers.total,
            skipped=len(self.history) - self.answers.total,
            candidates=len(self.features),
            goal=self.goal.describe(),
            room=reached - self._level,
            evidence=self.test.evidence(self.evidence.value, best),
            contradiction=self.contradiction,
            warnings=self._warnings(),
            reached=self.reached,
            checks=(self.check.agreed, self.check.contrary),
        )

    def record(self) -> dict[str, Any]:
        """What :meth:`restore` needs to go on later, as plain values for JSON."""
        state = self.rng.bit_generator.state
        return {"setting": self._setting(), "history": [list(row) for row in self.history], "generator": state}

    def restore(self, record: dict[str, Any]) -> None:
        """Go on where a session with the same arguments stopped: its answers are counted again, one after the other.

        Raises:
            InputError: for a record of another setting, or when this session has already asked.
        """
        if self.history:
            raise InputError("restore() must be called before the first question.")
        if not isinstance(record, dict) or record.get("setting") != self._setting():
            raise InputError("the record must come from a session with the same arguments; this one differs.")
        for first, second, answer in record["history"]:
            self._pending = self._question(int(first), int(second))
            self.tell(self._pending, answer)
        self.rng.bit_generator.state = record["generator"]

    def _items_of(self, candidate: int) -> IntArray:
        """Which of the distinct items the trajectories of a candidate show."""
        return np.unique(self._groups[self._owners == candidate])

    def _question(self, first: int, second: int) -> Question:
        return Question(len(self.history), first, second, self.pool[first] - self.pool[second])

    def _setting(self) -> str:
        """SHA-256 of everything that a session is fixed by before its first question."""
        reference = np.zeros(0) if self.reference is None else self.reference
        words = repr((self.weight_bound, self.delta, self.goal, self.asking, self.fresh, PRIOR_SCALES))
        parts = [array.tobytes() for array in (self.features, self.pool, reference)]
        return hashlib.sha256(b"".join([*parts, words.encode()])).hexdigest()

    def _gap_and_share(self) -> tuple[float, float | None]:
        """Upper bound on the gap in nats, and lower bound on the share gained over the reference.

        The share is gain / (gain + loss), with the certified gap as loss.
        """
        if self.reference is None:
            return self.gap.value, None
        if self.contradicted:
            return self.gap.value, 0.0
        gain = self.features[self.recommended] - self.reference
        least, most = (-self._highest(-gain), self._highest(gain))
        gap = self.gap.value + (self.goal.rho * max(most, 0.0) if self.goal.rho else 0.0)
        share = least / (least + gap) if least > 0 else 0.0
        return gap, max(share, 1 / (1 + self.goal.rho)) if self.goal.rho and self.certified else share

    def _highest(self, direction: FloatArray) -> float:
        """An upper bound on <direction, w> over the likelihood set."""
        widest = self.weight_bound * float(np.linalg.norm(direction)) * (1 + 1e-12)
        if self._region is None:
            return widest
        nobody = np.zeros((1, 0, len(direction)))
        return min(widest, float(search(self._region, direction[None], nobody, self.gap.tolerance).bound[0]))

    def _look(self) -> None:
        """Update evidence, recommendation and gap; every answer is followed by one look."""
        if self.answers.total and self.evidence.stale:
            self.evidence.refit(self.answers)
        if not self.contradicted and self.test.refutes(self.answers, self.evidence.value, self._center):
            self.contradiction = refuted_in_words(self.weight_bound)
        if self.contradicted:
            return  # nothing is certified from here on
        region = likelihood_set(self.answers, self._level, self.weight_bound, self._center)
        self._somebody = region is not None
        if region is None:
            if is_empty(self.answers, self._level, self.weight_bound, self._center):
                self.contradiction = empty_in_words(self.weight_bound, self.delta)
            return  # without a point inside nothing can be certified
        self._center, self._region = region.interior, region
        utilities = self.features @ self.evidence.mean
        best = int(utilities.argmax())
        if utilities[best] > utilities[self.recommended]:
            self.gap.recommend(best, region)
        self.gap.tighten(region)
        if self.answers.total and self.gap.value <= self.goal.nats:
            rivals = self.gap.rivals if self.gap.errors is None else None  # estimated ones prove no contradiction
            found = best_somewhere(self.features, rivals, region)
            self._somebody = bool(found)
            if found is False:
                self.contradiction = nobody_in_words(self.weight_bound, self.delta)

    @property
    def _level(self) -> float:
        return self.evidence.value - log(1 / self.delta)

    def _warnings(self) -> tuple[str, ...]:
        skipped = np.array([answer is None for _, _, answer in self.history])
        if not skipped.any():
            return ()
        utilities = self.pool @ self.evidence.mean
        shown = np.array([row[:2] for row in self.history])
        odds = utilities[shown[:, 0]] - utilities[shown[:, 1]]
        warning = skip_warning(odds[skipped], odds[~skipped])
        return () if warning is None else (warning,)

    def _fit(self) -> tuple[FloatArray, FloatArray]:
        """Mean and covariance of the fitted weights."""
        mean = self.evidence.mean
        x, total = self.answers.differences, self.answers.ones + self.answers.zeros
        p = expit(x @ mean)
        precision = PRIOR_SCALES[1] * len(mean) / self.weight_bound**2
        return mean, np.linalg.inv((x.T * (total * p * (1 - p))) @ x + precision * np.eye(len(mean)))


def _matrix(name: str, given: ArrayLike) -> FloatArray:
    array = np.asarray(given, dtype=np.float64) if np.asarray(given).dtype.kind in "iuf" else np.zeros(0)
    if array.ndim != 2 or 0 in array.shape or not np.isfinite(array).all():
        raise InputError(f"{name} must be finite numbers of shape (N, d), got {np.shape(given)}.")
    return np.ascontiguousarray(array)


def _check(
    features: FloatArray, pool: FloatArray, weights: Ball, delta: float, reference: FloatArray | None, estimated: bool
) -> None:
    if not estimated and len(distinct_rows(features)) < len(features):
        raise InputError("features must hold distinct candidates, got equal rows; merge them first.")
    if pool.shape[1] != features.shape[1]:
        raise InputError(f"pool must have the candidates' {features.shape[1]} features, got {pool.shape[1]}.")
    if len(np.unique(pool, axis=0)) < 2:
        raise InputError("pool must hold at least two items of different features, got one.")
    if not 0 < weights.radius < np.inf:
        raise InputError(f"the radius W of weights must be a positive number, got {weights.radius}.")
    if not 0 < delta < 1:
        raise InputError(f"delta must lie strictly between 0 and 1, got {delta}.")
    if reference is not None and reference.shape != features.shape[1:]:
        raise InputError(f"reference must have the candidates' {features.shape[1]} features, got {len(reference)}.")
