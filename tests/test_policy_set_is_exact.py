"""Counting, enumerating and sampling the Hellinger ball agree with testing every policy."""

import numpy as np
import pytest
from conftest import random_dynamics
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chisquare

from bridge_algos.envs.registry import make_mdp
from bridge_algos.expert.stationary import best_stationary
from bridge_algos.mdp import Dynamics, TabularMDP
from bridge_algos.offline.ball_chain import BURN_IN, BallChain
from bridge_algos.offline.policy_set import PolicySet
from bridge_algos.policies import all_policies
from bridge_theory.errors import InputError


def keys(policies: np.ndarray) -> set[bytes]:
    return {row.tobytes() for row in policies}


@given(st.integers(0, 10**6), st.integers(1, 5), st.integers(1, 3), st.integers(1, 5), st.floats(0, 1.1))
def test_count_and_enumeration_equal_a_scan_of_all_policies(seed, n_states, n_actions, horizon, radius) -> None:
    rng = np.random.default_rng(seed)
    ball = PolicySet(random_dynamics(rng, n_states, n_actions, horizon), rng.integers(n_actions, size=n_states), radius)
    policies = all_policies(n_states, n_actions)
    inside = policies[ball.contains(policies)]
    listed = ball.enumerate()
    assert ball.count() == len(inside) == len(listed)
    assert ball.contains(policies[:30]).tolist() == [bool(ball.contains(policy)) for policy in policies[:30]]
    assert keys(listed) == keys(inside)
    assert ball.contains(ball.center)


@pytest.mark.parametrize("radius", [0.0, 0.3, 0.6, 0.8, 0.9, 0.95, 0.99, 1.0])
def test_count_on_starmdp_equals_a_scan_of_its_1024_policies(radius: float) -> None:
    dynamics = make_mdp("starmdp").dynamics
    policies = all_policies(5, 4)
    for center in policies[::97]:
        ball = PolicySet(dynamics, center, radius)
        assert ball.count() == ball.contains(policies).sum()


def test_a_hopeless_count_is_refused_in_time() -> None:
    rng = np.random.default_rng(0)
    dynamics = random_dynamics(rng, 60, 2, 20)
    with pytest.raises(InputError, match="multiplications"):
        PolicySet(dynamics, np.zeros(60, dtype=np.int64), 0.9).count()


def test_unreachable_states_multiply_the_count() -> None:
    stay = np.broadcast_to(np.eye(6)[:, None], (6, 3, 6))
    ball = PolicySet(Dynamics(stay, np.eye(6)[0], 4), np.zeros(6, dtype=np.int64), 0.0)
    assert ball.count() == 3**5


@pytest.mark.parametrize("n_states", [33, 65])
def test_more_states_than_numpy_has_dimensions(n_states: int) -> None:
    """Policies are listed, whatever NumPy's limits: 32 arrays in a product, 64 axes."""
    anywhere = np.full((n_states, 2, n_states), 1 / n_states)
    reward = np.arange(2.0 * n_states).reshape(n_states, 2)
    center = np.arange(n_states) % 2
    version_space = PolicySet(Dynamics(anywhere, np.full(n_states, 1 / n_states), 3), center, 0.0)
    np.testing.assert_array_equal(version_space.enumerate(), center[None])
    assert all_policies(n_states, 1).tolist() == [[0] * n_states]
    stay = np.broadcast_to(np.eye(n_states)[:, None], (n_states, 2, n_states))
    best = best_stationary(TabularMDP(stay, np.eye(n_states)[2], 3, reward))
    assert (best.method, best.value, best.policy[2]) == ("enumeration", 15.0, 1)


def test_samples_are_uniform_over_the_set(rng: np.random.Generator) -> None:
    ball = PolicySet(random_dynamics(rng, 4, 2, 3), np.zeros(4, dtype=np.int64), 0.9)
    count = ball.count()
    assert 3 <= count <= 14
    draws = 40_000
    sample = ball.sample(draws, rng)
    _, frequency = np.unique(sample, axis=0, return_counts=True)
    assert len(frequency) == count
    # Hoeffding with a union over at most 14 policies: off by 0.015 with probability below 14 * 2 exp(-18) < 1e-6
    assert np.abs(frequency / draws - 1 / count).max() < 0.015


def test_rejection_sampling_keeps_members_only(rng: np.random.Generator) -> None:
    ball = PolicySet(random_dynamics(rng, 5, 3, 4), np.zeros(5, dtype=np.int64), 0.7)
    kept = ball.rejection_sample(20_000, rng)
    assert ball.contains(kept).all()
    assert len(keys(kept)) == len(kept) <= ball.count()
    nothing_fits = PolicySet(random_dynamics(rng, 12, 4, 9), np.zeros(12, dtype=np.int64), 0.0)
    assert nothing_fits.rejection_sample(1, rng).shape == (0, 12)


