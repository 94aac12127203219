"""A session that asks preference questions never certifies more than its answers show, and says when to stop."""

from __future__ import annotations

import json
from math import log

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import expit

from bridge_algos.asking.answers import Answers
from bridge_algos.asking.dual import LikelihoodSet, dual_bounds, search
from bridge_algos.asking.elicitation import Ball, Elicitation
from bridge_algos.asking.evidence import Evidence, expected_log_sigmoid
from bridge_algos.asking.region import is_empty, likelihood_set
from bridge_algos.asking.rules import RULES
from bridge_algos.asking.tabular import build_problem, simulated_answer
from bridge_algos.asking.utility import simulated_utility
from bridge_algos.envs.registry import make_mdp
from bridge_theory.errors import InputError


def _answers(rng: np.random.Generator, n: int = 40, d: int = 4) -> tuple[Answers, np.ndarray, Evidence]:
    """Answers of a Bradley-Terry teacher to random questions, its weights, and the evidence."""
    truth = rng.normal(size=d)
    answers, evidence = Answers(d), Evidence([1.0, 4.0], d)
    for _ in range(n):
        x = rng.normal(size=d)
        evidence.tell(*answers.add(x, int(rng.random() < expit(x @ truth))))
    evidence.refit(answers, steps=6)
    return answers, truth, evidence


def _session(rng: np.random.Generator, **changes: object) -> tuple[Elicitation, np.ndarray]:
    settings = {"weights": Ball(2.0), "delta": 0.05, "until": "0.5nats", "rng": rng} | changes
    features, pool = rng.normal(size=(8, 3)), rng.normal(size=(60, 3))
    return Elicitation(features, pool=pool, **settings), np.array([1.0, -0.5, 0.2])  # type: ignore[arg-type]


def _answer_until_done(session: Elicitation, truth: np.ndarray, rng: np.random.Generator, most: int = 600) -> None:
    for _ in range(most):
        if session.done:
            return
        question = session.ask()
        session.tell(question, int(rng.random() < expit(question.difference @ truth)))


@pytest.mark.parametrize(
    ("mu", "spread"), [(0.0, 0.0), (2.0, 0.1), (-3.0, 1.0), (1.0, 5.0), (-20.0, 30.0), (0.5, 200.0)]
)
def test_expected_log_likelihoods_lie_below_the_integral(mu: float, spread: float) -> None:
    u = np.linspace(-12, 12, 400_001)
    density = np.exp(-(u**2) / 2) / np.sqrt(2 * np.pi) * (u[1] - u[0])
    exact = float(-np.logaddexp(0, -(mu + spread * u)) @ density)
    found = float(expected_log_sigmoid(np.array([mu]), np.array([spread]))[0])
    assert found <= exact + 1e-12
    assert found >= exact - (1.0 if spread > 60 else 1e-6 * (1 + abs(mu) + spread))


def test_the_evidence_is_never_above_the_exact_one() -> None:
    rng = np.random.default_rng(1)
    answers, evidence = Answers(1), Evidence([0.5], 1)
    grid = np.linspace(-20, 20, 4_001)
    prior = np.log(np.sqrt(0.5 / (2 * np.pi))) - 0.25 * grid**2 + log(grid[1] - grid[0])
    for t in range(30):
        evidence.tell(*answers.add(rng.normal(size=1), int(rng.random() < 0.7)))
        if t % 3 == 0:
            evidence.refit(answers)
        exact = float(np.logaddexp.reduce(answers.log_likelihood(grid[:, None]) + prior))
        assert exact - 0.5 < evidence.value <= exact + 1e-9


