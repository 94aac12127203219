"""Springing a trap of certified answers breaks coverage, and the protocol keeps it: by computed probabilities.

One question in one dimension, x = 1, asked of a teacher with log-odds 1 unless said otherwise. The set is the one of a
finite prior, so that the chance of ever losing the true weights is a sum over counts of answers.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from math import comb

import numpy as np
import pytest
from scipy.special import betaln, log_expit, logsumexp

import bridge_theory as theory
from proofs_checks.answers.checks.cycles import answers_until_refuted, certified_gap_of_a_circle
from proofs_checks.answers.checks.dual import certificate, certified_in_floats, instances
from proofs_checks.answers.checks.logistic import evidence, fit, log_likelihood, rational
from proofs_checks.coverage import Coverage

DELTA, TRUE = 0.05, 1.0
LEVEL = float(theory.likelihood_threshold.estimate(evidence_loss=0, scales=1, delta=DELTA))
WEIGHTS = np.linspace(-6, 6, 49)
HONEST = 1 / (1 + np.exp(-TRUE))


@cache
def inside(ones: int, zeros: int, weight: float = TRUE) -> bool:
    return float(log_likelihoods(ones, zeros, np.array(weight))) >= evidence_of(ones, zeros) - LEVEL


def log_likelihoods(ones: int, zeros: int, weights: np.ndarray = WEIGHTS) -> np.ndarray:
    return ones * log_expit(weights) + zeros * log_expit(-weights)


@cache
def evidence_of(ones: int, zeros: int) -> float:
    return float(logsumexp(log_likelihoods(ones, zeros)) - np.log(len(WEIGHTS)))


def chance_of_losing(
    rounds: int,
    chance: Callable[[int, int], float] = lambda ones, zeros: HONEST,
    keeps: Callable[[int, int], bool] = inside,
) -> float:
    """The probability that the true weights ever leave within ``rounds`` answers, exact up to rounding."""
    alive, lost = {0: 1.0}, 0.0
    for t in range(rounds):
        following: dict[int, float] = {}
        for ones, mass in alive.items():
            p = chance(ones, t - ones)
            for more, share in ((1, p), (0, 1 - p)):
                following[ones + more] = following.get(ones + more, 0.0) + mass * share
        alive = {ones: mass for ones, mass in following.items() if keeps(ones, t + 1 - ones)}
        lost += sum(mass for ones, mass in following.items() if ones not in alive)
    return lost


def test_the_protocol_itself_loses_the_true_weights_with_at_most_delta() -> None:
    assert chance_of_losing(300) <= DELTA


def test_trap_1_chosen_first_makes_the_answer_part_of_the_question() -> None:
    """Files list the chosen item first, so that every recorded answer is 1: a forecaster learns that and loses w*."""
    answers = 60
    forecast_of_ones = -np.log(answers + 1)  # Laplace's rule: 1/2, 2/3, 3/4, ...
    best_case = answers * log_expit(TRUE)  # the likeliest that the true weights can make any answers
    assert best_case < forecast_of_ones - LEVEL  # w* leaves whatever was answered: with probability 1
    # oriented by something fixed, the same forecaster keeps w*
    laplace = chance_of_losing(
        answers,
        keeps=lambda ones, zeros: log_likelihoods(ones, zeros, np.array(TRUE)) >= betaln(ones + 1, zeros + 1) - LEVEL,
    )
    assert laplace <= DELTA


def test_trap_1_leaves_the_likelihood_itself_unchanged() -> None:
    """log P is the same for (x, 0) and (-x, 1), so that G1' without forecasts gives the same set from either file."""
    rng = np.random.default_rng(0)
    x, w = rng.normal(size=(40, 3)), rng.normal(size=3)
    answers = rng.random(40) < 0.6
    fixed = np.where(answers, log_expit(x @ w), log_expit(-(x @ w))).sum()
    chosen_first = log_expit(np.where(answers[:, None], x, -x) @ w).sum()
    assert fixed == pytest.approx(chosen_first, abs=1e-12)


def test_trap_2_an_undo_after_the_certificate_has_moved_redraws_the_answers_that_displease() -> None:
    redrawn = chance_of_losing(300, lambda ones, zeros: HONEST + (1 - HONEST) * HONEST)  # each 0 is drawn once more
    assert redrawn > 0.99
    # an undo before the update does not know what the answer does: the chance of a 1 stays, the protocol's set holds
    assert chance_of_losing(300) <= DELTA


