"""Demonstrations come back as they went, from .npz and Minari; foreign data is cut to the horizon or refused."""

import importlib.util
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="demonstrations need MuJoCo (the extra 'continuous')")
minari = pytest.importorskip("minari", reason="needs Minari (the extra 'continuous')")

from networks import random_policy  # noqa: E402

from bridge_algos.continuous.demonstrations import (  # noqa: E402
    episodes_from_minari,
    episodes_to_minari,
    load_demonstrations,
    save_minari_demonstrations,
)
from bridge_algos.continuous.environments import draw_starts, make_environment  # noqa: E402
from bridge_algos.continuous.episodes import Episodes, load_episodes, save_episodes  # noqa: E402
from bridge_algos.continuous.rollouts import rollout  # noqa: E402
from bridge_theory.errors import InputError  # noqa: E402

needs_storage = pytest.mark.skipif(importlib.util.find_spec("h5py") is None, reason="Minari's storage needs h5py")
FIELDS = ("observations", "actions", "rewards", "lengths", "terminated")


def assert_equal(left: Episodes, right: Episodes) -> None:
    for name in FIELDS:
        np.testing.assert_array_equal(getattr(left, name), getattr(right, name))
        assert getattr(left, name).dtype == getattr(right, name).dtype


@pytest.fixture(scope="module")
def ant():
    return make_environment("ant")


@pytest.fixture(scope="module")
def falls(ant):
    """Episodes of unequal length: some fall within 30 steps, some do not."""
    policy = random_policy(ant, 6, hidden=64, gain=2.0)
    episodes = rollout(ant, policy, draw_starts(ant, 12, np.random.default_rng(2)), horizon=30)
    assert 0 < episodes.terminated.sum() < 12
    return episodes


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    return tmp_path


def test_npz_files_come_back_as_they_went(ant, falls, tmp_path):
    save_episodes(tmp_path / "demos.npz", falls)
    assert_equal(load_demonstrations(tmp_path / "demos.npz", ant), falls)
    assert_equal(load_demonstrations(tmp_path / "demos.npz", ant, horizon=30), falls)
    assert [path.name for path in tmp_path.iterdir()] == ["demos.npz"]


@needs_storage
def test_minari_datasets_come_back_as_they_went(ant, falls, folder):
    dataset = save_minari_demonstrations("bridge/ant-v0", falls, ant, author="us")
    assert (dataset.total_episodes, dataset.total_steps) == (12, falls.lengths.sum())
    assert dataset.spec.env_spec.id == "Ant-v5"
    assert_equal(load_demonstrations("bridge/ant-v0", ant), falls)
    with pytest.raises(InputError, match="'bridge/ant-v0' exists already"):
        save_minari_demonstrations("bridge/ant-v0", falls, ant)
    with pytest.raises(InputError, match=r"observations of episode 0 have shape \(\d+, 105\), expected \(steps, 10\)"):
        load_demonstrations("bridge/ant-v0", make_environment("reacher"))


@needs_storage
def test_a_missing_dataset_is_named(ant, folder):
    with pytest.raises(InputError, match="'nowhere-v0' cannot be read"):
        load_demonstrations("nowhere-v0", ant)


def test_minari_episodes_end_as_gymnasium_ends_them(falls):
    for index, buffer in enumerate(episodes_to_minari(falls)):
        length = falls.lengths[index]
        assert (len(buffer.observations), len(buffer.actions), len(buffer.rewards)) == (length + 1, length, length)
        assert buffer.terminations[-1] == falls.terminated[index] != buffer.truncations[-1]
        assert not any(buffer.terminations[:-1] + buffer.truncations[:-1])


def test_longer_episodes_are_cut_to_the_horizon(falls):
    cut = falls.to_horizon(20)
    assert cut.horizon == 20
    np.testing.assert_array_equal(cut.lengths, np.minimum(falls.lengths, 20))
    np.testing.assert_array_equal(cut.terminated, falls.terminated & (falls.lengths <= 20))
    for index, length in enumerate(cut.lengths):
        np.testing.assert_array_equal(cut.observations[index, : length + 1], falls.observations[index, : length + 1])
        np.testing.assert_array_equal(cut.actions[index, :length], falls.actions[index, :length])
        assert not cut.observations[index, length + 1 :].any()
        assert not cut.rewards[index, length:].any()
    np.testing.assert_array_equal(cut.final_observations, falls.observations[np.arange(12), cut.lengths])


