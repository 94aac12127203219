"""Occupancies, features, costs, visits and returns equal sums over all trajectories, and agree with sampling."""

from fractions import Fraction

import numpy as np
import pytest
from conftest import random_dynamics

from bridge_algos.embeddings import (
    SampledEmbedding,
    expected_features,
    linear_embedding,
    make_embedding,
    sampled_features,
)
from bridge_algos.evaluation import expected_returns
from bridge_algos.hellinger_exact import trajectory_law
from bridge_algos.mdp import Dynamics, TabularMDP
from bridge_algos.occupancy import state_action_occupancies, total_occupancies, visit_probabilities
from bridge_algos.policies import all_policies
from bridge_algos.trajectories import Trajectories
from bridge_theory.errors import InputError

S, A, H = 3, 2, 4
EMBEDDINGS = ("identity_long", "identity_short", "state_counts", "final_state", "state_action_counts")


@pytest.fixture
def dynamics(rng: np.random.Generator) -> Dynamics:
    return random_dynamics(rng, S, A, H)


def law(dynamics: Dynamics, policy: np.ndarray) -> tuple[Trajectories, np.ndarray]:
    """All trajectories of a deterministic policy with their probabilities, by enumeration."""
    kernel = [[[Fraction(float(p)) for p in row] for row in rows] for rows in dynamics.transitions]
    chosen = [[Fraction(int(a == policy[s])) for a in range(A)] for s in range(S)]
    paths = trajectory_law([Fraction(float(p)) for p in dynamics.initial], H, kernel, chosen)
    array = np.array(list(paths)).reshape(len(paths), H, 2)
    return Trajectories(array[..., 0], array[..., 1]), np.array([float(p) for p in paths.values()])


def test_features_costs_and_visits_equal_enumeration(dynamics: Dynamics, rng: np.random.Generator) -> None:
    policies = all_policies(S, A)
    costs = rng.random((S, A))
    totals = total_occupancies(dynamics, policies, H - 1)
    visits = visit_probabilities(dynamics, policies)
    for name in EMBEDDINGS:
        embedding = make_embedding(name, S, A, H)
        features, cost = expected_features(dynamics, policies, embedding, costs, H - 1)
        for i, policy in enumerate(policies):
            paths, mass = law(dynamics, policy)
            np.testing.assert_allclose(features[i], mass @ embedding.of_trajectories(paths), atol=1e-12)
            assert cost[i] == pytest.approx(
                mass @ costs[paths.states, paths.actions][:, : H - 1].sum(axis=1), abs=1e-12
            )
            seen = (paths.states[:, :, None] == np.arange(S)).any(axis=1)
            np.testing.assert_allclose(visits[i], mass @ seen, atol=1e-12)
            counted = (paths.states[:, : H - 1, None] == np.arange(S)).sum(axis=1)
            np.testing.assert_allclose(totals[i], mass @ counted, atol=1e-12)


def test_returns_equal_occupancies_times_rewards(dynamics: Dynamics, rng: np.random.Generator) -> None:
    mdp = TabularMDP(dynamics.transitions, dynamics.initial, H, rng.normal(size=(S, A, S)))
    policies = all_policies(S, A)
    by_occupancy = [(state_action_occupancies(dynamics, p) * mdp.expected_reward).sum() for p in policies]
    np.testing.assert_allclose(expected_returns(mdp, policies), by_occupancy, atol=1e-12)


def test_embedding_bounds_are_reached_or_respected() -> None:
    stay = Trajectories(np.zeros((1, H), dtype=np.int64), np.zeros((1, H), dtype=np.int64))
    for name in EMBEDDINGS:
        embedding = make_embedding(name, S, A, H)
        features = embedding.of_trajectories(stay)
        assert features.shape == (1, embedding.dimension)
        assert np.linalg.norm(features) == pytest.approx(embedding.bound, rel=1e-12)