def test_trap_3_fifty_remembered_repeats_lose_the_true_weights_with_probability_1() -> None:
    assert not inside(50, 0)
    assert not inside(0, 50)
    assert inside(1, 0)  # the recorded answer once, and no term for its repeats
    assert inside(0, 1)


def test_trap_4_too_close_to_call_shifts_the_answers_that_remain() -> None:
    """The teacher skips where |z + noise| < 1: 81 % of the answers left are 1 instead of 73 %."""
    one, zero = 1 / (1 + np.exp(-(TRUE - 1))), 1 / (1 + np.exp(TRUE + 1))
    among_answered = one / (one + zero)
    assert among_answered == pytest.approx(0.81, abs=0.005)
    assert pytest.approx(0.73, abs=0.005) == HONEST
    assert 0.4 < chance_of_losing(300, lambda ones, zeros: among_answered) < 0.6
    # skips that do not depend on the answer, half of all questions say: the answers left are honest
    assert chance_of_losing(150) <= DELTA


def test_trap_5_late_answers_lose_the_true_weights_surely() -> None:
    """Of 100 questions at once the 1s arrive first; the set is read on arrival."""
    last_that_keeps = max(ones for ones in range(100) if inside(ones, 0))
    fewer_ones = sum(comb(100, k) * HONEST**k * (1 - HONEST) ** (100 - k) for k in range(last_that_keeps + 1))
    assert 1 - fewer_ones > 1 - 1e-9
    assert chance_of_losing(100) <= DELTA  # in the order of the questions


def test_trap_6_forecasts_read_from_a_log_certify_anything() -> None:
    """A forged log says that each answer was foreseen: Q = 0. What is computed again never exceeds the likelihood."""
    forged = 0.0
    best_case = 60 * log_expit(TRUE)
    assert best_case < forged - LEVEL  # even the likeliest answers lose w*
    for ones in range(61):
        assert evidence_of(ones, 60 - ones) <= log_likelihoods(ones, 60 - ones).max()
        assert inside(ones, 60 - ones, WEIGHTS[np.argmax(log_likelihoods(ones, 60 - ones))])


def test_trap_7_pooling_people_needs_one_weight_vector_for_each() -> None:
    """Two people with log-odds 1 and -2 answer in turn."""
    other = -2.0
    second = 1 / (1 + np.exp(-other))

    def in_turn(ones: int, zeros: int) -> float:
        return second if (ones + zeros) % 2 else HONEST

    def pooled_keeps(ones: int, zeros: int) -> bool:
        return inside(ones, zeros, TRUE) or inside(ones, zeros, other)

    assert chance_of_losing(300, in_turn, pooled_keeps) > 0.99
    assert joint_chance_of_losing(TRUE, other, 60) <= DELTA


