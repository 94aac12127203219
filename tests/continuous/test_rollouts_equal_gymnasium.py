"""Batched rollouts are Gymnasium's own, bit by bit: observations, rewards, terminations, truncations, resets."""

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="rollouts need MuJoCo (the extra 'continuous')")
gymnasium = pytest.importorskip("gymnasium")

from networks import random_policy  # noqa: E402

from bridge_algos.continuous.environments import Environment, draw_starts, make_environment  # noqa: E402
from bridge_algos.continuous.episodes import Episodes  # noqa: E402
from bridge_algos.continuous.rollouts import rollout  # noqa: E402
from bridge_algos.continuous.starts import Starts  # noqa: E402


def replay_with_gymnasium(environment: Environment, starts: Starts, episodes: Episodes) -> int:
    """Send the same actions to ``gymnasium.make``; returns how many episodes it truncated."""
    env = gymnasium.make(environment.gymnasium_id)
    truncations = 0
    for i, length in enumerate(episodes.lengths):
        observation, _ = env.reset(seed=int(starts.seeds[i]))
        np.testing.assert_array_equal(observation, episodes.observations[i, 0])
        for h in range(length):
            observation, reward, terminated, truncated, _ = env.step(episodes.actions[i, h])
            np.testing.assert_array_equal(observation, episodes.observations[i, h + 1])
            assert reward == episodes.rewards[i, h]
            assert terminated == (episodes.terminated[i] and h + 1 == length)
            assert truncated == (h + 1 == environment.max_steps)
            truncations += truncated
        assert not episodes.observations[i, length + 1 :].any()
        assert not episodes.actions[i, length:].any()
        assert not episodes.rewards[i, length:].any()
    env.close()
    return truncations


def test_reacher_at_its_joint_limit_and_time_limit():
    environment = make_environment("reacher")
    reached = 0.0
    for seed, gain in ((0, 1.0), (1, 3.0)):
        starts = draw_starts(environment, 60, np.random.default_rng(seed))
        episodes = rollout(environment, random_policy(environment, seed, gain=gain), starts)
        assert replay_with_gymnasium(environment, starts, episodes) == 60
        second_joint = np.unwrap(np.arctan2(episodes.observations[:, :, 3], episodes.observations[:, :, 1]), axis=1)
        reached = max(reached, np.abs(second_joint).max())
    assert reached > 3.0, "no trajectory met the limit of the second joint, 3 rad"


def test_ant_falling_and_standing():
    environment = make_environment("ant")
    starts = draw_starts(environment, 60, np.random.default_rng(2))
    policy = random_policy(environment, 6, hidden=64, gain=2.0)
    episodes = rollout(environment, policy, starts, horizon=30, rng=np.random.default_rng(3))
    replay_with_gymnasium(environment, starts, episodes)
    assert 5 < episodes.terminated.sum() < 55, "expected some falls and some episodes without"
    assert (episodes.observations[:, :, 27:] != 0).any(), "no contact force was seen"


def test_ant_is_truncated_where_gymnasium_truncates_it():
    environment = make_environment("ant")
    starts = draw_starts(environment, 1, np.random.default_rng(4))
    episodes = rollout(environment, lambda seen: np.zeros((len(seen), 8)), starts)
    assert episodes.lengths.tolist() == [1000]
    assert replay_with_gymnasium(environment, starts, episodes) == 1


@pytest.mark.parametrize("name", ["Hopper-v5", "Walker2d-v5", "Pusher-v5"])
def test_other_environments_run_through_their_own_step(name):
    environment = make_environment(name)
    starts = draw_starts(environment, 4, np.random.default_rng(5))
    episodes = rollout(environment, random_policy(environment, 6), starts, horizon=30)
    replay_with_gymnasium(environment, starts, episodes)
