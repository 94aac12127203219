"""How often a printed sentence is false in simulated data, and how often it may be."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np

from bridge_theory import Setting
from bridge_theory.bound import Bound
from bridge_theory.catalog import FORMULAS
from bridge_theory.value import BoundValue
from proofs_checks.coverage import cumulative

DETERMINISTIC, STOCHASTIC = "deterministic", "stochastic"
DELTA = "0.05"
ROUNDING = 1e-9
"""The true quantities are computed in float64."""
FALSE_ALARM = Fraction(1, 10**6)
"""With which probability a test of true sentences may fail, all its verdicts together."""
VERDICTS = 200
"""More than there are bounds times kinds of expert times sizes."""


@dataclass(frozen=True)
class Sentence:
    """What a bound prints for given parameters, and the quantity that it is about in one simulated data set.

    ``event`` sentences bound the probability of an event: there ``truth`` is 1 where it happened and 0 elsewhere.
    """

    bound: str
    truth: float
    given: Mapping[str, Any]
    event: bool = False


Draw = Iterable[tuple[Sentence, ...]]
"""One data set: sentences of one bound that have to hold together."""


@dataclass
class Tally:
    """How a bound fared about one kind of expert."""

    trials: int = 0
    false: int = 0
    positive: int = 0
    claimed: Fraction = field(default_factory=Fraction)

    def add(self, sentences: tuple[Sentence, ...]) -> None:
        """Judge one data set."""
        values = [printed(item.bound, _frozen(item.given)) for item in sentences]
        if sentences[0].event:
            chances = [value.enclosure.upper for value in values]
            wrong = [item.truth > 0 for item in sentences]
        else:
            chances = [value.failure.upper for value in values]
            limits = [value.enclosure.upper for value in values]
            wrong = [item.truth > limit + ROUNDING for item, limit in zip(sentences, limits, strict=True)]
        self.trials += 1
        self.false += any(wrong)
        self.positive += any(item.truth > ROUNDING for item in sentences)
        self.claimed = max(self.claimed, Fraction(max(chances)))

    @property
    def allowed(self) -> int:
        """The most false sentences that true claims leave, but for a chance of FALSE_ALARM in all verdicts together."""
        return allowed(self.trials, min(Fraction(1), self.claimed))


@cache
def allowed(trials: int, claimed: Fraction) -> int:
    """The smallest count that a binomial exceeds with probability below FALSE_ALARM / VERDICTS."""
    for count in range(trials + 1):
        if 1 - cumulative(trials, count, claimed) < FALSE_ALARM / VERDICTS:
            return count
    raise AssertionError("the last count is never exceeded")


@cache
def printed(name: str, given: tuple[tuple[str, Any], ...]) -> BoundValue:
    """The value whose words are printed; what is not given is filled in as for a user."""
    bound = FORMULAS[name]
    assert isinstance(bound, Bound)
    known = {key: value for key, value in given if key in bound.parameters or key in ("S", "A", "B", "T", "delta")}
    value = bound.value(Setting(**known))
    words = value.words
    assert value.enclosure.at_most in words, words
    assert value.failure.upper == 0 or f"probability at least {value.failure.complement_at_least}," in words, words
    return value


def _frozen(given: Mapping[str, Any]) -> tuple[tuple[str, Any], ...]:
    return tuple((key, tuple(v.tolist()) if isinstance(v, np.ndarray) else v) for key, v in given.items())


def is_about_probability(bound: Bound) -> bool:
    """Whether a bound's sentence speaks of a probability or an average, and so may be false in some data sets."""
    return bool(bound.spends or bound.failure or "probability" in bound.words or "on average" in bound.words)


def experts_of(bound: Bound) -> tuple[str, ...]:
    """The kinds of expert that a bound's printed assumptions allow."""
    assumed = " ".join(bound.assumptions)
    return (DETERMINISTIC,) if "expert is deterministic" in assumed else (DETERMINISTIC, STOCHASTIC)


def tallied(draws: Iterable[Draw]) -> dict[str, Tally]:
    """The tallies of all data sets, by bound."""
    found: dict[str, Tally] = defaultdict(Tally)
    for draw in draws:
        for sentences in draw:
            found[sentences[0].bound].add(sentences)
    return dict(found)


