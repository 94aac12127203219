"""Embeddings are what they say, the offline set is a ball, regrets are unclipped means of pairs with their errors."""

import numpy as np
import pytest

from bridge_algos.continuous.candidates import feature_ball, make_candidates
from bridge_algos.continuous.embeddings import embeddings_for, make_embedding
from bridge_algos.continuous.episodes import Episodes
from bridge_algos.continuous.features import Features
from bridge_algos.continuous.judging import regret_errors
from bridge_algos.continuous.policies import MlpPolicy
from bridge_theory.errors import InputError


def some_episodes(rng: np.random.Generator, d_s: int, d_a: int, n: int = 4, steps: int = 5) -> Episodes:
    observations = rng.normal(size=(n, steps + 1, d_s))
    actions = rng.normal(size=(n, steps, d_a)).astype(np.float32)
    lengths = np.array([steps, 1, 3, steps])
    over = np.arange(steps) >= lengths[:, None]
    actions[over] = 0
    return Episodes(observations, actions, rng.normal(size=(n, steps)), lengths, lengths < steps)


@pytest.mark.parametrize(("environment", "d_s", "d_a"), [("Reacher-v5", 10, 2), ("Ant-v5", 105, 8)])
def test_embeddings_equal_their_definitions(rng: np.random.Generator, environment: str, d_s: int, d_a: int) -> None:
    episodes = some_episodes(rng, d_s, d_a)
    horizon = episodes.horizon
    for name, function in embeddings_for(environment).items():
        values = function(episodes)
        for i in range(len(episodes)):
            length = int(episodes.lengths[i])
            s, a = episodes.observations[i, :length], episodes.actions[i, :length].astype(float)
            expected = {
                "average_state_action": np.concatenate([s.sum(axis=0), a.sum(axis=0)]) / horizon,
                "final_state": s[-1],
            }
            if name == "reacher_reward":
                expected[name] = np.array([(s[:, 8] ** 2 + s[:, 9] ** 2).sum(), (a**2).sum()]) / horizon
            if name == "ant_reward":
                terms = [length, s[:, 13].sum(), (a**2).sum(), 5e-4 * (s[:, 27:] ** 2).sum()]
                expected[name] = np.array(terms) / horizon
            np.testing.assert_allclose(values[i], expected[name], rtol=1e-12)


def test_normalisation_puts_demonstrations_into_the_unit_box(rng: np.random.Generator) -> None:
    episodes = some_episodes(rng, 10, 2)
    embedding = make_embedding("average_state_action", "Reacher-v5", episodes, normalise=True)
    assert np.abs(embedding(episodes)).max(axis=0) == pytest.approx(np.ones(12))
    plain = make_embedding("average_state_action", "Reacher-v5", episodes)
    np.testing.assert_allclose(embedding(episodes) * embedding.scale, plain(episodes))


def test_user_embeddings_are_checked(rng: np.random.Generator) -> None:
    episodes = some_episodes(rng, 10, 2)
    mine = make_embedding("mine", "Reacher-v5", episodes, user=lambda e: e.final_observations[:, :2])
    assert mine(episodes).shape == (4, 2)
    with pytest.raises(InputError, match="expected finite numbers of shape"):
        make_embedding("mine", "Reacher-v5", episodes, user=lambda e: e.returns)
    with pytest.raises(InputError, match="Reacher-v5 has no embedding 'ant_reward'"):
        make_embedding("ant_reward", "Reacher-v5", episodes)


def test_the_observed_bound_is_no_smaller_than_any_norm_seen(rng: np.random.Generator) -> None:
    sample = rng.normal(size=(6, 40, 3)) * np.array([1.0, 5.0, 0.1])
    features = Features(sample.mean(axis=1), sample.std(axis=1), np.abs(sample).max(axis=1), np.zeros((6, 40)))
    assert features.bound >= np.linalg.norm(sample, axis=2).max()
    scaled = features.scaled(np.array([2.0, 10.0, 1.0]))
    np.testing.assert_allclose(scaled.largest, np.abs(sample / np.array([2.0, 10.0, 1.0])).max(axis=1))


def clone_of(rng: np.random.Generator) -> MlpPolicy:
    return MlpPolicy((rng.normal(size=(3, 5)), rng.normal(size=(5, 2))), (np.zeros(5), np.zeros(2)))


def test_candidates_have_the_noise_they_should_and_no_expert_unless_asked(rng: np.random.Generator) -> None:
    clone = clone_of(rng)
    candidates = make_candidates(clone, rng, small=300, large=300, sigma=0.01, large_factor=5)
    assert len(candidates) == 601
    assert candidates[0] is clone
    assert candidates[7].digest() == candidates[7].digest()  # type: ignore[attr-defined]
    noise = np.array([candidates[i].parameters - clone.parameters for i in range(1, 601)])  # type: ignore[attr-defined]
    assert noise[:300].std() == pytest.approx(0.01, rel=0.05)
    assert noise[300:].std() == pytest.approx(0.05, rel=0.05)
    assert np.abs(np.corrcoef(noise[0], noise[1])[0, 1]) < 0.9
    with pytest.raises(IndexError):
        candidates[601]
    expert = clone_of(rng)
    assert make_candidates(clone, rng, small=1, large=1, expert=expert)[3] is expert


def test_the_offline_set_is_an_open_ball() -> None:
    features = np.array([[0.0, 0.0], [0.3, 0.4], [0.3, 0.39], [1.0, 0.0]])
    np.testing.assert_array_equal(feature_ball(features, features[0], 0.5), [True, False, True, False])
    with pytest.raises(InputError, match="radius of the offline set is 0"):
        feature_ball(features, features[0], 0.0)


def test_errors_of_cumulative_regret_do_not_average_out_over_rounds(rng: np.random.Generator) -> None:
    gaps = rng.normal(size=(3, 400)) + 1
    greedy = np.array([0, 0, 0, 0, 2])
    each, total = regret_errors(gaps, greedy)
    assert each[0] == pytest.approx(gaps[0].std(ddof=1) / 20)
    assert total[3] == pytest.approx(4 * each[0])
    by_hand = (4 * gaps[0] + gaps[2]).std(ddof=1) / 20
    assert total[4] == pytest.approx(by_hand)
