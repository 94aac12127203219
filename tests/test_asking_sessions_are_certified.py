"""``bridge-rl verify`` certifies what honest sessions claim, and refuses what is malformed."""

import ast
import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridge_algos.asking.config import AskConfig
from bridge_algos.asking.session_file import record_digest, save_session
from bridge_algos.asking.study import prepare, run_session
from bridge_algos.envs.registry import make_mdp
from bridge_algos.policies import random_policies
from bridge_algos.trajectories import sample_each
from experiments.cli import main
from proofs_checks.asking_checker.checker import check
from proofs_checks.asking_checker.file import digest

ROOT = Path(__file__).parent.parent
SESSIONS: dict[str, tuple[str, int, dict[str, Any]]] = {
    "starmdp": ("starmdp", 0, {}),
    "starmdp, an earlier set decides": ("starmdp", 3, {"n_demonstrations": 1}),
    "starmdp, without demonstrations": ("starmdp", 0, {"n_demonstrations": 0, "until": "70%"}),
    "starmdp, one candidate": ("starmdp", 2, {}),
    "starmdp, share with one candidate": ("starmdp", 2, {"until": "share=90%", "max_questions": 2}),
    "starmdp, share": ("starmdp", 5, {"until": "share=80%", "reference": "clone"}),
    "starmdp, share over the worst": ("starmdp", 5, {"until": "share=60%", "reference": "worst"}),
    "starmdp, a sample": ("starmdp", 0, {"limit": 10, "n_demonstrations": 1, "until": "20%"}),
    "starmdp, small range": ("starmdp", 0, {"utility_range": None, "weight_norm": 5.0, "until": "40%"}),
    "starmdp, not certified": ("starmdp", 4, {"max_questions": 20}),
    "gridworld": ("gridworld", 0, {"embedding": "state_counts", "n_demonstrations": 20, "until": "10%"}),
}
ALLOWED = {"bridge_algos.mdp", "bridge_algos.mdp_file", "bridge_algos.envs.registry"}


@cache
def honest(name: str) -> dict[str, Any]:
    environment, seed, changes = SESSIONS[name]
    config = AskConfig(environment, pool=changes.get("pool", 400), **{"max_questions": 600, **changes})
    mdp, utility, demonstrations = prepare(config)
    record: dict[str, Any] = json.loads(json.dumps(run_session(config, mdp, utility, demonstrations, seed)))
    return record


@pytest.mark.parametrize("name", SESSIONS)
def test_every_claim_of_an_honest_session_is_certified(name: str) -> None:
    record = honest(name)
    verdict = check(record)
    assert record["claims"]["certified"] == ("not certified" not in name)
    assert verdict.verdict == ("not certified" if "not certified" in name else "certified"), verdict.sentence()
    assert verdict.stands
    assert verdict.covered
    if record["claims"]["certified"]:
        assert verdict.gap <= max(record["claims"]["gap"] * (1 + 1e-6), 1e-9)
    assert verdict.candidates == record["claims"]["candidates"]


def test_a_claim_that_is_not_reached_is_not_certified() -> None:
    record = json.loads(json.dumps(honest("starmdp")))
    record["claims"]["gap"] = record["outcome"]["certified_gap"] = 0.1
    verdict = check(record)
    assert verdict.verdict == "not certified"
    assert not verdict.stands


def test_contradictory_answers_are_no_certificate() -> None:
    record = json.loads(json.dumps(honest("starmdp")))
    first, second, _ = record["questions"][0]
    record["questions"] = [[first, second, 1], [second, first, 1]] * 500
    record["configuration"]["max_questions"] = 1000
    record["claims"]["answers"] = record["outcome"]["questions"] = 1000
    assert check(record).verdict == "not certified"
    weights = np.array(record["teacher"]["weights"])
    record["weight_bound"] /= 10
    record["prior_precisions"] = [k * 100 for k in record["prior_precisions"]]
    record["teacher"] = None
    rng = np.random.default_rng(0)
    mdp = make_mdp("starmdp")
    shown = sample_each(mdp, random_policies(400, mdp.n_states, mdp.n_actions, rng), 1, rng)
    record["pool"] = {"states": shown.states.tolist(), "actions": shown.actions.tolist()}
    record["questions"] = [[i, j, 1] for i, j in _pairs(record, weights)]
    record["claims"]["answers"] = record["outcome"]["questions"] = len(record["questions"])
    verdict = check(record)
    assert verdict.verdict == "contradicted", verdict.sentence()
    assert not verdict.stands, verdict.sentence()


