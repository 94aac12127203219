"""Attacks on the transfer from the expert to a policy with full support, for experts with and without memory.

Policies are tables with a row for every history, so that an expert may remember anything; one without memory has equal
rows for all histories that end in the same state at the same step.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from proofs_checks.offline.search import nested, rational_row
from proofs_checks.search import Attempt, Search

Floats = NDArray[np.float64]
Weights = list[Floats]
"""Positive weights: of the first state, of both kernels, then of the expert and the policy, a table a step each."""

_RESTART_AFTER = 3000
_REPORT_EVERY = 150
_SMALLEST_ERROR = 1e-9


def attempts(rng: np.random.Generator, *, memory: bool) -> Iterator[Attempt]:
    """H^2(P-hat^pi, P*^pi) over H C H^2(P-hat^pi*, P*^pi*) with full support: the lemma claims at most 1."""
    while True:
        states, actions, horizon = int(rng.integers(2, 4)), 2, int(rng.integers(2, 4))
        rows = [states * (actions * states) ** step if memory else states for step in range(horizon)]
        shapes = [(states,), *[(states, actions, states)] * 2, *[(size, actions) for size in (*rows, *rows)]]
        weights = [rng.exponential(size=shape) ** rng.uniform(1, 4) for shape in shapes]
        best, scale = -1.0, 1.0
        for step in range(_RESTART_AFTER):
            trial = [w * np.exp(scale * rng.normal(size=w.shape) * (rng.random(w.shape) < 0.3)) for w in weights]
            if (value := _score(trial)) > best:
                best, weights = value, trial
            else:
                scale = max(0.01, scale * 0.999)
            if step % _REPORT_EVERY == 0:
                yield Attempt(best, _instance(weights) if best > 1 else {})


def _tables(weights: Weights) -> tuple[Floats, Floats, Floats, Weights, Weights]:
    """Probabilities: first state, P*, P-hat, and the expert's and the policy's rows for every history of each step."""
    start, true, estimate, *rows = (w / w.sum(axis=-1, keepdims=True) for w in weights)
    states, horizon = len(start), len(rows) // 2
    actions = true.shape[1]
    sizes = [states * (actions * states) ** step for step in range(horizon)]
    # histories are counted so that the last state runs fastest
    rows = [np.resize(table, (size, actions)) for table, size in zip(rows, (*sizes, *sizes), strict=True)]
    return start, true, estimate, rows[:horizon], rows[horizon:]


def _followed(start: Floats, true: Floats, estimate: Floats, rows: Weights) -> tuple[list[Floats], float]:
    """The occupancies of each step under P*, and H^2 between the two laws of the histories."""
    states = len(start)
    mass, overlap, occupancies = start, start, []
    for table in rows:
        played = (mass[:, None] * table).reshape(-1, states, table.shape[1])
        occupancies.append(played.sum(axis=0))
        last = np.arange(len(mass)) % states
        mass = (mass[:, None, None] * table[:, :, None] * true[last]).ravel()
        overlap = (overlap[:, None, None] * table[:, :, None] * np.sqrt(true * estimate)[last]).ravel()
    return occupancies, 1 - float(overlap.sum())


def _score(weights: Weights) -> float:
    start, true, estimate, expert, other = _tables(weights)
    visits, error = _followed(start, true, estimate, expert)
    other_visits, other_error = _followed(start, true, estimate, other)
    ratio = max(float((o / e).max()) for o, e in zip(other_visits, visits, strict=True))
    return other_error / (len(expert) * ratio * error) if error > _SMALLEST_ERROR else 0.0


def _instance(weights: Weights) -> dict[str, Any]:
    """The floats as nearby rationals, policies by their histories, so that the evaluators can replay them."""
    start, true, estimate, expert, other = _tables(weights)
    states = [f"s_{s}" for s in range(len(start))]
    actions = [f"a_{a}" for a in range(true.shape[1])]

    def by_history(rows: Weights) -> dict[str, list[str]]:
        named = (product(*[states, *[actions, states] * step]) for step in range(len(rows)))
        return {
            " ".join(names): rational_row(row)
            for histories, table in zip(named, rows, strict=True)
            for names, row in zip(histories, table, strict=True)
        }

    return {
        "states": states,
        "actions": actions,
        "initial": rational_row(start),
        "kernels": {"P^*": nested(true), "\\hat P": nested(estimate)},
        "policies": {"\\pi^*": by_history(expert), "\\pi": by_history(other)},
        "horizon": len(expert),
    }


def _search(memory: bool) -> Search:
    return Search(
        words=r"with full support $H^2(\hat P^\pi, P_*^\pi) \le H\,C(\pi, \pi^*)\,H^2(\hat P^{\pi^*}, P_*^{\pi^*})$"
        + (", for experts that remember" if memory else ", for Markov experts, whose rows may change with the step"),
        kind="offline-full-support",
        left=r"H^2(\hat P^\pi, P_*^\pi)",
        relation="<=",
        right=r"H\,C(\pi, \pi^*)\,H^2(\hat P^{\pi^*}, P_*^{\pi^*})",
        attempts=partial(attempts, memory=memory),
    )


WITH_MEMORY, MARKOV = _search(memory=True), _search(memory=False)
