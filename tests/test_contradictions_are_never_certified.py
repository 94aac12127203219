"""Neither a session nor ``bridge-rl verify`` certifies answers that contradict the model or the demonstrations."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_asking_sessions_are_certified import honest

from bridge_algos.asking.config import AskConfig
from bridge_algos.asking.elicitation import Elicitation
from bridge_algos.asking.session_file import record_digest, save_session, session_record
from bridge_algos.asking.study import prepare
from bridge_algos.asking.tabular import Problem, build_problem, simulated_answer
from bridge_algos.asking.utility import step_features
from bridge_algos.expert.stationary import best_stationary
from bridge_algos.mdp import FloatArray
from bridge_algos.trajectories import sample_trajectories
from experiments.cli import main
from proofs_checks.asking_checker.checker import check
from proofs_checks.asking_checker.facts import facts
from proofs_checks.asking_checker.model_test import outside


def _outcome(problem: Problem, session: Elicitation, seed: int) -> dict[str, Any]:
    return {
        "seed": seed,
        "questions": len(session.history) if session.certified else None,
        "certified_gap": session.certificate.gap,
        "true_gap": problem.true_gap(session.recommended),
        "covered": False,
        "candidates": len(problem.candidates.policies),
    }


@cache
def _in_a_cycle() -> tuple[str, Elicitation]:
    """A session about three trajectories that are preferred in a cycle with probability .9."""
    config = AskConfig("starmdp", n_demonstrations=1, max_questions=400, pool=60)
    mdp, utility, _ = prepare(config)
    rng = np.random.default_rng(0)
    problem = build_problem(mdp, utility, 1, rng, None, config.limit, config.pool)
    session = problem.session(config.until, config.delta, config.asking, rng, config.reference)
    items = np.unique(session.pool, axis=0, return_index=True)[1][[0, 10, 20]]
    late = 0  # answers after the refutation, for forecasts that say a little less
    while late < 15:
        late += session.contradicted
        i, j = rng.choice(3, 2, replace=False)
        session._pending = session._question(int(items[i]), int(items[j]))
        session.tell(session._pending, int(rng.random() < (0.9 if (j - i) % 3 == 1 else 0.1)))
    return json.dumps(session_record(config.record(), 0, problem, session, _outcome(problem, session, 0))), session


def test_a_refuted_model_is_refuted_by_the_checker_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, session = _in_a_cycle()
    record = json.loads(text)
    assert session.contradicted
    assert len(record["questions"]) <= 100
    assert record["claims"]["contradicted"]
    verdict = check(record)
    assert verdict.verdict == "contradicted", verdict.sentence()
    assert "explain these answers at least 100 times better" in verdict.sentence()
    assert verdict.stands
    given = facts(record)
    own = outside(given.log, given.pool, given.setting.weight_bound)
    assert own == pytest.approx(session.test.outside, abs=1.0)  # the tables win, here and there
    save_session(tmp_path / "session-0000.json", record)
    assert main(["verify", str(tmp_path)]) == 0
    assert "contradicted" in capsys.readouterr().out


def test_hiding_a_refutation_does_not_certify() -> None:
    record = json.loads(_in_a_cycle()[0])
    record["configuration"]["until"] = record["until"] = "100nats"
    record["goal_nats"] = 100.0
    record["claims"] |= {"certified": True, "contradicted": False, "gap": 1.0}
    record["outcome"] |= {"questions": len(record["questions"]), "certified_gap": 1.0}
    verdict = check(record)
    assert verdict.verdict == "contradicted"
    assert not verdict.stands


def test_the_checker_finds_little_against_honest_sessions() -> None:
    for name in ("starmdp", "starmdp, an earlier set decides"):
        given = facts(honest(name))
        assert outside(given.log, given.pool, given.setting.weight_bound) < np.log(0.5) * len(given.log.said) + 30
        assert check(honest(name)).verdict == "certified"


def test_a_contradiction_that_is_claimed_is_never_certified() -> None:
    record = json.loads(json.dumps(honest("starmdp")))
    record["claims"] |= {"certified": False, "contradicted": True}
    record["outcome"]["questions"] = None
    verdict = check(record)
    assert verdict.verdict == "contradicted"
    assert "not confirmed here" in verdict.sentence()
    assert verdict.stands


def test_a_certificate_that_a_session_withholds_is_not_issued_for_it() -> None:
    record = json.loads(json.dumps(honest("starmdp")))
    record["claims"]["certified"] = False
    record["outcome"]["questions"] = None
    verdict = check(record)
    assert verdict.verdict == "not certified"
    assert "claims no certificate" in verdict.sentence()
    assert verdict.stands


def _about_nobody() -> dict[str, Any]:
    """Demonstrations by the worst policy, and hundreds of answers by which other policies are better."""
    config = AskConfig("starmdp", utility_range=20.0, n_demonstrations=4, until="100nats", max_questions=1000, pool=60)
    mdp, utility, _ = prepare(config)
    rng = np.random.default_rng(1)
    worst = best_stationary(_with_weights(mdp, utility, -utility.weights)).policy
    demonstrations = sample_trajectories(mdp, worst, 4, rng)
    problem = build_problem(mdp, utility, 4, rng, demonstrations, config.limit, config.pool)
    problem = replace(problem, pool=build_problem(mdp, utility, 0, rng, None, 2000, config.pool).pool)
    session = problem.session(config.until, config.delta, config.asking, rng, config.reference)
    while len(session.history) < 200:
        first, second = (int(item) for item in rng.choice(config.pool, 2, replace=False))
        if not (session.pool[first] - session.pool[second]).any():
            continue
        session._pending = session._question(first, second)
        session.tell(session._pending, simulated_answer(utility.weights, session._pending.difference, rng))
    record = session_record(config.record(), 1, problem, session, _outcome(problem, session, 1))
    return json.loads(json.dumps(record))  # type: ignore[no-any-return]


def _with_weights(mdp: Any, utility: Any, weights: FloatArray) -> Any:
    return replace(mdp, reward=step_features(utility.embedding.name, mdp) @ weights, reward_on="")


def test_a_certificate_about_nobody_is_a_contradiction_for_the_checker_too() -> None:
    """Every candidate contradicts the answers: each bound is a maximum over nothing, and any goal would be reached."""
    record = _about_nobody()
    assert record["claims"]["contradicted"], record["claims"]["sentence"]
    assert "is any of the candidates the best policy" in record["claims"]["sentence"]
    assert check(record).verdict == "contradicted"
    record["claims"] |= {"certified": True, "contradicted": False}
    record["outcome"]["questions"] = len(record["questions"])
    record |= {"digest": record_digest(record)}
    verdict = check(record)
    assert verdict.verdict == "contradicted", verdict.sentence()
    assert "No candidate is best" in verdict.sentence()
    assert not verdict.stands
