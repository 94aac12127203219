"""Training improves the policy, gives the same one whatever the threads, and resumes when killed."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="training needs MuJoCo (the extra 'continuous')")
torch = pytest.importorskip("torch", reason="training needs torch (the extra 'continuous')")

from bridge_algos.continuous import ppo  # noqa: E402
from bridge_algos.continuous.environments import make_environment  # noqa: E402
from bridge_algos.continuous.expert_cards import evaluation  # noqa: E402
from bridge_theory.errors import InputError  # noqa: E402

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


def test_likelihoods_of_clipped_actions_are_a_distribution(reacher):
    """One dimension at a time: densities inside plus point masses at both ends make 1."""
    settings = replace(SHORT, initial_std=0.8)
    learner = ppo._fresh(reacher, settings, 0)
    learner.parameters[:] = np.random.default_rng(0).normal(size=learner.parameters.shape)
    networks = ppo._Networks(torch, reacher, settings, torch.from_numpy(learner.parameters))
    std = ppo._policy(reacher, settings, learner).std
    grid = torch.linspace(-1, 1, 20_001, dtype=torch.float64)
    inputs = torch.from_numpy(np.random.default_rng(1).normal(size=(1, 10)))
    actions = torch.stack([grid, torch.full_like(grid, 1.0)], dim=1)
    corner = torch.tensor([[-1.0, 1.0], [1.0, 1.0]], dtype=torch.float64)
    log_density = networks.log_likelihood(inputs.expand(len(grid), -1), actions)[1:-1].numpy()
    ends = np.exp(networks.log_likelihood(inputs.expand(2, -1), corner).numpy())
    # the second coordinate sits on its upper end throughout: all masses are multiples of its point mass
    inside = np.exp(log_density).sum() * 1e-4 / (np.sqrt(2 * np.pi))
    mean = networks._mlp(networks._policy, inputs).numpy()[0]
    from scipy.stats import norm

    point = norm.sf((1 - mean[1]) / std[1])
    np.testing.assert_allclose((inside + ends.sum()) / point, 1, atol=2e-4)


def test_advantages_are_those_of_the_definition():
    """GAE by its sum, on an episode that is cut, one that is terminated early, and one terminated at the end."""
    from bridge_algos.continuous.episodes import Episodes

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
