"""Answers that contradict the model are said to, and nothing is certified from them; honest ones are left alone."""

from __future__ import annotations

import dataclasses
from itertools import product
from math import exp, log

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import expit
from scipy.stats import binom

from bridge_algos.asking.answers import Answers
from bridge_algos.asking.consistency import LAG, LEAD, LEAD_AGAIN, Consistency
from bridge_algos.asking.dual import Certificates, LikelihoodSet, dual_bounds
from bridge_algos.asking.elicitation import Ball, Elicitation
from bridge_algos.asking.evidence import Evidence
from bridge_algos.asking.forecasters import Interactions, Logistic, Tables
from bridge_algos.asking.model_test import DELTA_MODEL, ModelTest
from bridge_algos.asking.orient import orient
from bridge_algos.asking.region import highest, is_empty, likelihood_set
from bridge_algos.asking.skips import skip_warning
from bridge_algos.asking.vacuous import best_somewhere
from bridge_algos.asking.wrong_teachers import TEACHERS, wrong_teacher
from bridge_algos.envs.registry import make_mdp
from bridge_theory.errors import InputError
from experiments.wrong_teachers import SHAPES, three_items

THRESHOLD = log(1 / DELTA_MODEL)


def _cyclic(rng: np.random.Generator, first: int, second: int) -> int:
    """Item 0 is preferred to 1, 1 to 2 and 2 to 0, each with probability .9."""
    return int(rng.random() < (0.9 if (second - first) % 3 == 1 else 0.1))


def _cycle_session(
    seed: int, asking: str = "random", until: str = "0.2nats"
) -> tuple[Elicitation, np.random.Generator]:
    rng = np.random.default_rng(seed)
    items = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 1.0]])
    return Elicitation(items, Ball(3.0), items, 0.05, until, rng, fresh=True, asking=asking), rng


def test_preferences_in_a_cycle_are_refuted_within_50_answers() -> None:
    """In 95 % of 40 seeds, and half of them within 35, where pairs are asked at random."""
    items = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 1.0]])
    needed = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        test, answers = ModelTest(items, np.arange(3), 3.0), Answers(2)
        while answers.total < 100:
            first, second = rng.choice(3, 2, replace=False)
            answer = _cyclic(rng, first, second)
            test.tell(first, second, answer)
            answers.add(items[first] - items[second], answer)
            if test.refutes(answers, -np.inf, np.zeros(2)):  # the half of the stake inside the model is lost
                break
        needed.append(answers.total)
    assert np.mean(np.array(needed) <= 50) >= 0.95
    assert np.median(needed) <= 35


def test_a_session_with_preferences_in_a_cycle_ends_in_a_contradiction() -> None:
    session, rng = _cycle_session(0)
    while not session.done:
        question = session.ask()
        session.tell(question, _cyclic(rng, question.first, question.second))
    assert session.contradicted
    assert len(session.history) <= 50


def test_nothing_is_certified_after_a_contradiction() -> None:
    session, rng = _cycle_session(0)
    while not session.contradicted:
        question = session.ask()
        session.tell(question, _cyclic(rng, question.first, question.second))
    certificate = session.certificate
    assert session.done
    assert not certificate.certified
    assert certificate.evidence >= THRESHOLD
    assert "these answers contradict the model" in certificate.sentence
    assert "Certified" not in certificate.sentence
    with pytest.raises(InputError, match="these answers contradict the model"):
        session.ask()
    for _ in range(60):  # answers that fit again do not take it back
        session._pending = session._question(0, 1)
        session.tell(session._pending, 1)
    assert session.contradicted
    assert not session.certified


def test_a_contradiction_survives_saving() -> None:
    session, rng = _cycle_session(1)
    while not session.contradicted:
        question = session.ask()
        session.tell(question, _cyclic(rng, question.first, question.second))
    resumed, _ = _cycle_session(1)
    resumed.restore(session.record())
    assert resumed.contradicted
    assert resumed.certificate.sentence == session.certificate.sentence


@pytest.mark.parametrize("shape", ["corners", "triangle", "nearly on a line"])
def test_a_cycle_is_refuted_before_it_is_certified(shape: str) -> None:
    """Two of three pairs decide; check questions ask about the third one."""
    ends = [three_items(SHAPES[shape], seed) for seed in range(8)]
    assert sum(word == "certified" for word, _ in ends) <= 1  # in the campaign 2 of 100
    assert sum(word == "refuted" and asked <= 50 for word, asked in ends) >= 6


