"""A record that was changed is certified only for what it now implies, and never crashes the checker."""

import json
from functools import cache
from typing import Any

import numpy as np
import pytest
from asking_forgeries import implied, tampered

from bridge_algos.asking.config import AskConfig
from bridge_algos.asking.study import prepare, run_session
from proofs_checks.asking_checker.checker import check

TAMPERINGS = 60


@cache
def honest(seed: int) -> dict[str, Any]:
    config = AskConfig("starmdp", max_questions=400, pool=60)
    mdp, utility, demonstrations = prepare(config)
    record: dict[str, Any] = json.loads(json.dumps(run_session(config, mdp, utility, demonstrations, seed)))
    return record


def false_certificates(count: int, seed: int = 0) -> tuple[list[str], dict[str, int]]:
    """Tamperings whose certificate does not follow, and how many of each verdict there were."""
    rng, wrong, verdicts = np.random.default_rng(seed), [], {}
    for number in range(count):
        record = honest(int(rng.choice([0, 4, 5])))
        kind, forged = tampered(record, rng)
        verdict = check(forged)
        json.dumps(verdict.record(), allow_nan=False)
        assert verdict.sentence()
        verdicts[verdict.verdict] = verdicts.get(verdict.verdict, 0) + 1
        if verdict.verdict == "certified" and forged["claims"]["certified"] and not implied(forged):
            wrong.append(f"{number}: {kind}")
    return wrong, verdicts


def test_no_tampering_gives_a_false_certificate() -> None:
    wrong, verdicts = false_certificates(TAMPERINGS)
    assert not wrong, wrong
    assert verdicts["refused"] > TAMPERINGS // 4, verdicts
    assert verdicts["certified"] > 2, verdicts


@pytest.mark.parametrize("seed", [0, 5])
def test_the_judge_agrees_with_honest_sessions(seed: int) -> None:
    assert check(honest(seed)).verdict == "certified"
    assert implied(honest(seed))
