"""A plan counts simulated sessions, says what it cannot see, and goes on where it stopped."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import binom

import bridge_theory as theory
from bridge_algos.asking.answers import Answers
from bridge_algos.asking.elicitation import Ball, Elicitation
from bridge_algos.asking.feature_errors import ball_errors
from bridge_algos.asking.gap import Gap
from bridge_algos.asking.tabular import build_problem, simulated_answer
from bridge_algos.asking.utility import simulated_utility
from bridge_algos.envs.registry import make_mdp
from bridge_theory.errors import InputError
from experiments.asked import asked
from experiments.cli import main as bridge_rl
from experiments.intervals import median_interval
from experiments.plan import main
from experiments.studies.old_width import LAM, answers_needed, paper_design

SMALL = ["starmdp", "--demonstrations", "4,2", "--seeds", "3", "--max-questions", "12", "--jobs", "1"]


def test_the_answer_comes_first_and_the_figure_is_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert bridge_rl(["plan", *SMALL, "--until", "10%", "--range", "5", "--out", str(tmp_path)]) == 0
    captured = capsys.readouterr()
    text, told = captured.out, captured.err.splitlines()
    first = text.split("\n")[0]
    assert ["with 4 demonstrations" in told[0], "with 2 demonstrations" in told[1]] == [True, True], "cheapest first"
    assert first.startswith("Until the recommended candidate is within 0.5 nats of the best")
    assert "with 2 demonstrations and " in first
    assert "order statistics of 3 simulated sessions for each number" in first
    assert "more than 12" in text
    assert (tmp_path / "plan.png").stat().st_size > 10_000


def test_a_plan_resumes_and_its_numbers_are_those_of_the_sessions(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = [*SMALL, "--out", str(tmp_path), "--json"]
    main(given)
    plan = json.loads(capsys.readouterr().out)
    stored = sorted(path for path in (tmp_path / "demonstrations-2").rglob("*") if path.is_file())
    times = [path.stat().st_mtime_ns for path in stored]
    main(given)
    assert json.loads(capsys.readouterr().out) == plan
    assert [path.stat().st_mtime_ns for path in stored] == times, "nothing is computed twice"
    for row in plan["plan"]:
        one = asked([np.inf if count is None else count for count in row["questions"]])
        assert row["median_questions"] == (one.median if np.isfinite(one.median) else None)
        assert row["interval_95"] == [0.0, None], "three sessions say nothing about a median"
    assert [row["demonstrations"] for row in plan["plan"]] == [2, 4]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ([], "plan needs an environment"),
        (["starmdp", "--demonstrations", "1,two"], "whole numbers with commas between"),
        (["starmdp", "--seeds", "0"], "--seeds must be at least 1"),
        (["starmdp", "--until", "ten"], "until must be"),
        (["starmdp", "--range", "-1"], "positive number"),
        (["starmdp", "--max-questions", "0"], "--max-questions must be at least 1"),
        (["starmdp", "--jobs", "0"], "jobs is 0"),
        (["marsmdp"], "marsmdp"),
        (["starmdp", "--target-radius", "0.9"], "unrecognized arguments"),
        (["--target-radius", "-1"], "--target-radius -1 is negative"),
        (["--until", "10%"], "unrecognized arguments"),
    ],
)
def test_mistakes_get_one_sentence_and_status_2(
    given: list[str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = ["--out", str(tmp_path)] if given[:1] in (["starmdp"], ["marsmdp"]) else []
    assert bridge_rl(["plan", *given, *out]) == 2
    error = capsys.readouterr().err.strip()
    assert words in error
    assert "\n" not in error


def test_the_theory_is_still_asked_without_an_environment(capsys: pytest.CaptureFixture[str]) -> None:
    setting = ["--S", "5", "--A", "4", "--H", "8", "--delta", "0.05", "--gamma-min", "0.1"]
    assert bridge_rl(["plan", "--target-radius", "0.9", *setting]) == 0
    assert "offline_radius_repaired" in capsys.readouterr().out


@pytest.mark.parametrize("n", [3, 5, 6, 20, 101])
def test_the_interval_encloses_the_median_as_often_as_it_says(n: int) -> None:
    """Exactly: the ranks miss the median of a continuous law with the binomial law's probability."""
    low, high = median_interval(np.arange(1.0, n + 1))
    if high == np.inf:
        assert low == 0
        assert 2 * binom.cdf(0, n, 0.5) > 0.05
        return
    assert low == n + 1 - high
    assert 2 * binom.cdf(low - 1, n, 0.5) <= 0.05 < 2 * binom.cdf(low, n, 0.5)


def test_a_session_without_a_certificate_is_never_a_small_number() -> None:
    values = [10.0] * 9 + [np.inf] * 11
    assert (asked(values).median, asked(values).certified) == (np.inf, 9)
    assert asked([np.nan if value == np.inf else value for value in values]) == asked(values)
    assert asked(values).high == np.inf


