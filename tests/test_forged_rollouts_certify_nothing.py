"""What a session with a simulator claims of its rollouts is never believed: the check computes features itself."""

import copy
import dataclasses
import json
from functools import cache
from typing import Any

import numpy as np
import pytest
from asking_forgeries import implied, tampered

from bridge_algos.asking import rollouts
from bridge_algos.asking.config import AskConfig
from bridge_algos.asking.feature_errors import ball_errors
from bridge_algos.asking.rollout_estimates import Estimate, coupled_estimate
from bridge_algos.asking.rollout_tree import Tree
from bridge_algos.asking.study import prepare, run_session
from proofs_checks.asking_checker.checker import check

CONFIG = AskConfig("starmdp", dynamics="unknown", max_questions=400, pool=60)
TAMPERINGS = 40


@cache
def honest(seed: int) -> dict[str, Any]:
    record: dict[str, Any] = json.loads(json.dumps(run_session(CONFIG, *prepare(CONFIG), seed)))
    return record


def plain(record: dict[str, Any]) -> dict[str, Any]:
    """The same record as if dynamics had been known, for a judge who knows no other."""
    known = copy.deepcopy(record)
    if known["configuration"].pop("dynamics", None) and np.isclose(
        known["delta"], 0.8 * known["configuration"]["delta"]
    ):
        known["configuration"]["delta"] = known["delta"]
    known["reference"] = known["reference"] or [0.0] * len(known["teacher"]["weights"])
    return known


@pytest.mark.parametrize("seed", [0, 5])
def test_an_honest_session_is_certified_with_the_dynamics(seed: int) -> None:
    verdict = check(honest(seed))
    assert verdict.verdict == "certified", verdict.reasons
    assert verdict.gap <= honest(seed)["claims"]["gap"] + 1e-9
    assert verdict.failure == pytest.approx(0.04)
    assert any("uses no rollout of it" in sentence for sentence in verdict.assumptions)
    assert implied(plain(honest(seed)))


def _forged(tree: Tree, pilot: Tree, n_actions: int, reach: float, delta: float, merges: bool) -> Estimate:
    """Means that say the opposite, without errors."""
    estimate = coupled_estimate(tree, pilot, n_actions, reach, delta, merges)
    turned = estimate.features.mean(axis=0) - (estimate.features - estimate.features.mean(axis=0))
    return dataclasses.replace(estimate, features=turned, errors=ball_errors(np.zeros(len(turned))))


def test_forged_means_are_not_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rollouts, "coupled_estimate", _forged)
    config = dataclasses.replace(CONFIG, until="5%")
    record = run_session(config, *prepare(config), 0)
    assert record["claims"]["certified"]
    assert record["outcome"]["true_gap"] > record["goal_nats"]
    verdict = check(json.loads(json.dumps(record)))
    assert verdict.verdict == "not certified"
    assert not verdict.stands
    assert verdict.gap >= record["outcome"]["true_gap"]


def test_no_tampering_with_a_session_of_a_simulator_gives_a_false_certificate() -> None:
    rng, wrong, verdicts = np.random.default_rng(1), [], {"refused": 0, "certified": 0}
    for number in range(TAMPERINGS):
        kind, forged = tampered(honest(int(rng.choice([0, 5]))), rng)
        verdict = check(forged)
        verdicts[verdict.verdict] = verdicts.get(verdict.verdict, 0) + 1
        if verdict.verdict == "certified" and forged["claims"]["certified"] and not implied(plain(forged)):
            wrong.append(f"{number}: {kind}")
    assert not wrong, wrong
    assert verdicts["refused"] > TAMPERINGS // 4, verdicts


@pytest.mark.parametrize(
    ("name", "value"),
    [("dynamics", "known"), ("dynamics", None), ("delta", 0.04), ("delta", 0.5), ("until", "share=90%")],
)
def test_a_setting_that_contradicts_itself_is_refused(name: str, value: object) -> None:
    forged = copy.deepcopy(honest(0))
    forged["configuration"][name] = value
    assert check(forged).verdict == "refused"


def test_a_session_that_knew_the_dynamics_may_not_claim_the_leaves_of_one_that_did_not() -> None:
    """What is allowed without dynamics is the count of candidates, which decides nothing."""
    forged = copy.deepcopy(honest(0))
    forged["claims"]["candidates"] = forged["outcome"]["candidates"] = 10**6
    assert check(forged).verdict == "refused"
    del forged["configuration"]["dynamics"]
    assert check(forged).verdict == "refused"