def test_bad_radius_and_too_large_enumerations_are_refused(rng: np.random.Generator) -> None:
    dynamics, center = random_dynamics(rng, 4, 3, 3), np.zeros(4, dtype=np.int64)
    for radius in (-0.1, float("nan")):
        with pytest.raises(InputError, match="radius"):
            PolicySet(dynamics, center, radius)
    with pytest.raises(InputError, match="81 policies, above the limit of 80"):
        PolicySet(dynamics, center, 1.0).enumerate(80)


def chi_square(ball: PolicySet, draws: np.ndarray) -> float:
    """The p-value of uniformity over the whole set, members that never came up included."""
    names, frequency = np.unique(draws, axis=0, return_counts=True)
    assert ball.contains(names).all()
    frequency = np.concatenate([frequency, np.zeros(ball.count() - len(names))])
    return float(chisquare(frequency).pvalue)


@pytest.mark.parametrize("radius", [0.5, 0.85, 0.95])
@pytest.mark.parametrize("seed", range(4))
def test_the_chain_is_uniform_where_the_set_can_be_counted(seed: int, radius: float) -> None:
    """One draw from each of 20,000 independent chains; an honest chain fails with probability 1e-8, 12e-8 in all."""
    rng = np.random.default_rng(seed)
    center = rng.integers(3, size=5)
    ball = PolicySet(random_dynamics(rng, 5, 3, 4), center, radius)
    chain = BallChain(ball.dynamics, center, radius**2, chains=20_000)
    for _ in range(BURN_IN):
        chain.sweep(rng)
    draws = chain.policies(rng)
    if ball.count() > 1:
        assert chi_square(ball, draws) > 1e-8


def test_a_chain_that_forgets_the_number_of_other_actions_is_noticed() -> None:
    rng = np.random.default_rng(0)
    center = rng.integers(3, size=5)
    ball = PolicySet(random_dynamics(rng, 5, 3, 4), center, 0.85)
    chain = BallChain(ball.dynamics, center, 0.85**2, chains=20_000)
    chain.n_actions = 2  # a state then joins with probability 1/2 instead of 2/3
    for _ in range(BURN_IN):
        chain.sweep(rng)
    chain.n_actions = 3
    assert chi_square(ball, chain.policies(rng)) < 1e-8


def test_one_sweep_keeps_a_uniform_set_uniform() -> None:
    """Stationarity, whatever the burn-in: exact draws stay exact draws."""
    rng = np.random.default_rng(3)
    center = rng.integers(3, size=5)
    ball = PolicySet(random_dynamics(rng, 5, 3, 4), center, 0.85)
    chain = BallChain(ball.dynamics, center, 0.85**2, chains=20_000)
    chain.disagree = ball.sample(20_000, rng) != center
    chain.sweep(rng)
    assert chi_square(ball, chain.policies(rng)) > 1e-8


@pytest.mark.parametrize("n_states", [36, 64])
def test_a_chain_finds_many_members_where_proposals_find_none(n_states: int) -> None:
    rng = np.random.default_rng(0)
    ball = PolicySet(random_dynamics(rng, n_states, 4, 10), rng.integers(4, size=n_states), 0.9)
    assert len(ball.rejection_sample(10_000, rng)) <= 1
    found = ball.chain_sample(300, rng).policies
    assert found.shape == (300, n_states)
    assert len(keys(found)) == 300
    assert ball.contains(found).all()
    np.testing.assert_array_equal(found[0], ball.center)


def test_a_chain_finds_the_whole_of_a_small_set() -> None:
    rng = np.random.default_rng(0)
    ball = PolicySet(random_dynamics(rng, 5, 3, 4), rng.integers(3, size=5), 0.7)
    assert keys(ball.chain_sample(1000, rng).policies) == keys(ball.enumerate())
    one = PolicySet(random_dynamics(rng, 5, 1, 4), np.zeros(5, dtype=np.int64), 1.0)
    np.testing.assert_array_equal(one.chain_sample(10, rng).policies, one.center[None])


def test_a_hopeless_chain_is_refused_in_time() -> None:
    rng = np.random.default_rng(0)
    ball = PolicySet(random_dynamics(rng, 300, 2, 200), np.zeros(300, dtype=np.int64), 0.9)
    with pytest.raises(InputError, match="shorten the horizon"):
        ball.chain_sample(10, rng)
