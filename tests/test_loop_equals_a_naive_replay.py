"""A run is replayed from its log by a naive implementation: multipliers, bonuses, sets, pairs, regrets must agree."""

from math import cosh, log, sqrt

import numpy as np
import pytest
from conftest import random_dynamics

from bridge_algos.embeddings import make_embedding
from bridge_algos.evaluation import expected_return
from bridge_algos.mdp import TabularMDP
from bridge_algos.occupancy import state_action_occupancies
from bridge_algos.offline.transitions import estimate_transitions, transition_counts
from bridge_algos.online.confidence import fixed, repaired
from bridge_algos.online.loop import Learner, OnlineProblem, run_online
from bridge_algos.online.oracles import BradleyTerryOracle
from bridge_algos.online.preference_model import fit_exact
from bridge_algos.policies import all_policies
from bridge_algos.trajectories import sample_trajectories
from bridge_theory.errors import InputError

S, A, H, K, ROUNDS = 3, 2, 4, 3, 6
LAM, DELTA = 0.7, 0.1


def features(dynamics, policy) -> np.ndarray:
    occupancy = state_action_occupancies(dynamics, policy)
    return np.concatenate([occupancy.sum(axis=(0, 2)), occupancy.sum(axis=(0, 1))])


def play(known: bool, confidence_name: str):
    """Run the loop with a logging teacher; return everything that a replay needs."""
    rng = np.random.default_rng(11)
    dynamics = random_dynamics(rng, S, A, H)
    mdp = TabularMDP(dynamics.transitions, dynamics.initial, H, rng.normal(size=(S, A)))
    embedding = make_embedding("identity_short", S, A, H)
    bound, weight_bound = embedding.bound, 1.5
    teacher = BradleyTerryOracle(embedding, rng.normal(size=S + A) * 0.1)
    log_ = []

    def oracle(first, second, generator):
        outcomes = teacher(first, second, generator)
        log_.append((first, second, outcomes))
        return outcomes

    if confidence_name == "repaired":
        confidence = repaired(bound, weight_bound, S + A, S, A, H, LAM, DELTA, DELTA)
    else:
        confidence = fixed(0.3, 0.05, S, A, H, LAM)
    policies = all_policies(S, A)
    offline = transition_counts(sample_trajectories(mdp, policies[5], 3, rng), S, A)
    expert = policies[5]
    problem = OnlineProblem(mdp, embedding, oracle, expert, expected_return(mdp, policies[3]))
    learner = Learner(
        "x", policies, None if known else offline, confidence, "uncertainty_and_bonus", weight_bound, 1.0, LAM, K
    )
    record = run_online(problem, learner, ROUNDS, np.random.default_rng(5))
    return mdp, embedding, policies, offline, expert, weight_bound, record, log_


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("confidence", ["repaired", "fixed"])
def test_replay(known: bool, confidence: str) -> None:
    mdp, embedding, policies, counts, optimum, weight_bound, record, log_ = play(known, confidence)
    bound, d = embedding.bound, S + A
    kappa = 2 + 2 * cosh(2 * bound * weight_bound)
    matrix = (kappa * LAM if confidence == "repaired" else LAM) * np.eye(d)
    x, outcomes = np.empty((0, d)), np.empty(0)
    counts = counts.copy()
    returns = np.array([expected_return(mdp, p) for p in policies])
    w = np.zeros(d)

    def look():
        dynamics = mdp.dynamics if known else mdp.dynamics.under(estimate_transitions(counts))
        phi = np.array([features(dynamics, p) for p in policies])
        bonus = np.zeros(len(policies))
        for i, policy in enumerate(policies if not known else []):
            occupancy = state_action_occupancies(dynamics, policy)
            n = counts.sum(axis=2)
            safe = np.maximum(n, 1)
            if confidence == "repaired":
                eps = np.minimum(2, np.sqrt(2 * (S * log(2) + np.log(S * A * safe * (safe + 1) / DELTA)) / safe))
                cost = (occupancy[: H - 1] * np.where(n > 0, eps, 2)).sum()
                bonus[i] = bound * weight_bound * min(2, cost)
            else:
                step = np.where(n > 0, np.minimum(log(S * A), np.sqrt(log(S * A) / safe)), log(S * A))
                bonus[i] = 0.05 * (occupancy * step).sum()
        return phi, bonus

    for t in range(ROUNDS):
        phi, bonus = look()
        gamma = 0.3
        if confidence == "repaired":
            ratio = np.linalg.slogdet(matrix)[1] - d * log(kappa * LAM)
            g = x.T @ (1 / (1 + np.exp(-x @ w))) + LAM * w - x.T @ outcomes
            error = sqrt(g @ np.linalg.inv(matrix) @ g)
            beta = sqrt(LAM / kappa) * weight_bound + 0.5 * sqrt(2 * log(1 / DELTA) + ratio)
            gamma = kappa * (beta + error)
        assert record["gamma"][t] == pytest.approx(gamma, rel=1e-6)
        assert record["log_det"][t] == pytest.approx(np.linalg.slogdet(matrix)[1], rel=1e-9)
        difference = phi[:, None] - phi[None]
        norms = np.sqrt(np.einsum("ijk,kl,ijl->ij", difference, np.linalg.inv(matrix), difference))
        kept = (difference @ w + gamma * norms + bonus[:, None] + bonus >= -1e-9).all(axis=1)
        assert record["set_size"][t] == kept.sum()
        objective = np.where(kept[:, None] & kept, gamma * norms + bonus[:, None] + bonus, -np.inf)
        if kept.sum() > 1:
            np.fill_diagonal(objective, -np.inf)
        first, second = int(record["first"][t]), int(record["second"][t])
        assert objective[first, second] == pytest.approx(objective.max(), rel=1e-7)
        assert record["uncertainty"][t] == pytest.approx(norms[first, second], abs=1e-6)
        assert record["bonus_sum"][t] == pytest.approx(bonus[first] + bonus[second], rel=1e-6, abs=1e-12)
        best = expected_return(mdp, optimum)
        assert record["pseudo_regret"][t] == pytest.approx(best - (returns[first] + returns[second]) / 2)
        one, two, answers = log_[t]
        assert one.states.shape == (K, H)
        new = embedding.of_trajectories(one) - embedding.of_trajectories(two)
        x, outcomes = np.concatenate([x, new]), np.concatenate([outcomes, answers])
        expected = phi[first] - phi[second]
        matrix = matrix + (new.T @ new if confidence == "repaired" else np.outer(expected, expected))
        counts += transition_counts(one, S, A) + transition_counts(two, S, A)
        w = fit_exact(x, outcomes, LAM, np.zeros(d))
        if np.linalg.norm(w) > weight_bound:
            pytest.fail("choose an instance whose estimate stays in the ball, where the projection is the identity")
        greedy = (look()[0] @ w).argmax()
        reference = expected_return(mdp, policies[3])
        assert record["suboptimality"][t] == pytest.approx(reference - returns[greedy])