def joint_chance_of_losing(first: float, second: float, rounds: int) -> float:
    """One martingale for both: the product prior on pairs of weights, and one threshold for the sum."""
    slack = [
        np.array(
            [
                [
                    float(log_likelihoods(ones, t - ones, np.array(w))) - evidence_of(ones, t - ones)
                    for ones in range(t + 1)
                ]
                + [-np.inf] * (rounds - t)
                for t in range(rounds + 1)
            ]
        )
        for w in (first, second)
    ]
    chances = [1 / (1 + np.exp(-w)) for w in (first, second)]
    alive, lost = np.zeros((rounds + 1, rounds + 1)), 0.0
    alive[0, 0] = 1.0
    for step in range(rounds):
        who = step % 2
        p = chances[who]
        moved = np.roll(alive, 1, axis=who) * p + alive * (1 - p)
        asked = ((step + 2) // 2, (step + 1) // 2)
        kept = slack[0][asked[0]][:, None] + slack[1][asked[1]][None, :] >= -LEVEL
        lost += float(moved[~kept].sum())
        alive = np.where(kept, moved, 0.0)
    return lost


def test_trap_8_a_sample_with_the_expert_inserted_hides_what_a_sample_cannot_know() -> None:
    """1,000 policies of utility up to 1/2 and one expert of utility 1; 50 are sampled, weights are known."""
    rng = np.random.default_rng(8)
    expert, others = 1.0, rng.random(1000) / 2
    false, inserted = 0, 0
    for _ in range(200):
        sample = rng.choice(np.append(others, expert), 50, replace=False)
        for candidates, kind in ((sample, "honest"), (np.append(sample, expert), "inserted")):
            certified = float(theory.certified_gap.estimate(advantage=0.0))  # the best of the sample is recommended
            wrong = expert - candidates.max() > certified
            false += wrong and kind == "honest"
            inserted += wrong and kind == "inserted"
    assert inserted == 0  # the simulation looks perfect
    assert false > 180  # where the expert's policy is unknown, nearly every certificate about all policies is wrong


def test_trap_9_an_optimisers_output_is_no_bound_and_its_dual_certificate_is_one() -> None:
    """Three undamped Newton steps towards the maximum, projected: their value is too small, the certificate never."""
    rng = np.random.default_rng(9)
    below, trials = 0, 0
    for problem in instances(rng, 60):
        x, v = problem.answers.floats(), np.array([float(entry) for entry in problem.v])
        level = -float(problem.evidence_loss) + np.log(DELTA)
        centre = fit(x, 0.5)
        directions = [centre + r * (v / np.linalg.norm(v)) for r in np.linspace(0, 6, 200)]
        reached = [float(v @ w) for w in directions if np.linalg.norm(w) <= 3 and log_likelihood(x, w) >= level]
        if not reached:
            continue
        w0 = undamped(x, v)
        trials += 1
        below += float(v @ w0) < max(reached)
        bound = float(certificate(problem, rational(w0), 1, (0, 0)).mid())
        assert bound >= max(reached) - 1e-9
    assert trials > 40
    assert below > trials / 10


def undamped(x: np.ndarray, v: np.ndarray) -> np.ndarray:
    w = np.zeros(3)
    for _ in range(3):
        p = 1 / (1 + np.exp(np.clip(x @ w, -30, 30)))
        hessian = np.einsum("t,ti,tj->ij", p * (1 - p), x, x) + 1e-9 * np.eye(3)
        w = w + np.linalg.solve(hessian, v + p @ x)
        w = w * min(1.0, 3 / max(float(np.linalg.norm(w)), 1e-12))
    return w


def test_trap_9_every_candidate_gets_its_own_bound() -> None:
    """Five candidates that look worst at the fit: in some sessions another one has a larger bound."""
    rng = np.random.default_rng(90)
    missed = 0
    for _ in range(20):
        w, features = rng.normal(size=3), rng.normal(size=(30, 3))
        questions = rng.normal(size=(40, 3))
        x = questions * np.where(rng.random(40) < 1 / (1 + np.exp(-(questions @ w))), 1.0, -1.0)[:, None]
        m = fit(x, 0.5)
        level = float(evidence(x, m, 0.5)) + np.log(DELTA)
        best = features[np.argmax(features @ m)]
        bounds = np.array([certified_in_floats(x, phi - best, level, 5.0) for phi in features])
        looks_worst = np.argsort(features @ m)[-6:-1]
        missed += bounds[looks_worst].max() < bounds.max() - 1e-6
    assert missed >= 4


def test_trap_10_an_empty_set_is_a_contradiction_and_no_certificate() -> None:
    """Weights of at most 1/4 cannot explain 200 answers of which 190 are 1: the naive gap over nothing is 0."""
    ones, zeros, W = 190, 10, 0.25
    in_ball = np.abs(WEIGHTS) <= W
    level = evidence_of(ones, zeros) - LEVEL
    kept = WEIGHTS[in_ball & (log_likelihoods(ones, zeros) >= level)]
    assert len(kept) == 0
    lowest = min(kept, default=0.0)  # what a maximum over nothing comes to: "certified", from contradictory answers
    assert float(theory.certified_gap.estimate(advantage=-lowest)) == 0.0
    # G2 in no direction at all says that nothing is left: a negative right side
    slope = (ones / (1 + np.exp(W)) - zeros / (1 + np.exp(-W))) * W
    nothing = theory.dual_certificate.estimate(
        multiplier=1, loss=-float(log_likelihoods(ones, zeros, np.array(W))), slope=slope,
        evidence_loss=-evidence_of(ones, zeros), scales=1, W=W, dual_norm=abs(slope / W), delta=DELTA,
    )  # fmt: skip
    assert nothing < 0


def test_trap_11_a_wrong_model_is_certified_before_it_is_refuted_from_inside() -> None:
    """Preferences in a circle at .9: a gap of .2 nats is certified, while a test from outside refutes within 50."""
    assert certified_gap_of_a_circle(6000) <= 0.2
    refuted = [answers_until_refuted(rng, 0.9, 60) for rng in np.random.default_rng(11).spawn(40)]
    assert np.median(refuted) <= 40
    assert sum(t > 50 for t in refuted) <= 4
    clean = [answers_until_refuted(rng, 0.5, 60) for rng in np.random.default_rng(12).spawn(40)]
    assert Coverage(Fraction(1, 20), len(clean), sum(t < 60 for t in clean)).passes
