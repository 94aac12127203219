"""The clone is the maximum-likelihood Gaussian policy of its architecture, and depends on its generator alone."""

import numpy as np
import pytest

pytest.importorskip("torch", reason="cloning needs torch, of the extra 'continuous'")

from bridge_algos.continuous.cloning import clone, demonstrated_statistics, log_likelihood
from bridge_algos.continuous.episodes import Episodes
from bridge_theory.errors import InputError


def episodes(rng: np.random.Generator, n: int, d_s: int = 3, steps: int = 20, noise: float = 0.2) -> Episodes:
    """Actions that are a smooth function of the state plus noise; every other episode is shorter."""
    observations = rng.normal(size=(n, steps + 1, d_s))
    lengths = np.where(np.arange(n) % 2 == 0, steps, steps // 2)
    mean = np.stack([np.tanh(observations[:, :-1].sum(axis=2)), 0.5 * observations[:, :-1, 0]], axis=2)
    actions = (mean + noise * rng.normal(size=mean.shape)).astype(np.float32)
    after = np.arange(steps) >= lengths[:, None]
    actions[after] = 77.0
    observations[:, :-1][after] = 77.0
    return Episodes(observations, actions, np.zeros((n, steps)), lengths, np.zeros(n, dtype=bool))


def test_it_finds_the_mean_and_the_noise_and_ignores_what_follows_an_end(rng: np.random.Generator) -> None:
    fitted = clone(episodes(rng, 150), rng, hidden=12, epochs=40, validation=episodes(rng, 100))
    optimum = -2 * (np.log(0.2) + np.log(2 * np.pi) / 2 + 0.5)
    assert fitted.validation[-1] == pytest.approx(optimum, abs=0.15)
    np.testing.assert_allclose(fitted.policy.std, 0.2, rtol=0.1)
    assert fitted.likelihood[-1] > fitted.likelihood[0] + 1


def test_the_reported_likelihood_is_that_of_the_density(rng: np.random.Generator) -> None:
    scipy_stats = pytest.importorskip("scipy.stats")
    data = episodes(rng, 4)
    fitted = clone(data, rng, hidden=8, epochs=2)
    taken = data.mask
    states, actions = data.observations[:, :-1][taken], data.actions[taken].astype(float)
    expected = scipy_stats.norm.logpdf(actions, fitted.policy(states), fitted.policy.std).sum(axis=1).mean()
    assert fitted.likelihood[-1] == pytest.approx(expected, rel=1e-12)
    assert log_likelihood(fitted.policy, states, actions) == pytest.approx(expected, rel=1e-12)
    assert np.isnan(fitted.validation).all()


def test_numbers_depend_on_the_generator_and_not_on_torch() -> None:
    import torch

    data = episodes(np.random.default_rng(1), 6)
    before, results = torch.get_num_threads(), []
    try:
        for threads in (1, 2):
            torch.set_num_threads(threads)
            torch.manual_seed(threads)
            state = torch.random.get_rng_state()
            results.append(
                clone(
                    data, np.random.default_rng(7), hidden=16, epochs=3, statistics=demonstrated_statistics(data)
                ).policy
            )
            assert torch.equal(state, torch.random.get_rng_state())
            assert torch.get_num_threads() == threads
    finally:
        torch.set_num_threads(before)
    assert results[0].digest() == results[1].digest()
    other = clone(data, np.random.default_rng(8), hidden=16, epochs=3, statistics=demonstrated_statistics(data)).policy
    assert other.digest() != results[0].digest()


def test_normalisation_uses_the_demonstrations_alone(rng: np.random.Generator) -> None:
    data = episodes(rng, 6)
    statistics, validation = demonstrated_statistics(data), episodes(rng, 6, noise=9.0)
    policy = clone(data, rng, hidden=8, epochs=1, statistics=statistics, validation=validation).policy
    states = data.observations[:, :-1][data.mask]
    np.testing.assert_allclose(policy.observation_mean, states.mean(axis=0))
    np.testing.assert_allclose(policy.observation_scale, states.std(axis=0), rtol=1e-6)


def test_mistakes_get_a_sentence(rng: np.random.Generator) -> None:
    data = episodes(rng, 2)
    with pytest.raises(InputError, match="hidden is 0, expected a whole number of at least 1"):
        clone(data, rng, hidden=0)
    with pytest.raises(InputError, match="4-dimensional observations"):
        clone(data, rng, hidden=4, validation=episodes(rng, 2, d_s=4))