@pytest.mark.parametrize("seed", range(6))
def test_dual_bounds_lie_above_what_an_independent_solver_reaches_and_near_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    answers, truth, evidence = _answers(rng)
    region = likelihood_set(answers, evidence.value - log(20), 2 * float(np.linalg.norm(truth)), np.zeros(4))
    assert region is not None
    v, rows = rng.normal(size=(3, 4)), rng.normal(size=(3, 2, 4))
    rows *= np.sign(np.einsum("bkd,d->bk", rows, region.interior))[..., None]
    rows /= np.linalg.norm(rows, axis=2, keepdims=True)
    found = search(region, v, rows, 1e-5)
    for i in range(3):
        inside = [
            {"type": "ineq", "fun": lambda w: answers.log_likelihood(w[None])[0] - region.level},
            {"type": "ineq", "fun": lambda w: region.weight_bound**2 - w @ w},
            {"type": "ineq", "fun": lambda w, i=i: rows[i] @ w},
        ]
        best = minimize(lambda w, i=i: -v[i] @ w, region.interior, constraints=inside, method="SLSQP", tol=1e-10)
        slack = min(answers.log_likelihood(best.x[None])[0] - region.level, (rows[i] @ best.x).min())
        assert found.bound[i] >= -best.fun - 1e-4 * (1 + abs(min(slack, 0)) * 1e4)
        assert found.bound[i] <= -best.fun + 1e-3 * (1 + abs(best.fun))


def test_any_dual_point_bounds_every_weight_vector_of_the_set() -> None:
    rng = np.random.default_rng(3)
    answers, truth, evidence = _answers(rng)
    region = likelihood_set(answers, evidence.value - log(20), 2 * float(np.linalg.norm(truth)), np.zeros(4))
    assert region is not None
    cloud = rng.normal(size=(40_000, 4)) * 0.8 + truth
    inside = cloud[
        (answers.log_likelihood(cloud) >= region.level) & (np.linalg.norm(cloud, axis=1) <= region.weight_bound)
    ]
    assert len(inside) > 1000
    size = 200
    v, w0, c = rng.normal(size=(size, 4)), 2 * rng.normal(size=(size, 4)), rng.exponential(size=size)
    bound, _ = dual_bounds(region, v, np.zeros((size, 0, 4)), w0, c, np.zeros((size, 0)))
    assert ((v @ inside.T).max(axis=1) <= bound).all()


@pytest.mark.parametrize(
    ("asking", "ends"),
    [("pool", True), ("information", True), ("challenger", True), ("paper", False), ("random", False)],
)
def test_no_rule_ends_with_a_false_certificate(asking: str, ends: bool) -> None:
    assert asking in RULES
    rng = np.random.default_rng(5)
    utility = simulated_utility(make_mdp("starmdp"), "state_action_counts", utility_range=20)
    problem = build_problem(make_mdp("starmdp"), utility, 1, rng)
    session = problem.session("30%", 0.05, asking, rng)
    for _ in range(400 if ends else 40):
        if session.done:
            break
        question = session.ask()
        session.tell(question, simulated_answer(utility.weights, question.difference, rng))
    assert session.certified or not ends
    assert problem.true_gap(session.recommended) <= session.certificate.gap


def test_a_certificate_says_what_it_rests_on() -> None:
    rng = np.random.default_rng(0)
    session, truth = _session(rng)
    assert not session.certificate.certified
    assert "Not certified after 0 answers" in session.certificate.sentence
    _answer_until_done(session, truth, rng)
    certificate = session.certificate
    assert certificate.certified
    assert certificate.failure_probability == 0.05
    assert certificate.gap <= 0.5
    assert "sigma(<x, w>)" in certificate.sentence
    assert "left unanswered for no reason that depends on the answer" in certificate.sentence


def test_a_share_of_the_gain_can_be_certified() -> None:
    rng = np.random.default_rng(3)
    mdp = make_mdp("starmdp")
    utility = simulated_utility(mdp, "state_action_counts", utility_range=8)
    problem = build_problem(mdp, utility, 1, rng)
    session = problem.session("share=80%", 0.05, "pool", rng)
    for _ in range(500):
        if session.done:
            break
        question = session.ask()
        session.tell(question, simulated_answer(utility.weights, question.difference, rng))
    assert session.certified
    share = session.certificate.share
    assert share is not None
    assert share >= 0.8
    utilities = problem.candidates.features @ utility.weights
    reference = problem.reference("random") @ utility.weights
    gained = (utilities[session.recommended] - reference) / (utilities.max() - reference)
    assert gained >= 0.8