def test_check_questions_cost_an_honest_session_few_answers() -> None:
    """Answers that follow a sure prediction pass after LEAD of them; a session without answers needs none."""
    for seed in range(6):
        rng = np.random.default_rng(seed)
        features, truth = rng.normal(size=(6, 3)), np.array([1.5, -1.0, 0.5])
        session = Elicitation(features, Ball(4.0), 2 * rng.normal(size=(80, 3)), 0.05, "1nats", rng)
        extra = 0
        while not session.done:
            extra += session.reached
            question = session.ask()
            session.tell(question, int(rng.random() < expit(question.difference @ truth)))
        assert session.certified
        assert LEAD <= extra <= 2 * LEAD
        assert sum(session.certificate.checks) == extra
        assert f"Of {extra} answers to check questions" in session.certificate.sentence
    alone = Elicitation([[1.0]], Ball(1.0), [[0.0], [1.0]], 0.05, "1nats", rng)
    assert alone.certified
    assert alone.certificate.answers == 0


def test_a_session_that_waits_for_check_questions_says_so_and_goes_on_where_it_stopped() -> None:
    def start() -> Elicitation:
        rng = np.random.default_rng(2)
        return Elicitation(rng.normal(size=(6, 3)), Ball(4.0), 2 * rng.normal(size=(80, 3)), 0.05, "1nats", rng)

    session, truth, teacher = start(), np.array([1.5, -1.0, 0.5]), np.random.default_rng(3)
    while not session.reached:
        question = session.ask()
        session.tell(question, int(teacher.random() < expit(question.difference @ truth)))
    assert not session.certified
    assert not session.done
    assert "whether they follow the model is not checked enough" in session.certificate.sentence
    asked = {tuple(sorted(row[:2])) for row in session.history}
    resumed = start()
    resumed.restore(session.record())
    again = resumed.ask()
    assert (again.first, again.second) == (session.ask().first, session.ask().second)
    assert tuple(sorted((again.first, again.second))) not in asked  # a person is never asked a pair twice
    resumed.tell(again, None)
    assert resumed.ask().number == again.number + 1
    assert (resumed.ask().first, resumed.ask().second) != (again.first, again.second)


def test_predictions_that_fail_are_made_anew_and_need_a_larger_lead() -> None:
    pool = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 1.0]])
    check = Consistency(pool, np.arange(3), 0.2, fresh=True)
    for _ in range(8):
        check.tell(0, 1, 1)
        check.tell(2, 0, 1)
    check.prepare(reached=True)
    assert check.question in ((1, 2), (2, 1))  # the pair that nothing was asked about
    for _ in range(LAG):
        assert not check.passed
        check.tell(1, 2, 1)  # 1 is preferred to 2, though 2 to 0 and 0 to 1
        check.prepare(reached=True)
    assert (check.contrary, check.lead, check.needed) == (LAG, 0, LEAD_AGAIN)
    assert check.question is not None
    check.prepare(reached=False)
    assert (check.contrary, check.needed) == (0, LEAD)


def test_check_questions_end_when_a_person_has_answered_every_pair() -> None:
    pool = np.array([[0.0], [1.0], [2.0]])
    check = Consistency(pool, np.arange(3), 0.2, fresh=False)
    check.tell(1, 0, 1)
    check.prepare(reached=True)
    while check.question is not None:
        assert not check.passed
        check.tell(*check.question, None)
        check.prepare(reached=True)
    assert check.passed


def _nobody(number: int = 400) -> Elicitation:
    """Two candidates, each with a rival that is better by what the answers say."""
    features = np.array([[0.0, 0.0], [1.0, 0.0]])

    def rivals(index: np.ndarray) -> np.ndarray:
        return features[index][:, None] + np.array([[[0.0, 1.0]]])

    pool = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 2.0], [1.0, 2.0]])
    rng = np.random.default_rng(0)
    session = Elicitation(features, Ball(2.0), pool, 0.05, "0.2nats", rng, rivals=rivals, fresh=True)
    for _ in range(number):
        if session.done:
            break
        session._pending = session._question(*((2, 0) if rng.random() < 0.5 else (1, 0)))
        session.tell(session._pending, int(rng.random() < expit(session._pending.difference @ [0.5, 1.5])))
    return session


