"""The clone and the transition estimate are the likelihood's maximisers, and radius zero contains the expert."""

import numpy as np
import pytest
from conftest import random_dynamics
from hypothesis import given
from hypothesis import strategies as st

from bridge_algos.hellinger import squared_hellinger
from bridge_algos.mdp import TabularMDP
from bridge_algos.offline.cloning import action_counts, add_action_noise, clone_deterministic, clone_stochastic
from bridge_algos.offline.policy_set import PolicySet
from bridge_algos.offline.transitions import estimate_transitions, transition_counts
from bridge_algos.policies import all_policies
from bridge_algos.trajectories import Trajectories, sample_trajectories
from bridge_theory.errors import InputError

DEMOS = Trajectories(np.array([[0, 1, 1], [0, 0, 1]]), np.array([[1, 0, 0], [1, 1, 0]]))


def test_counts_cover_pairs_and_inner_transitions() -> None:
    np.testing.assert_array_equal(action_counts(DEMOS, 3, 2), [[0, 3], [3, 0], [0, 0]])
    counts = transition_counts(DEMOS, 3, 2)
    assert counts.sum() == 2 * (3 - 1)
    assert counts[0, 1, 1] == 2
    assert counts[0, 1, 0] == 1
    assert counts[1, 0, 1] == 1


def test_ties_are_broken_as_documented(rng: np.random.Generator) -> None:
    counts = action_counts(DEMOS, 3, 2)
    np.testing.assert_array_equal(clone_deterministic(counts, tie_break="first"), [1, 0, 0])
    drawn = np.array([clone_deterministic(counts, rng) for _ in range(60)])
    assert (drawn[:, :2] == [1, 0]).all()
    assert set(drawn[:, 2]) == {0, 1}
    with pytest.raises(InputError, match="Generator"):
        clone_deterministic(counts)


@given(st.integers(0, 10**6))
def test_clones_maximise_the_likelihood(seed: int) -> None:
    rng = np.random.default_rng(seed)
    counts = rng.integers(0, 4, size=(3, 2))
    stochastic = clone_stochastic(counts)
    np.testing.assert_allclose(stochastic.sum(axis=1), 1)
    other = rng.dirichlet(np.ones(2), size=3)
    log = [float((counts * np.log(np.where(counts > 0, p, 1))).sum()) for p in (stochastic, other)]
    assert log[0] >= log[1] - 1e-12
    agreement = counts[np.arange(3), all_policies(3, 2)].sum(axis=1)
    deterministic = clone_deterministic(counts, rng)
    assert counts[np.arange(3), deterministic].sum() == agreement.max()


@pytest.mark.parametrize(("empty_row", "expected"), [("self_loop", [0, 0, 1]), ("uniform", [1 / 3] * 3)])
def test_rows_without_data_are_filled_as_documented(empty_row, expected) -> None:
    estimate = estimate_transitions(transition_counts(DEMOS, 3, 2), empty_row)
    np.testing.assert_allclose(estimate[2, 0], expected)
    np.testing.assert_allclose(estimate[0, 1], [1 / 3, 2 / 3, 0])
    np.testing.assert_allclose(estimate.sum(axis=2), 1)
    with pytest.raises(InputError, match="empty_row"):
        estimate_transitions(transition_counts(DEMOS, 3, 2), "zero")  # type: ignore[arg-type]


@given(st.integers(0, 10**6), st.integers(1, 4), st.integers(1, 4))
def test_radius_zero_contains_the_expert_surely(seed: int, n: int, horizon: int) -> None:
    """Audit T8: fixed start, closed count MLE: the ball of radius zero is the version space, whatever the tie-break."""
    rng = np.random.default_rng(seed)
    dynamics = random_dynamics(rng, 4, 2, horizon)
    mdp = TabularMDP(dynamics.transitions, np.eye(4)[0], horizon, np.zeros(4))
    expert = rng.integers(2, size=4)
    demos = sample_trajectories(mdp, expert, n, rng)
    clone = clone_deterministic(action_counts(demos, 4, 2), rng)
    estimate = mdp.dynamics.under(estimate_transitions(transition_counts(demos, 4, 2), "self_loop"))
    ball = PolicySet(estimate, clone, 0.0)
    assert squared_hellinger(estimate, expert, estimate, clone) == pytest.approx(0, abs=1e-12)
    policies = all_policies(4, 2)
    consistent = (policies[:, demos.states] == demos.actions).all(axis=(1, 2))
    np.testing.assert_array_equal(ball.contains(policies), consistent)
    assert ball.contains(expert)


def test_noise_replaces_the_right_share_of_actions(rng: np.random.Generator) -> None:
    clean = Trajectories(np.zeros((2000, 10), dtype=np.int64), np.zeros((2000, 10), dtype=np.int64))
    noisy = add_action_noise(clean, 0.2, 4, rng)
    np.testing.assert_array_equal(noisy.states, clean.states)
    # a replaced action differs with probability 3/4: mean 0.15; Hoeffding over 20,000 draws at 1e-7
    assert abs((noisy.actions != 0).mean() - 0.15) < np.sqrt(np.log(2e7) / 40_000)
    np.testing.assert_array_equal(add_action_noise(clean, 0.0, 4, rng).actions, clean.actions)
    with pytest.raises(InputError, match="probability"):
        add_action_noise(clean, 1.2, 4, rng)