def _session(seed: int) -> tuple[Elicitation, np.ndarray, np.random.Generator]:
    rng = np.random.default_rng(seed)
    mdp = make_mdp("starmdp")
    utility = simulated_utility(mdp, "state_action_counts", utility_range=5)
    problem = build_problem(mdp, utility, 1, rng, pool=60)
    return problem.session("10%", 0.05, "pool", rng), utility.weights, rng


def test_a_tight_gap_is_a_bound_near_what_another_solver_reaches_and_disturbs_nothing() -> None:
    session, weights, rng = _session(1)
    other, _, other_rng = _session(1)
    assert session.tight_gap <= session.gap.value
    for _ in range(25):
        for one, source, look in ((session, rng, True), (other, other_rng, False)):
            question = one.ask()
            one.tell(question, simulated_answer(weights, question.difference, source))
            if look:
                assert one.tight_gap <= one.gap.value
    assert session.history == other.history
    region, gap = session._region, session.gap
    assert region is not None
    reached = 0.0
    for contender in range(len(session.features)):
        v = session.features[contender] - session.features[session.recommended]
        rows = session.features[contender] - np.delete(session.features, contender, axis=0)
        assert gap.rivals is not None
        rows = np.concatenate([rows, session.features[contender] - gap.rivals(np.array([contender]))[0]])
        inside = [
            {"type": "ineq", "fun": lambda w: region.answers.log_likelihood(w[None])[0] - region.level},
            {"type": "ineq", "fun": lambda w: region.weight_bound**2 - w @ w},
            {"type": "ineq", "fun": lambda w, rows=rows: rows @ w},
        ]
        best = minimize(lambda w, v=v: -v @ w, region.interior, constraints=inside, method="SLSQP")
        if best.success and min(np.min(part["fun"](best.x)) for part in inside) > -1e-5:
            reached = max(reached, -best.fun)
    assert reached - 1e-3 <= session.tight_gap <= reached + 0.2 * (1 + reached)


def test_a_tight_gap_pays_for_errors_of_features() -> None:
    """Wherever the true features lie within the errors, their own gap is at most the one bounded from estimates."""
    rng = np.random.default_rng(3)
    features, weights, radius, nats = rng.normal(size=(5, 3)), np.array([1.0, -0.5, 0.2]), 2.0, 0.1
    session = Elicitation(features, Ball(radius), rng.normal(size=(50, 3)), 0.05, "0.01nats", rng, fresh=True)
    for _ in range(150):
        question = session.ask()
        session.tell(question, simulated_answer(weights, question.difference, rng))
    region = session._region
    assert region is not None

    def tight(candidates: np.ndarray, error: float) -> float:
        errors = ball_errors(np.full(len(candidates), error)) if error else None
        gap = Gap(candidates, radius, 0.01, 0.01, errors=errors)
        gap.recommend(session.recommended, region)
        return gap.tight(region)

    bounded, tolerance = tight(features, nats / (2 * radius)), 0.02 * 0.01
    assert session.tight_gap <= bounded - nats + tolerance
    moves = rng.normal(size=(20, *features.shape))
    moves *= nats / (2 * radius) / np.linalg.norm(moves, axis=2, keepdims=True)
    assert max(tight(features + move, 0.0) for move in moves) <= bounded + tolerance


def test_derivatives_without_answers_are_zero() -> None:
    value, gradient, hessian = Answers(3).derivatives(np.ones((2, 3)))
    assert not value.any()
    assert gradient.shape == (2, 3)
    assert hessian.shape == (2, 3, 3)


def test_the_earlier_certificate_needs_what_its_formula_says() -> None:
    """At BW = 0.5 the count is checked against R1's formula, with the data matrix written out."""
    rng = np.random.default_rng(0)
    mdp = make_mdp("starmdp")
    utility = simulated_utility(mdp, "state_action_counts", weight_norm=0.5 / 8)
    problem = build_problem(mdp, utility, 2, rng, pool=40)
    found = answers_needed(problem, 0.03, 0.05)
    kappa = 2 + 2 * np.cosh(2 * utility.embedding.bound * utility.weight_bound)
    design = paper_design(utility.embedding.of_trajectories(problem.pool))
    features = problem.candidates.features
    best = features[(features @ utility.weights).argmax()]

    def gap(answers: float) -> float:
        matrix = kappa * LAM * np.eye(len(best)) + answers * design
        ratio = np.linalg.slogdet(matrix / (kappa * LAM))[1]
        radius = theory.confidence_radius_repaired.estimate(
            B=utility.embedding.bound, W=utility.weight_bound, lam=LAM, delta_w=0.05, log_det_ratio=ratio, residual=0
        )
        widths = np.sqrt([v @ np.linalg.solve(matrix, v) for v in features - best])
        return float(np.max((features - best) @ utility.weights + float(radius) * widths))

    assert 1e3 < found < 1e9
    assert gap(1.01 * found) <= 0.03 < gap(0.99 * found)


def test_the_papers_rule_asks_about_every_direction() -> None:
    design = paper_design(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 2.0]]))
    assert np.linalg.eigvalsh(design)[0] > 0.1


def test_no_environment_is_one_sentence() -> None:
    with pytest.raises(InputError, match="'bridge-rl plan starmdp --until 10% --range 5'"):
        main([])