def test_a_certificate_about_nobody_is_a_contradiction() -> None:
    """Trap 10 with cones: where no candidate can be best, every bound is a maximum over nothing."""
    session = _nobody()
    assert session.contradicted
    assert not session.certified
    assert "is any of the candidates the best policy" in session.certificate.sentence
    assert session.gap.value <= session.goal.nats  # what would have been certified
    assert session._region is not None
    assert best_somewhere(session.features, session.gap.rivals, session._region) is False
    assert best_somewhere(session.features, None, session._region) is True  # without those rivals somebody is best


def test_nobody_is_declared_best_or_not_by_a_search_that_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """Trap 9: a search that ends anywhere leaves the question open, and then nothing is certified."""
    session = _nobody()
    assert session._region is not None

    def nothing(region: LikelihoodSet, v: np.ndarray, rows: np.ndarray, tolerance: float) -> Certificates:
        size, k = rows.shape[:2]
        w = np.repeat(region.interior[None], size, axis=0)
        c, mu = np.zeros(size), np.zeros((size, k))
        bound, rest = dual_bounds(region, v, rows, w, c, mu)
        return Certificates(bound, bound, w, c, mu, rest, w)

    monkeypatch.setattr("bridge_algos.asking.vacuous.search", nothing)
    assert best_somewhere(session.features, session.gap.rivals, session._region) is None


def test_near_emptiness_is_shown_before_a_cycle_is_refuted() -> None:
    """Trap 11: a wrong model shrinks the set first; the certificate says how little room is left."""
    session, rng = _cycle_session(0)
    rooms = []
    while not session.contradicted:
        question = session.ask()
        session.tell(question, _cyclic(rng, question.first, question.second))
        certificate = session.certificate
        rooms.append(certificate.room)
        level = session.evidence.value - log(20)
        best = minimize(
            lambda w: -session.answers.log_likelihood(w[None])[0],
            np.zeros(2),
            constraints=[{"type": "ineq", "fun": lambda w: 9 - w @ w}],
            method="SLSQP",
        )
        assert certificate.room == pytest.approx(-best.fun - level, abs=1e-3)
        assert f"{certificate.room:.3g} nats above the threshold" in certificate.sentence
    assert 0 < min(rooms) < 5


def test_honest_teachers_are_rarely_refuted() -> None:
    """E_t against the teacher's own weights exceeds 1/delta_M in at most a share delta_M of sessions.

    A correct test fails here with probability below 1e-6.
    """
    sessions, allowed = 30, 5
    assert binom.sf(allowed, sessions, DELTA_MODEL) < 1e-6
    exceeding = 0
    for seed in range(sessions):
        rng = np.random.default_rng(seed)
        d, size = (3, 4) if seed % 2 else (5, 40)
        pool, truth = rng.normal(size=(size, d)), rng.normal(size=d)
        radius = float(np.linalg.norm(truth)) * (1 if seed % 3 else 2)
        test, answers = ModelTest(pool, np.arange(size), radius), Answers(d)
        evidence = Evidence([k * d / radius**2 for k in (1.0, 4.0, 16.0)], d)
        largest = -np.inf
        for t in range(50):
            first, second = rng.choice(size, 2, replace=False)
            x = pool[first] - pool[second]
            answer = int(rng.random() < expit(x @ truth))
            test.tell(first, second, answer)
            evidence.tell(*answers.add(x, answer))
            if t % 10 == 9:
                evidence.refit(answers)
            own = float(answers.log_likelihood(truth[None])[0])
            largest = max(largest, test.evidence(evidence.value, own))
        exceeding += largest >= THRESHOLD
    assert exceeding <= allowed


def test_bets_are_fair_under_the_model_exactly() -> None:
    """Over all 2^6 outcomes of an adaptive session the forecasts sum to 1, so that the stake has mean 1 for any w*."""
    pool = np.array([[0.0, 0.0], [1.0, 0.2], [-0.4, 1.3]])
    total = 0.0
    for outcome in product((0, 1), repeat=6):
        test, answers = ModelTest(pool, np.arange(3), 2.0), Answers(2)
        for t, answer in enumerate(outcome):
            first, second = ((0, 1), (1, 2), (2, 0))[(t + sum(outcome[:t])) % 3]  # what is asked depends on the answers
            test.tell(first, second, answer)
            answers.add(pool[first] - pool[second], answer)
        total += exp(test.outside)  # the chance of this outcome under w*, times forecast / chance
        assert answers.total == 6
    assert total == pytest.approx(1.0, abs=1e-6)
    assert total <= 1.0