def test_the_certified_set_shrinks_and_keeps_the_optimum() -> None:
    """Three policies of one step, many answers a round: Pi_t loses a policy, never the best one (audit R2)."""
    embedding = make_embedding("state_action_counts", 1, 3, 1)
    w_star = np.array([0.9, 0.0, -0.4])
    mdp = TabularMDP([[[1.0]] * 3], [1.0], 1, w_star[None])
    policies = all_policies(1, 3)
    for optimum, expected in ((0, 1.0), (2, 0.0)):
        kept = []
        for seed in range(5):
            problem = OnlineProblem(
                mdp, embedding, BradleyTerryOracle(embedding, w_star), policies[optimum], 0.9, w_star
            )
            confidence = repaired(1.0, 1.0, 3, 1, 3, 1, 1.0, 1e-6, 1e-6)
            learner = Learner("x", policies, None, confidence, "max_uncertainty", 1.0, lam=1.0, comparisons=4000)
            record = run_online(problem, learner, 12, np.random.default_rng(seed))
            assert record["set_size"][0] == 3
            assert record["set_size"][-1] < 3
            kept.append(record["optimum_kept"][-1])
            assert record["optimum_ruled_out"][-1] == 1 - kept[-1]
        assert np.mean(kept) == expected


@pytest.mark.parametrize("answers", [np.full(K, 7.0), np.full(K, -1.0), np.zeros(K + 1), 1.0])
def test_a_users_teacher_must_answer_in_range(answers) -> None:
    embedding = make_embedding("state_counts", S, A, H)
    dynamics = random_dynamics(np.random.default_rng(0), S, A, H)
    mdp = TabularMDP(dynamics.transitions, dynamics.initial, H, np.zeros(S))
    policies = all_policies(S, A)
    problem = OnlineProblem(mdp, embedding, lambda *_: answers, policies[0], 0.0)
    learner = Learner("x", policies, None, fixed(1.0, 0.0, S, A, H, 1.0), "ucb", 1.0, comparisons=K)
    with pytest.raises(InputError, match="the oracle answered"):
        run_online(problem, learner, 1, np.random.default_rng(0))