def test_a_session_goes_on_where_it_stopped() -> None:
    whole, truth = _session(np.random.default_rng(4))
    teacher = np.random.default_rng(7)
    half = None
    for t in range(20):
        if t == 10:
            half = json.loads(json.dumps(whole.record()))
        question = whole.ask()
        whole.tell(question, int(teacher.random() < expit(question.difference @ truth)))
    resumed, _ = _session(np.random.default_rng(4))
    assert half is not None
    resumed.restore(half)
    for row in whole.history[10:]:
        question = resumed.ask()
        assert (question.first, question.second) == row[:2]
        resumed.tell(question, row[2])
    assert resumed.record() == whole.record()
    assert resumed.gap.value == whole.gap.value
    other, _ = _session(np.random.default_rng(4), delta=0.1)
    with pytest.raises(InputError, match="same arguments"):
        other.restore(half)


def test_contradictory_answers_are_called_so_and_never_certify() -> None:
    """Trap 10: an empty set has no largest gap; a maximum over nothing must not pass for a perfect certificate."""
    answers, evidence = Answers(2), Evidence([4.0], 2)
    for _ in range(200):
        evidence.tell(*answers.add(np.array([1.0, 0.0]), 1))
    evidence.refit(answers, steps=8)
    level = evidence.value - log(20)
    assert likelihood_set(answers, level, 0.1, np.zeros(2)) is None
    assert is_empty(answers, level, 0.1, np.zeros(2))
    features = np.array([[0.0, 0.0], [0.0, 3.0], [0.0, 6.0]])
    session = Elicitation(
        features,
        Ball(0.1),
        np.array([[1.0, 0.0], [0.0, 0.0]]),
        0.05,
        "0.001nats",
        np.random.default_rng(0),
        fresh=True,
    )
    for _ in range(300):  # the first item always wins, though W allows it .525 of the time
        if session.done:
            break
        question = session.ask()
        session.tell(question, int(question.first == 0))
    assert session.contradicted
    assert not session.certified
    with pytest.raises(InputError, match="contradict"):
        session.ask()


def test_a_person_is_never_asked_the_same_pair_twice() -> None:
    """Trap 3: a remembered answer is no fresh draw."""
    rng = np.random.default_rng(6)
    session, truth = _session(rng, until="0.01nats")
    _answer_until_done(session, truth, rng, most=80)
    pairs = [tuple(sorted(row[:2])) for row in session.history]
    assert len(set(pairs)) == len(pairs) >= 40


def test_a_question_is_told_once_and_in_its_turn() -> None:
    """Traps 2 and 5: no answer is redrawn after the certificate moved, and answers enter in the order of questions."""
    session, _ = _session(np.random.default_rng(8))
    first = session.ask()
    assert session.ask() is first
    session.tell(first, 1)
    with pytest.raises(InputError, match="gave last"):
        session.tell(first, 0)
    skipped = session.ask()
    session.tell(skipped, None)
    assert session.certificate.answers == 1
    assert session.certificate.skipped == 1