def test_the_largest_likelihood_is_bounded_wherever_the_search_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """Trap 9: a failing optimiser makes the test weaker, never a refutation false."""
    rng = np.random.default_rng(3)
    answers = Answers(3)
    for _ in range(60):
        x = rng.normal(size=3)
        answers.add(x, int(rng.random() < expit(4 * x[0])))
    reached, bound = highest(answers, 1.5, np.zeros(3))
    assert reached <= bound <= reached + 1e-2
    monkeypatch.setattr("bridge_algos.asking.region._inner_fit", lambda answers, radius, w, weight: w)
    for _ in range(20):
        start = rng.normal(size=3)
        start *= 1.4 * rng.random() / np.linalg.norm(start)
        assert highest(answers, 1.5, start)[1] >= reached


@pytest.mark.parametrize("reverse", [False, True])
def test_the_order_of_a_pair_does_not_matter(reverse: bool) -> None:
    """Trap 1: "chosen first" makes every answer 1; neither evidence nor test of the model can tell."""
    rng = np.random.default_rng(5)
    pool, truth = rng.normal(size=(30, 3)), np.array([1.0, -1.0, 0.5])
    tests, evidences = [], []
    for chosen_first in (False, True):
        rng = np.random.default_rng(6)
        test, answers, evidence = ModelTest(pool, np.arange(30), 3.0), Answers(3), Evidence([1.0], 3)
        for _ in range(60):
            first, second = rng.choice(30, 2, replace=False)
            answer = int(rng.random() < expit((pool[first] - pool[second]) @ truth))
            if chosen_first and answer == int(reverse):
                first, second, answer = second, first, 1 - answer
            test.tell(first, second, answer)
            evidence.tell(*answers.add(pool[first] - pool[second], answer))
        tests.append(test.outside)
        evidences.append(evidence.value)
    assert tests[0] == pytest.approx(tests[1], abs=1e-9)
    assert evidences[0] == pytest.approx(evidences[1], abs=1e-9)


def test_pairs_of_files_are_oriented_by_a_hash() -> None:
    """Trap 1: a forecast by position is right every time when the chosen one comes first, and half of the time here."""
    pairs = [(f"clip-{i}", f"clip-{i + 1000}") for i in range(1000)]
    answers = [orient(chosen, rejected)[2] for chosen, rejected in pairs]
    assert abs(np.mean(answers) - 0.5) < 5 * 0.5 / np.sqrt(1000)
    for chosen, rejected in pairs:
        first, second, answer = orient(chosen, rejected)
        assert orient(rejected, chosen) == (first, second, 1 - answer)
        assert {first, second} == {chosen, rejected}
        assert (first == chosen) == (answer == 1)
    by_position = Tables()
    stakes = 0.0
    for answer in np.ones(40, dtype=int):  # all pairs "chosen first", told to a table by position
        stakes += log(by_position.forecast((0, 1))) - log(0.5)
        by_position.learn((0, 1), answer)
    assert stakes > THRESHOLD  # it would refute a teacher who tosses coins
    with pytest.raises(InputError, match="two different items"):
        orient("a", "a")


@pytest.mark.parametrize("close", [True, False])
def test_skips_that_look_close_are_warned_of(close: bool) -> None:
    """Trap 4: leaving out what is close makes the others look surer, and voids the guarantee."""
    rng = np.random.default_rng(2)
    features, pool, truth = rng.normal(size=(8, 3)), 2 * rng.normal(size=(60, 3)), np.array([1.0, -0.5, 0.2])
    session = Elicitation(features, Ball(2.3), pool, 0.05, "4nats", rng, asking="random")
    for t in range(160):
        session._pending = session._question(*(int(item) for item in rng.choice(60, 2, replace=False)))
        z = float(session._pending.difference @ truth)
        felt = z + rng.logistic()
        leave = abs(felt) < 1 if close else t % 4 == 0
        session.tell(session._pending, None if leave else int(felt > 0))
    certificate = session.certificate
    assert certificate.skipped >= 20
    assert "questions are left unanswered for no reason that depends on the answer" in certificate.assumptions
    assert bool(certificate.warnings) == close
    assert ("look closer than those answered" in certificate.sentence) == close


def test_leaving_out_what_is_close_makes_answers_look_surer() -> None:
    """Trap 4, exactly: at z = 1 the share of 1s among the answered is .81 instead of .73."""
    first, second = expit(1 - 1), 1 - expit(1 + 1)  # z + logistic noise above 1, and below -1
    assert first / (first + second) == pytest.approx(0.81, abs=0.005)
    assert expit(1) == pytest.approx(0.73, abs=0.005)


