"""The search for a violation of the transfer covers experts that remember, and scores what the evaluator finds."""

from __future__ import annotations

from fractions import Fraction
from itertools import islice

import numpy as np
import pytest

from proofs_checks.counterexample import evaluator
from proofs_checks.ledger import matching
from proofs_checks.offline import search_transfer
from proofs_checks.offline.search_transfer import MARKOV, WITH_MEMORY

PARTS = {claim.part: claim for claim in matching("lemma:technical_result")}


def test_each_open_or_refuted_part_is_attacked_with_its_own_experts() -> None:
    assert PARTS["history-dependent"].search is WITH_MEMORY
    assert PARTS["history-dependent"].verdict == "false"
    assert PARTS["markov"].search is MARKOV
    assert PARTS["markov"].verdict == "open"
    assert PARTS["deterministic"].verdict == "true"


def middle(value: Fraction | tuple[Fraction, Fraction]) -> float:
    return float(sum(value) / 2) if isinstance(value, tuple) else float(value)


def weights(memory: bool, seed: int) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    states, actions, horizon = 2, 2, 3
    rows = [states * (actions * states) ** step if memory else states for step in range(horizon)]
    shapes = [(states,), *[(states, actions, states)] * 2, *[(size, actions) for size in (*rows, *rows)]]
    return [rng.exponential(size=shape) + 0.1 for shape in shapes]


@pytest.mark.parametrize("memory", [True, False])
@pytest.mark.parametrize("seed", range(3))
def test_the_score_is_the_ratio_of_the_two_sides(memory: bool, seed: int) -> None:
    given = weights(memory, seed)
    left, right = evaluator("offline-full-support")(search_transfer._instance(given))
    assert search_transfer._score(given) == pytest.approx(middle(left) / middle(right), rel=1e-4)


def test_only_an_expert_with_memory_distinguishes_histories() -> None:
    for memory in (True, False):
        expert = search_transfer._instance(weights(memory, 0))["policies"]["\\pi^*"]
        rows = {tuple(row) for history, row in expert.items() if history.count(" ") == 4 and history.endswith("s_1")}
        assert len(rows) == (16 if memory else 1)


def test_an_attack_never_falls_silent() -> None:
    for search in (WITH_MEMORY, MARKOV):
        scores = [attempt.score for attempt in islice(search.attempts(np.random.default_rng(1)), 4)]
        assert len(scores) == 4
        assert scores == sorted(scores)