@pytest.mark.parametrize("answer", [2, -1, 0.5, 1.0, True, "1", float("nan")])
def test_only_one_zero_and_none_are_answers(answer: object) -> None:
    session, _ = _session(np.random.default_rng(8))
    with pytest.raises(InputError, match="the answer must be"):
        session.tell(session.ask(), answer)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"delta": 0.0}, "delta must lie strictly between"),
        ({"delta": 1.5}, "delta must lie strictly between"),
        ({"weights": Ball(-1.0)}, "must be a positive number"),
        ({"weights": Ball(float("inf"))}, "must be a positive number"),
        ({"until": "10%"}, "declare the range"),
        ({"until": "soon"}, "until must be"),
        ({"until": "share=90%"}, "needs a reference"),
        ({"until": "0nats"}, "above 0 nats"),
        ({"asking": "best"}, "asking must be one of"),
        ({"reference": np.zeros(2)}, "reference must have"),
    ],
)
def test_a_wrong_setting_is_one_sentence(changes: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        _session(np.random.default_rng(0), **changes)


@pytest.mark.parametrize(
    ("features", "pool", "words"),
    [
        (np.zeros((2, 2)), np.eye(2), "distinct candidates"),
        (np.eye(2), np.eye(3), "must have the candidates' 2 features"),
        (np.eye(2), np.ones((3, 2)), "at least two items"),
        (np.array([[np.nan, 0.0], [1.0, 0.0]]), np.eye(2), "finite numbers"),
        (np.zeros(3), np.eye(2), "finite numbers"),
        ([["a", "b"], ["c", "d"]], np.eye(2), "finite numbers"),
    ],
)
def test_wrong_features_are_one_sentence(features: object, pool: np.ndarray, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Elicitation(features, Ball(1.0), pool, 0.05, "1nats", np.random.default_rng(0))  # type: ignore[arg-type]


def test_every_candidate_has_its_own_bound() -> None:
    """Trap 9: no candidate's bound is below what an independent solver reaches over the sets of all looks so far."""
    rng = np.random.default_rng(11)
    session, truth = _session(rng)
    reached = np.full((len(session.features), len(session.features)), np.inf)
    for _ in range(60):
        region = session._region
        assert region is not None
        for i, candidate in enumerate(session.features):
            v = candidate - session.features[session.recommended]
            inside = [
                {"type": "ineq", "fun": lambda w, r=region: r.answers.log_likelihood(w[None])[0] - r.level},
                {"type": "ineq", "fun": lambda w, r=region: r.weight_bound**2 - w @ w},
                {"type": "ineq", "fun": lambda w, c=candidate: (c - session.features) @ w + 1e-9},
            ]
            best = minimize(lambda w, v=v: -v @ w, region.interior, constraints=inside, method="SLSQP")
            if best.success:
                reached[session.recommended, i] = min(reached[session.recommended, i], -best.fun)
        if session.done:
            break
        question = session.ask()
        session.tell(question, int(rng.random() < expit(question.difference @ truth)))
    assert session.certified
    final = reached[session.recommended]
    known = np.isfinite(final)
    assert known.sum() >= 4
    assert (final[known] <= session.gap.bounds[known] + 1e-4).all()


def test_the_gap_under_another_weight_bound_is_that_of_the_same_answers() -> None:
    """W only enters through the ball: a larger one leaves more weights, the same one leaves the same."""
    rng = np.random.default_rng(8)
    session, truth = _session(rng, until="0.05nats")
    with pytest.raises(InputError, match="at least one answer"):
        session.gap_under(1.0)
    _answer_until_done(session, truth, rng, most=30)
    own = session.weight_bound
    half, same, double = (session.gap_under(factor * own) for factor in (0.5, 1.0, 2.0))
    assert half is not None
    assert same is not None
    assert double is not None
    assert same == pytest.approx(session.tight_gap, abs=0.02)
    assert half - 0.02 <= same <= double + 0.02
    assert double > same + 0.01
    region = LikelihoodSet(session.answers, session._level, 2 * own, np.zeros(len(truth)))
    drawn = rng.normal(size=(20_000, len(truth)))
    drawn *= 2 * own * rng.random((20_000, 1)) ** (1 / len(truth)) / np.linalg.norm(drawn, axis=1, keepdims=True)
    inside = drawn[session.answers.log_likelihood(drawn) >= region.level]
    utilities = inside @ session.features.T
    gaps = utilities.max(axis=1) - utilities[:, session.recommended]
    assert len(gaps) > 100
    assert gaps.max() <= double
    assert session.gap_under(1e-6) is None or session.gap_under(1e-6) < 1e-4
    with pytest.raises(InputError, match="positive"):
        session.gap_under(-1.0)
