"""An attack on an open offline question: hill climbing over rational instances, certified in exact algebra."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from proofs_checks.search import Attempt, Search

Floats = NDArray[np.float64]
_DENOMINATOR = 10_000_000
_RESTART_AFTER = 4000
_REPORT_EVERY = 200
_SMALLEST_ERROR = 1e-9


def _stochastic_attempts(rng: np.random.Generator) -> Iterator[Attempt]:
    """H(P-hat^pi*, P-hat^BC) less sqrt R1, over sqrt(2 R2), for stochastic policies: conjectured at most 1."""
    yield from _climb(rng, _root_two_score)


Tables = tuple[Floats, Floats, Floats, Floats, Floats]
"""Initial law, P*, P-hat, pi*, pi as rows of probabilities."""


def _climb(rng: np.random.Generator, score: Callable[[Tables, int], float]) -> Iterator[Attempt]:
    while True:
        states, actions, horizon = (int(rng.integers(low, high)) for low, high in ((1, 4), (2, 3), (2, 5)))
        shapes = [
            (1, states),
            (states * actions, states),
            (states * actions, states),
            (states, actions),
            (states, actions),
        ]
        weights = [rng.exponential(size=shape) ** rng.uniform(1, 4) for shape in shapes]
        best, scale = -1.0, 1.0
        for step in range(_RESTART_AFTER):
            trial = [w * np.exp(scale * rng.normal(size=w.shape) * (rng.random(w.shape) < 0.3)) for w in weights]
            tables = _rows(trial, states, actions)
            value = score(tables, horizon)
            if value > best:
                best, weights = value, trial
            else:
                scale = max(0.01, scale * 0.999)
            if step % _REPORT_EVERY == 0:
                yield Attempt(best, _instance(_rows(weights, states, actions), horizon))


def _rows(weights: Sequence[Floats], states: int, actions: int) -> Tables:
    first, true, estimate, expert, other = (w / w.sum(axis=-1, keepdims=True) for w in weights)
    shape = (states, actions, states)
    return first[0], true.reshape(shape), estimate.reshape(shape), expert, other


def _overlap(start: Floats, kernels: tuple[Floats, Floats], policies: tuple[Floats, Floats], horizon: int) -> float:
    roots = np.sqrt(policies[0] * policies[1])[:, :, None] * np.sqrt(kernels[0] * kernels[1])
    x = start
    for _ in range(horizon):
        x = np.einsum("s,sap->p", x, roots)
    return float(x.sum())


def _root_two_score(tables: Tables, horizon: int) -> float:
    start, true, estimate, expert, other = tables
    k = 1 - _overlap(start, (estimate, estimate), (expert, other), horizon)
    r1 = 1 - _overlap(start, (true, true), (expert, other), horizon)
    r2 = 1 - _overlap(start, (true, estimate), (expert, expert), horizon)
    # equal kernels give equality for nothing: only what the transition error must pay for is scored
    return (max(k, 0) ** 0.5 - max(r1, 0) ** 0.5) / (2 * r2) ** 0.5 if r2 > _SMALLEST_ERROR else 0.0


def _instance(tables: Tables, horizon: int) -> dict[str, Any]:
    """The floats as nearby rationals with one denominator, so that the evaluators can replay them."""
    start, true, estimate, expert, other = tables
    return {
        "states": [f"s_{s}" for s in range(len(start))],
        "initial": rational_row(start),
        "kernels": {"P^*": nested(true), "\\hat P": nested(estimate)},
        "policies": {"\\pi^*": [rational_row(row) for row in expert], "\\pi": [rational_row(row) for row in other]},
        "horizon": horizon,
    }


def nested(kernel: Floats) -> list[list[list[str]]]:
    """A kernel as lists of rational rows."""
    return [[rational_row(row) for row in rows] for rows in kernel]


def rational_row(row: Floats) -> list[str]:
    """A row of floats as nearby positive rationals of sum 1."""
    parts = np.maximum(1, np.round(row * _DENOMINATOR)).astype(int)
    total = int(parts.sum())
    return [str(Fraction(int(part), total)) for part in parts]


ROOT_TWO = Search(
    words=r"$H(\hat P^{\pi^*}, \hat P^\pi) \le \sqrt{R_1} + \sqrt{2R_2}$ for stochastic policies",
    kind="offline-root-two",
    left=r"H(\hat P^{\pi^*}, \hat P^\pi)",
    relation="<=",
    right=r"\sqrt{R_1} + \sqrt{2R_2}",
    attempts=_stochastic_attempts,
)
