"""The same numbers whatever the number of threads, of other policies, or of further initial states."""

import tracemalloc
from collections.abc import Sequence

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="rollouts need MuJoCo (the extra 'continuous')")

from networks import random_policy

from bridge_algos.continuous.environments import draw_starts, make_environment
from bridge_algos.continuous.episodes import Episodes
from bridge_algos.continuous.rollouts import map_rollouts, rollout
from bridge_theory.errors import InputError

STEPS = {"reacher": 50, "ant": 25}


def everything(episodes: Episodes) -> np.ndarray:
    parts = (episodes.observations, episodes.actions, episodes.rewards)
    return np.column_stack([part.reshape(len(episodes), -1) for part in parts])


@pytest.fixture(params=STEPS)
def case(request):
    environment = make_environment(request.param)
    template = random_policy(environment, 0, hidden=64)
    noise = np.random.default_rng(1).normal(size=(3, len(template.parameters)))
    policies = [template.with_parameters(template.parameters + 0.1 * own) for own in noise]
    return environment, policies, draw_starts(environment, 70, np.random.default_rng(2)), STEPS[request.param]


@pytest.mark.parametrize("sampled", [False, True])
def test_threads(case, sampled):
    environment, policies, starts, horizon = case
    one, three = (
        map_rollouts(
            environment,
            policies,
            starts,
            everything,
            horizon=horizon,
            threads=threads,
            rng=np.random.default_rng(5) if sampled else None,
        )
        for threads in (1, 3)
    )
    np.testing.assert_array_equal(one, three)
    assert np.ptp(one, axis=(0, 1)).max() > 0


def test_other_policies_and_further_starts(case):
    environment, policies, starts, horizon = case
    whole = map_rollouts(environment, policies, starts, everything, horizon=horizon)
    part = map_rollouts(environment, [policies[2]], starts[:10], everything, horizon=horizon)
    np.testing.assert_array_equal(part[0], whole[2, :10])
    sampled = [
        rollout(environment, policies[0], starts[:n], horizon=steps, rng=np.random.default_rng(6))
        for n, steps in ((70, horizon), (10, horizon - 5))
    ]
    np.testing.assert_array_equal(sampled[1].actions, sampled[0].actions[:10, : horizon - 5])


def test_policies_may_start_from_their_own_states(case):
    environment, policies, starts, horizon = case
    own = [starts[:20], starts[30:50], starts[50:]]
    values = map_rollouts(environment, policies, own, everything, horizon=horizon)
    for index, part in enumerate(own):
        alone = map_rollouts(environment, [policies[index]], part, everything, horizon=horizon)
        np.testing.assert_array_equal(values[index], alone[0])
    for wrong in (own[:2], [*own[:2], starts[50:60]]):
        with pytest.raises(InputError, match="lists of initial states were given for 3 policies"):
            map_rollouts(environment, policies, wrong, everything, horizon=horizon)


def test_functions_see_the_episodes(case):
    environment, policies, starts, horizon = case
    mapped = map_rollouts(environment, policies, starts, everything, horizon=horizon)
    for values, policy in zip(mapped, policies, strict=True):
        np.testing.assert_array_equal(values, everything(rollout(environment, policy, starts, horizon=horizon)))


def test_actions_of_a_gaussian_policy_have_its_distribution():
    """Mean and deviation within six standard errors: false alarms less often than once in 10^8."""
    environment = make_environment("reacher")
    policy = random_policy(environment, 0, gain=0.1)
    policy = policy.with_parameters(0.1 * policy.parameters)
    starts = draw_starts(environment, 400, np.random.default_rng(0))
    episodes = rollout(environment, policy, starts, rng=np.random.default_rng(1))
    noise = (episodes.actions - policy(episodes.states.reshape(-1, 10)).reshape(400, 50, 2)) / policy.std
    inside = np.abs(episodes.actions) < 1
    assert inside.mean() > 0.99
    assert abs(noise.mean()) < 6 / np.sqrt(noise.size)
    assert abs(noise.var() - 1) < 6 * np.sqrt(2 / noise.size)


def test_memory_does_not_grow_with_the_number_of_policies():
    """A lazy sequence of policies, of which only the blocks under way are in memory."""
    environment = make_environment("reacher")
    starts = draw_starts(environment, 100, np.random.default_rng(0))
    template = random_policy(environment, 0)
    made: list[int] = []

    class Perturbed(Sequence):
        def __init__(self, count):
            self.count = count

        def __len__(self):
            return self.count

        def __getitem__(self, index):
            made.append(index)
            noise = np.random.default_rng(index).normal(size=template.parameters.shape)
            return template.with_parameters(template.parameters + 0.01 * noise)

    def last(episodes):
        return episodes.final_observations[:, :1]

    def peak(count):
        tracemalloc.start()
        map_rollouts(environment, Perturbed(count), starts, last, horizon=10, threads=2)
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    peak(4)
    assert made == [0, 1, 2, 3], "each policy is made once, when it is its turn"
    one_policy = 100 * 10 * (10 + 2 + 1) * 8
    assert peak(40) - peak(10) < 5 * one_policy, "30 more policies, if kept, would take 30 times that of one"
