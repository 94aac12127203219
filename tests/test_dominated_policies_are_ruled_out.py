"""Runs with the likelihood set drop a policy when another beats it under all likely weights, and the best one never."""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import expit

from bridge_algos.online.likelihood import LikelihoodFilter
from bridge_algos.run.config import preset
from bridge_algos.run.log import logged_seed
from bridge_algos.run.log_file import RunLog
from bridge_algos.run.world import build_world
from proofs_checks.verify import verify

RANGE_5 = 2.1425
"""W at which the best and the worst policy of StarMDP are 5 nats apart."""

W, DELTA = 2.0, 0.05


def loglik(x: np.ndarray, o: np.ndarray, w: np.ndarray) -> float:
    return float(np.where(o == 1, -np.logaddexp(0, -x @ w), -np.logaddexp(0, x @ w)).sum())


def drawn(seed: int, m: int, n: int = 12) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Features of n policies, questions, answers, and the teacher's weights."""
    rng = np.random.default_rng(seed)
    truth = rng.normal(size=3)
    truth *= 0.8 * W / np.linalg.norm(truth)
    x = rng.integers(-2, 3, size=(m, 3)).astype(float)
    return rng.normal(size=(n, 3)), x, (rng.random(m) < expit(x @ truth)).astype(float), truth


def largest(x: np.ndarray, o: np.ndarray, level: float, v: np.ndarray, start: np.ndarray) -> float:
    """The largest <v, w> over the set, by an independent solver."""
    found = minimize(
        lambda w: -v @ w, start, jac=lambda _: -v, method="SLSQP", options={"maxiter": 500, "ftol": 1e-12},
        constraints=[
            {"type": "ineq", "fun": lambda w: W**2 - w @ w, "jac": lambda w: -2 * w},
            {"type": "ineq", "fun": lambda w: loglik(x, o, w) - level, "jac": lambda w: (o - expit(x @ w)) @ x},
        ],
    )  # fmt: skip
    assert loglik(x, o, found.x) >= level - 1e-6
    return float(v @ found.x)


@cache
def run() -> RunLog:
    """StarMDP at a range of 5 nats, until the first of sixteen policies have gone."""
    config = preset("theory", "starmdp").but(
        confidence="likelihood", rounds=105, comparisons=10, weight_bound=RANGE_5, algorithms=("bridge-known",)
    )
    return logged_seed(config, build_world(config), 1)[1]


@pytest.mark.parametrize("seed", range(8))
def test_a_policy_goes_exactly_when_no_likely_weights_want_it(seed: int) -> None:
    """Looked at after 20, 80 and 400 answers: weights remembered from before must not keep a policy.

    There are more policies than are searched at a time, so that certificates are shared.
    """
    features, x, o, _ = drawn(seed, 400, 60)
    answers, everyone = LikelihoodFilter(W, DELTA), np.ones(60, dtype=bool)
    before = everyone
    for m in (20, 80, 400):
        around = answers.look(x[:m], o[:m])
        kept = answers.survivors(features, np.zeros(60), everyone)
        told, others = x[:m].any(axis=1), features[before]
        best = others[(others @ around.center).argmax()]
        for i in np.flatnonzero(before):
            rivals = [best] if kept[i] else [best, *others]  # any rival may rule a policy out, the best one must
            values = (
                largest(x[:m][told], o[:m][told], around.level, features[i] - rival, np.zeros(3))
                for rival in rivals
                if (rival != features[i]).any()
            )
            assert all(value > -1e-4 for value in values) if kept[i] else any(value < 1e-4 for value in values)
        assert not (kept & ~before).any()
        before = kept
    assert before.sum() < 30


def test_the_best_policy_stays_while_the_true_weights_are_likely() -> None:
    held, left = 0, 0
    for seed in range(40):
        features, x, o, truth = drawn(seed, 300)
        answers, everyone = LikelihoodFilter(W, DELTA), np.ones(12, dtype=bool)
        for m in (10, 30, 100, 300):
            around = answers.look(x[:m], o[:m])
            kept = answers.survivors(features, np.zeros(12), everyone)
            told = x[:m].any(axis=1)
            if loglik(x[:m][told], o[:m][told], truth) < around.level:
                break
            held += 1
            assert kept[(features @ truth).argmax()]
        left += int(kept.sum())
    assert held > 150
    assert left < 40 * 6  # or nothing was tested


def test_bonuses_leave_dual_certificates_out() -> None:
    """Features that may be off rule a policy out only beyond their bonuses."""
    features, x, o, _ = drawn(0, 400)
    sizes = []
    for bonus in (0.0, 1e-9, 0.2, 5.0):
        answers = LikelihoodFilter(W, DELTA)
        answers.look(x, o)
        sizes.append(int(answers.survivors(features, np.full(12, bonus), np.ones(12, dtype=bool)).sum()))
    assert sizes == sorted(sizes)
    assert sizes[-1] == 12


def test_a_policy_that_may_not_challenge_rules_out_nobody() -> None:
    answers = LikelihoodFilter(4.0, DELTA)
    answers.look(np.ones((60, 1)), np.ones(60))
    features = np.array([[0.0], [1.0]])
    assert answers.survivors(features, np.zeros(2), np.array([True, False])).tolist() == [True, True]


def test_answers_that_contradict_the_model_leave_every_policy() -> None:
    answers = LikelihoodFilter(0.05, DELTA)
    assert answers.look(np.full((400, 1), 10.0), np.ones(400)).empty
    assert answers.survivors(np.array([[0.0], [1.0]]), np.zeros(2), np.ones(2, dtype=bool)).all()


def test_answers_but_first_and_second_tell_nothing() -> None:
    _, x, o, _ = drawn(0, 50)
    more, halves = np.concatenate([x, x, 0 * x]), np.concatenate([o, np.full(50, 0.5), o])
    one, two = LikelihoodFilter(W, DELTA).look(x, o), LikelihoodFilter(W, DELTA).look(more, halves)
    assert one.level == pytest.approx(two.level)
    assert np.allclose(one.matrix, two.matrix)


def test_the_checker_finds_the_policies_that_a_run_has_left() -> None:
    log = run()
    sizes = log.arrays["bridge-known/set_size"]
    assert sizes[0] == 16
    assert sizes[-1] < 16  # which the ellipsoid alone has not after 250 rounds
    (honest,) = verify(log)
    assert honest.certified, honest.words()


def test_another_number_of_policies_is_refused() -> None:
    """One policy fewer after the first answers, one more in the end."""
    log = run()
    claimed = log.arrays["bridge-known/set_size"].copy()
    claimed[1] -= 1
    claimed[-1] += 1
    (tampered,) = verify(dataclasses.replace(log, arrays={**log.arrays, "bridge-known/set_size": claimed}))
    assert not tampered.certified
    for t in (2, len(claimed)):
        assert any(f"round {t}: the policies left are claimed to be" in reason for reason in tampered.reasons)