# ---------------------------------------------------------------------------------------------------- small worlds


def sparse_rows(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Probability rows with rare and impossible entries."""
    weights = rng.exponential(size=shape) ** 3 * (rng.random(shape) < 0.7)
    weights[..., 0] += 1e-3
    return np.asarray(weights / weights.sum(axis=-1, keepdims=True))


def an_expert(rng: np.random.Generator, kind: str, S: int, A: int) -> np.ndarray:
    """(S, A) action probabilities of a stationary expert."""
    if kind == DETERMINISTIC:
        return np.eye(A)[rng.integers(A, size=S)]
    return np.asarray(rng.dirichlet(np.ones(A), size=S))


def play(
    rng: np.random.Generator, start: np.ndarray, kernel: np.ndarray, policy: np.ndarray, n: int, H: int
) -> tuple[np.ndarray, np.ndarray]:
    """States (n, H + 1), the last one after the last action, and actions (n, H) of independent trajectories."""
    states, actions = np.empty((n, H + 1), dtype=int), np.empty((n, H), dtype=int)
    states[:, 0] = rng.choice(len(start), p=start, size=n)
    for h in range(H):
        actions[:, h] = _draw(rng, policy[states[:, h]])
        states[:, h + 1] = _draw(rng, kernel[states[:, h], actions[:, h]])
    return states, actions


def _draw(rng: np.random.Generator, rows: np.ndarray) -> np.ndarray:
    running = rows.cumsum(axis=1)
    return np.asarray((running > rng.random(len(rows))[:, None] * running[:, -1:]).argmax(axis=1))


def counted(states: np.ndarray, actions: np.ndarray, S: int, A: int, transitions: int) -> np.ndarray:
    """(S, A, S) transition counts over the first steps of all trajectories."""
    counts = np.zeros((S, A, S))
    steps = slice(0, transitions)
    np.add.at(counts, (states[:, :transitions], actions[:, steps], states[:, 1 : transitions + 1]), 1)
    return counts


def estimate(counts: np.ndarray, kernel: np.ndarray, empty: str = "worst") -> np.ndarray:
    """The count estimate; rows without data go where the truth least goes, stay put, or follow the truth."""
    total = counts.sum(axis=-1, keepdims=True)
    eye = np.eye(kernel.shape[-1])
    default = eye[kernel.argmin(axis=-1)] if empty == "worst" else np.broadcast_to(eye[:, None], kernel.shape)
    return np.where(total > 0, counts / np.maximum(total, 1), default)


def squared_hellinger(
    starts: tuple[np.ndarray, np.ndarray],
    policies: tuple[np.ndarray, np.ndarray],
    kernels: tuple[np.ndarray, np.ndarray],
    actions: int,
    transitions: int,
) -> float:
    """H^2 of two laws of (s_1, a_1, s_2, ...) with so many actions and transitions; tables may have a leading step."""
    overlap = np.sqrt(starts[0] * starts[1])
    for h in range(actions):
        agree = np.sqrt(np.multiply(*(p[h] if p.ndim == 3 else p for p in policies)))
        used = overlap[:, None] * agree
        if h >= transitions:
            return float(1 - used.sum())
        moves = np.sqrt(np.multiply(*(k[h] if k.ndim == 4 else k for k in kernels)))
        overlap = np.einsum("sa,sap->p", used, moves)
    return float(1 - overlap.sum())


def meets(start: np.ndarray, chain: np.ndarray, marked: np.ndarray, H: int) -> float:
    """The probability that a chain (S, S) meets a marked state in its first H states."""
    present, met = start, 0.0
    for h in range(H):
        met += float(present[marked].sum())
        present = np.where(marked, 0.0, present)
        if h + 1 < H:
            present = present @ chain
    return met


def row_divergence(p: np.ndarray, q: np.ndarray) -> float:
    """KL(p || q) in nats, where p has no mass outside q."""
    seen = p > 0
    return float((p[seen] * np.log(p[seen] / q[seen])).sum())
