"""Training improves the policy, gives the same one whatever the threads, and resumes when killed."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="training needs MuJoCo (the extra 'continuous')")

from bridge_algos.continuous import ppo
from bridge_algos.continuous.environments import make_environment
from bridge_algos.continuous.episodes import Episodes
from bridge_algos.continuous.expert_cards import evaluation
from bridge_algos.continuous.ppo_gradient import Batch, Networks
from bridge_theory.errors import InputError

SHORT = ppo.PpoSettings(horizon=20, episodes=60, iterations=4, hidden=8, epochs=2, minibatch=400)


@pytest.fixture(scope="module")
def reacher():
    return make_environment("reacher")


def test_a_killed_training_ends_with_the_same_policy(reacher, tmp_path, monkeypatch):
    whole = ppo.train(reacher, SHORT, 3, tmp_path / "whole.npz", threads=1)
    monkeypatch.setattr(ppo, "_CHECKPOINT_EVERY", 2)
    iterate, calls = ppo._iterate, []

    def killed(*arguments):
        calls.append(1)
        if len(calls) == 4:
            raise KeyboardInterrupt
        return iterate(*arguments)

    monkeypatch.setattr(ppo, "_iterate", killed)
    with pytest.raises(KeyboardInterrupt):
        ppo.train(reacher, SHORT, 3, tmp_path / "killed.npz", threads=3)
    again = ppo.train(reacher, SHORT, 3, tmp_path / "killed.npz", threads=2)
    assert len(calls) == 6, "expected the checkpoint after two iterations to be used"
    assert again.digest() == whole.digest()
    assert ppo.train(reacher, SHORT, 4, tmp_path / "other.npz").digest() != whole.digest()


def test_a_checkpoint_of_another_training_is_refused(reacher, tmp_path):
    short = replace(SHORT, iterations=1)
    ppo.train(reacher, short, 0, tmp_path / "c.npz")
    with pytest.raises(InputError, match="is of another training"):
        ppo.train(reacher, short, 1, tmp_path / "c.npz")


def test_training_improves_the_policy(reacher, tmp_path):
    """By many standard errors, in 12 iterations; at first by less noise in its actions."""
    settings = replace(ppo.PRESETS["reacher"], iterations=12)
    first = ppo._policy(reacher, settings, ppo._fresh(reacher, settings, 0))
    trained = ppo.train(reacher, settings, 0, tmp_path / "c.npz")
    before, after = (evaluation(reacher, policy, episodes=100, sampled=True) for policy in (first, trained))
    assert after["return"] > before["return"] + 6 * np.hypot(before["standard_error"], after["standard_error"])


@pytest.fixture
def networks():
    return Networks(3, 2, 5, np.array([-1.0, -0.4]), np.array([1.0, 0.6]))


def random_vector(networks, rng):
    return 0.5 * rng.normal(size=sum(int(np.prod(shape)) for shape in networks.shapes))


def test_likelihoods_of_clipped_actions_are_a_distribution(networks, rng):
    """Densities inside the range and point masses at its ends make one, in each coordinate."""
    vector = random_vector(networks, rng)
    state = rng.normal(size=(1, 3))
    grids, weights = [], []
    for low, high in zip(networks.low, networks.high, strict=True):
        cell = (high - low) / 400
        grids.append(np.r_[low, low + cell * (np.arange(400) + 0.5), high])
        weights.append(np.r_[1.0, np.full(400, cell), 1.0])
    pairs = np.stack(np.meshgrid(*grids, indexing="ij"), axis=-1).reshape(-1, 2)
    values = np.exp(networks.log_likelihoods(vector, np.repeat(state, len(pairs), axis=0), pairs)).reshape(402, 402)
    assert abs(weights[0] @ values @ weights[1] - 1) < 1e-4


def test_gradients_are_those_of_finite_differences(networks, rng):
    vector = random_vector(networks, rng)
    inputs, actions = rng.normal(size=(40, 3)), np.clip(rng.normal(size=(40, 2)), networks.low, networks.high)
    before = networks.log_likelihoods(vector, inputs, actions) + 0.3 * rng.normal(size=40)
    batch = Batch(inputs, actions, before, rng.normal(size=40), rng.normal(size=40))
    gains = (batch.advantages - batch.advantages.mean()) / (batch.advantages.std() + 1e-8)

    def loss(at):
        ratios = np.exp(networks.log_likelihoods(at, inputs, actions) - before)
        surrogate = np.minimum(ratios * gains, np.clip(ratios, 0.8, 1.2) * gains).mean()
        return 0.5 * np.square(networks.values(at, inputs) - batch.targets).mean() - surrogate

    steps = 1e-6 * np.eye(len(vector))
    expected = np.array([(loss(vector + step) - loss(vector - step)) / 2e-6 for step in steps])
    np.testing.assert_allclose(networks.gradient(vector, batch, 0.2), expected, rtol=1e-5, atol=1e-7)
    assert np.abs(expected).min() < 1e-3 < np.abs(expected).max()
    assert ((actions == networks.low) | (actions == networks.high)).any()


def test_advantages_are_those_of_the_definition():
    """GAE by its sum, on an episode that is cut, one that is terminated early, and one terminated at the end."""
    rng = np.random.default_rng(0)
    lengths, terminated = np.array([4, 2, 4]), np.array([False, True, True])
    rewards, values = rng.normal(size=(3, 4)), rng.normal(size=(3, 5))
    rewards[1, 2:] = 0
    episodes = Episodes(np.zeros((3, 5, 1)), np.zeros((3, 4, 1), dtype=np.float32), rewards, lengths, terminated)
    settings = replace(SHORT, discount=0.9, trace=0.8)
    found = ppo._advantages(episodes, rewards, values, settings)
    for i in range(3):
        after = [0.0 if terminated[i] and h + 1 == lengths[i] else values[i, h + 1] for h in range(lengths[i])]
        surprise = [rewards[i, h] + 0.9 * after[h] - values[i, h] for h in range(lengths[i])]
        for h in range(lengths[i]):
            expected = sum((0.9 * 0.8) ** (k - h) * surprise[k] for k in range(h, lengths[i]))
            assert abs(found[i, h] - expected) < 1e-12
    assert not found[1, 2:].any()