def test_only_terminated_episodes_may_be_shorter_than_the_horizon(falls):
    fallen = Episodes(*(getattr(falls, name)[falls.terminated] for name in FIELDS))
    longer = fallen.to_horizon(40)
    assert longer.horizon == 40
    assert_equal(longer.to_horizon(30), fallen)
    with pytest.raises(InputError, match=r"was cut after 30 steps, expected the horizon 40 or an end"):
        falls.to_horizon(40)


def test_masks_and_states_are_those_of_the_steps(falls):
    assert falls.mask.sum() == falls.lengths.sum()
    index = int(np.argmin(falls.lengths))
    length = falls.lengths[index]
    np.testing.assert_array_equal(falls.states[index, :length], falls.observations[index, :length])
    assert not falls.states[index, length:].any()
    assert falls.observations[index, length].any()
    np.testing.assert_allclose(falls.returns, [rewards.sum() for rewards in falls.rewards])


def test_checked_demonstrations_have_the_types_that_everything_reckons_with(ant, falls):
    single = replace(
        falls, observations=falls.observations.astype(np.float32), rewards=falls.rewards.astype(np.float32)
    )
    checked = single.checked(ant)
    assert checked.observations.dtype == checked.rewards.dtype == np.float64
    assert checked.actions.dtype == np.float32
    np.testing.assert_allclose(checked.observations, falls.observations, rtol=1e-6)


def test_demonstrations_that_do_not_fit_get_one_sentence(ant, falls, tmp_path):
    reacher = make_environment("reacher")
    cases = {
        r"actions have shape \(12, 30, 8\), expected \(n, H, 2\)": lambda: falls.checked(reacher),
        r"observations have shape \(12, 31, 9\), expected \(12, 31, 105\)": lambda: replace(
            falls, observations=falls.observations[:, :, :9]
        ).checked(ant),
        r"rewards have shape \(12, 29\)": lambda: replace(falls, rewards=falls.rewards[:, 1:]).checked(ant),
        r"lengths are not whole numbers from 1 to 30": lambda: replace(falls, lengths=falls.lengths * 0).checked(ant),
        r"observations \(float64\) hold values that are not finite": lambda: replace(
            falls, observations=falls.observations * np.nan
        ).checked(ant),
        r"observations \(complex128\) hold": lambda: replace(falls, observations=falls.observations * 1j).checked(ant),
        r"actions \(<U": lambda: replace(falls, actions=falls.actions.astype(str)).checked(ant),
        r"rewards \(float64\)": lambda: replace(falls, rewards=falls.rewards * np.nan).checked(ant),
        r"terminated has the type float64": lambda: replace(falls, terminated=falls.lengths * 1.0).checked(ant),
        r"actions go from .* expected the range of ant, -1 to 1": lambda: replace(
            falls, actions=3 * falls.actions
        ).checked(ant),
        r"expected \(n, H, 8\) with n, H >= 1": lambda: falls[:0].checked(ant),
        r"the data has no episode": lambda: episodes_from_minari([], ant),
        r"the horizon is 0, expected at least 1": lambda: falls.to_horizon(0),
        r"does not exist; give the path": lambda: load_episodes(tmp_path / "none.npz"),
    }
    for sentence, mistake in cases.items():
        with pytest.raises(InputError, match=sentence):
            mistake()


def test_minari_episodes_of_other_shapes_get_one_sentence(ant):
    buffer = minari.data_collector.EpisodeBuffer
    zeros = np.zeros((3, 105))
    cases = (
        (buffer(observations=[[1, 2], [3]], actions=[[0.0]], rewards=[0]), r"observations of episode 0 have shape"),
        (buffer(observations=zeros, actions=np.zeros((2, 3)), rewards=[0, 0]), r"actions of .* have shape \(2, 3\)"),
        (buffer(observations=zeros, actions=np.zeros((3, 8)), rewards=[0, 0, 0]), "3 observations, 3 actions"),
        (buffer(observations=zeros, actions=np.zeros((2, 8)), rewards=[0]), "2 actions and 1 rewards"),
    )
    for episode, sentence in cases:
        with pytest.raises(InputError, match=sentence):
            episodes_from_minari([episode], ant)