def _pairs(record: dict[str, Any], weights: np.ndarray) -> list[tuple[int, int]]:
    """Distinct pairs of the pool, the better one first by far."""
    values = [
        sum(weights[4 * s + a] for s, a in zip(*row, strict=True))
        for row in zip(record["pool"]["states"], record["pool"]["actions"], strict=True)
    ]
    order = np.argsort(values)
    return [(int(i), int(j)) for i in order[-20:] for j in order[:50]]


REFUSALS: dict[str, tuple[list[Any], Any, str]] = {
    "equal trajectories": (["questions", 0], [3, 3, 1], "equal features"),
    "an answer of 2": (["questions", 0, 2], 2, "question 0 must be"),
    "true for 1": (["questions", 0, 2], True, "question 0 must be"),
    "an index out of range": (["questions", 0, 0], 40_000, "question 0 must be"),
    "another prior": (["prior_precisions", 1], 3.0, "prior_precisions"),
    "another W": (["weight_bound"], 1.0, "prior_precisions"),
    "another delta": (["delta"], 0.1, "delta is"),
    "another goal": (["goal_nats"], 0.6, "goal_nats"),
    "another range": (["utility_range"], 6.0, "utility_range"),
    "an impossible step": (["pool", "states", 0, 0], 1, "impossible"),
    "another action": (["demonstrations", "actions", 0, 0], 3, "several actions"),
    "another policy": (["recommended", 0], 3, "none of the candidates"),
    "fewer candidates": (["claims", "candidates"], 3, "the demonstrations leave"),
    "fewer answers": (["claims", "answers"], 1, "claims.answers"),
    "a certificate above its goal": (["claims", "gap"], 0.7, "claims.certified"),
    "another environment": (["configuration", "environment"], "gridworld", "expected"),
    "another reference": (["reference", 0], 0.5, "reference"),
    "not all policies": (["complete"], False, "complete"),
    "a teacher of another norm": (["teacher", "weights", 0], 1.0, "weight_bound"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_what_the_record_itself_contradicts_is_refused(name: str) -> None:
    path, value, words = REFUSALS[name]
    record = json.loads(json.dumps(honest("starmdp")))
    place = record
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    verdict = check(record)
    assert verdict.verdict == "refused", verdict.reasons
    assert words in verdict.reasons[0], verdict.reasons
    assert len(verdict.reasons[0].splitlines()) == 1
    assert verdict.reasons[0].endswith(".")


def test_a_person_is_never_asked_a_pair_twice() -> None:
    record = json.loads(json.dumps(honest("starmdp")))
    first, second, answer = record["questions"][0]
    record["teacher"] = None
    record["questions"] += [[second, first, 1 - answer]]
    record["claims"]["answers"] += 1
    record["outcome"]["questions"] += 1
    assert "asked twice" in check(record).reasons[0]


def test_command_line_tells_and_returns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record = honest("starmdp")
    save_session(tmp_path / "session-0000.json", record)
    assert digest(record) == record_digest(record)
    assert main(["verify", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert "1 of 1 certified" in out
    assert "no file can show" in out
    assert "assuming" in out
    assert main(["verify", str(tmp_path / "session-0000.json"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)[0]["verdict"] == "certified"
    lie = {
        **record,
        "claims": {**record["claims"], "gap": 0.01},
        "outcome": {**record["outcome"], "certified_gap": 0.01},
    }
    save_session(tmp_path / "session-0000.json", {**lie, "digest": digest(lie)})
    assert main(["verify", str(tmp_path)]) == 1
    save_session(tmp_path / "session-0000.json", lie)
    assert main(["verify", str(tmp_path)]) == 2
    assert "digest" in capsys.readouterr().err


def test_the_checker_shares_no_code_with_the_sessions() -> None:
    for path in (ROOT / "proofs_checks" / "asking_checker").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom):
                names = [node.module or ""]
            for name in names:
                assert not name.startswith("bridge_algos") or name in ALLOWED, f"{path.name} imports {name}"