def test_innocent_skips_are_seldom_warned_of() -> None:
    """In at most one of 100 looks, up to chance: more than 14 of 300 has probability below 1e-6."""
    assert binom.sf(14, 300, 0.01) < 1e-6
    rng = np.random.default_rng(0)
    alarms = sum(skip_warning(rng.normal(size=12), rng.normal(size=80)) is not None for _ in range(300))
    assert alarms <= 14
    assert skip_warning(np.zeros(4), np.ones(50)) is None


def test_two_people_who_differ_are_not_one_teacher() -> None:
    """Trap 7: with their answers pooled, neither one's weights are left in the set; alone, each one's are."""
    rng = np.random.default_rng(1)
    people = np.array([[2.0, 0.0], [-1.5, 1.5]])
    pooled, alone = (Answers(2), Evidence([0.5], 2)), [(Answers(2), Evidence([0.5], 2)) for _ in people]
    for t in range(400):
        x, who = rng.normal(size=2), t % 2
        answer = int(rng.random() < expit(x @ people[who]))
        for answers, evidence in (pooled, alone[who]):
            evidence.tell(*answers.add(x, answer))
            if evidence.stale:
                evidence.refit(answers)
    for person, (answers, evidence) in zip(people, alone, strict=True):
        assert answers.log_likelihood(person[None])[0] >= evidence.value - log(20)
        assert pooled[0].log_likelihood(person[None])[0] < pooled[1].value - log(20)
    session, _ = _cycle_session(0)
    assert "all answers come from one teacher, or from several who share w" in session.certificate.assumptions


def test_an_empty_set_is_a_contradiction_in_words() -> None:
    """Trap 10, with the model test off: weights of norm W cannot be that sure of anything."""
    items = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    session = Elicitation(items, Ball(0.02), 100 * items, 0.05, "0.001nats", np.random.default_rng(0), fresh=True)
    session.test.refutes = lambda answers, inside, near: False  # type: ignore[method-assign]
    for t in range(300):
        if session.contradicted:
            break
        session._pending = session._question(*((1, 0) if t % 2 else (0, 1)))
        session.tell(session._pending, t % 2)
    answers, level = session.answers, session.evidence.value - log(20)
    assert session.contradicted == is_empty(answers, level, 0.02, np.zeros(2))
    assert session.contradicted == (likelihood_set(answers, level, 0.02, np.zeros(2)) is None)


def test_forecasters_do_not_depend_on_the_order() -> None:
    rng = np.random.default_rng(0)
    pool = rng.normal(size=(20, 8))
    shapes = Interactions(pool)
    logistic = Logistic(np.ones(15 + 21))
    for _ in range(40):
        first, second = rng.choice(20, 2, replace=False)
        there, back = (np.concatenate(shapes.features(*pair)) for pair in ((first, second), (second, first)))
        assert np.allclose(there, -back)
        assert logistic.forecast(there) + logistic.forecast(back) == pytest.approx(1, abs=1e-12)
        logistic.learn(there, int(rng.random() < 0.8))


@pytest.mark.parametrize("spread", [1e-6, 1.0, 1e4])
def test_the_logistic_forecaster_finds_the_balance_of_prior_and_answer(spread: float) -> None:
    logistic = Logistic(np.array([spread]))
    logistic.learn(np.ones(1), 1)
    mean = float(logistic.mean[0])
    assert mean == pytest.approx(spread * (1 - expit(mean)), rel=1e-3)
    assert 0 < logistic.covariance[0, 0] <= spread


def test_wrong_teachers_are_studied() -> None:
    """The function behind the table: verdicts add up, and an honest teacher is certified and right."""
    verdicts = wrong_teacher("follows the model", make_mdp("starmdp"), 2, n_demonstrations=2, max_questions=25)
    assert verdicts.refuted + verdicts.certified <= verdicts.sessions
    assert verdicts.wrong <= verdicts.certified
    assert verdicts.refuted == 0
    assert verdicts.wrong == 0
    assert "was refuted in 0 of" in verdicts.sentence
    assert "'mistakes, 10 %'" in dataclasses.replace(verdicts, teacher="mistakes, 10 %").sentence
    assert len(TEACHERS) == 12
    with pytest.raises(InputError, match="the teacher must be one of"):
        wrong_teacher("nobody", make_mdp("starmdp"), 1)