def test_a_users_linear_embedding_is_exact_and_bounded(dynamics: Dynamics, rng: np.random.Generator) -> None:
    embedding = linear_embedding("mine", rng.normal(size=(H, S, A, 5)))
    policies = all_policies(S, A)
    features, _ = expected_features(dynamics, policies, embedding)
    for i, policy in enumerate(policies):
        paths, mass = law(dynamics, policy)
        values = embedding.of_trajectories(paths)
        np.testing.assert_allclose(features[i], mass @ values, atol=1e-12)
        assert np.linalg.norm(values, axis=1).max() <= embedding.bound
    with pytest.raises(InputError, match="shape"):
        linear_embedding("mine", np.zeros((2, 2)))


def test_sampled_features_agree_within_their_error(dynamics: Dynamics, rng: np.random.Generator) -> None:
    policies = all_policies(S, A)
    embedding = make_embedding("identity_short", S, A, H)
    exact, cost = expected_features(dynamics, policies, embedding, np.ones((S, A)), H)
    sample = sampled_features(dynamics, policies, embedding, 4000, rng, np.ones((S, A)), H)
    # Hoeffding: a coordinate in [0, H] is off by more than t with probability at most 2 exp(-2 n t^2 / H^2); with
    # n = 4000, t = 0.2 and 40 coordinates that is below 1e-6.
    assert 40 * 2 * np.exp(-2 * 4000 * 0.2**2 / H**2) < 1e-6
    assert np.abs(sample.means - exact).max() < 0.2
    np.testing.assert_allclose(sample.costs, cost, atol=1e-12)
    assert 0 < sample.standard_errors.max() < 0.05


def test_a_function_of_the_whole_trajectory_is_sampled_with_its_error(dynamics: Dynamics, rng) -> None:
    returns_home = SampledEmbedding(
        "ends where it began", 1, 1.0, lambda t: (t.states[:, :1] == t.states[:, -1:]) * 1.0
    )
    policy = np.zeros((1, S), dtype=np.int64)
    paths, mass = law(dynamics, policy[0])
    truth = float(mass @ returns_home.of_trajectories(paths)[:, 0])
    sample = sampled_features(dynamics, policy, returns_home, 4000, rng)
    assert abs(sample.means[0, 0] - truth) < np.sqrt(np.log(2 / 1e-7) / 8000)  # Hoeffding at 1e-7
    with pytest.raises(InputError, match="rollouts"):
        sampled_features(dynamics, policy, returns_home, 1, rng)


def test_wrong_shapes_and_unknown_names_are_refused(dynamics: Dynamics) -> None:
    with pytest.raises(InputError, match="policies"):
        total_occupancies(dynamics, np.zeros((2, S + 1), dtype=np.int64))
    with pytest.raises(InputError, match="expected one of identity_long"):
        make_embedding("identity", S, A, H)


@pytest.mark.parametrize("name", EMBEDDINGS)
def test_built_in_features_are_nonnegative_so_that_two_differ_by_at_most_sqrt_two_bounds(name: str) -> None:
    # what kappa_nonnegative assumes; every trajectory of the smallest problem with two states and actions
    embedding = make_embedding(name, 2, 2, 3)
    paths = np.array(list(np.ndindex(*(2,) * 6))).reshape(-1, 3, 2)
    features = embedding.of_trajectories(Trajectories(paths[..., 0], paths[..., 1]))
    assert features.min() == 0
    distances = np.linalg.norm(features[:, None] - features[None], axis=2)
    assert distances.max() <= np.sqrt(2) * embedding.bound * (1 + 1e-12)


def test_features_of_the_users_may_differ_by_twice_their_bound() -> None:
    weights = np.zeros((1, 2, 2, 1))
    weights[0, 0], weights[0, 1] = 1, -1
    embedding = linear_embedding("opposite", weights)
    features = embedding.of_trajectories(Trajectories(np.array([[0], [1]]), np.array([[0], [0]])))
    assert np.ptp(features) == 2 * embedding.bound  # so that kappa_nonnegative would be too small
