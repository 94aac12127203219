"""Trajectories survive Minari's episodes and datasets unchanged; what does not fit is refused."""

import importlib.util
import subprocess
import sys

import numpy as np
import pytest

from bridge_algos.envs import star_mdp
from bridge_algos.envs.minari_io import (
    episodes_from_trajectories,
    load_minari_dataset,
    save_minari_dataset,
    trajectories_from_episodes,
)
from bridge_algos.trajectories import Trajectories, sample_paths, sample_trajectories
from bridge_theory.errors import InputError

minari = pytest.importorskip("minari")
needs_storage = pytest.mark.skipif(importlib.util.find_spec("h5py") is None, reason="Minari's storage needs h5py")
MDP = star_mdp()
UNIFORM = np.full((5, 4), 0.25)


@pytest.fixture
def trajectories() -> Trajectories:
    return sample_trajectories(MDP, UNIFORM, 6, np.random.default_rng(0))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    return tmp_path


def assert_equal(left: Trajectories, right: Trajectories) -> None:
    assert np.array_equal(left.states, right.states)
    assert np.array_equal(left.actions, right.actions)
    assert (left.rewards is None) == (right.rewards is None)
    assert left.rewards is None or np.array_equal(left.rewards, right.rewards)


def test_buffers_come_back_as_they_went(trajectories):
    buffers = episodes_from_trajectories(trajectories)
    assert all(isinstance(buffer, minari.data_collector.EpisodeBuffer) for buffer in buffers)
    assert_equal(trajectories_from_episodes(buffers, 5, 4, 8), trajectories)


def test_episodes_have_one_observation_more_and_end_by_truncation(trajectories):
    states, actions, arrivals = sample_paths(MDP.dynamics, UNIFORM, 3, np.random.default_rng(1))
    for final, expected in ((arrivals[:, -1], arrivals[:, -1]), (None, states[:, -1])):
        buffers = episodes_from_trajectories(Trajectories(states, actions), final)
        assert [len(buffer.observations) for buffer in buffers] == [9] * 3
        assert [buffer.observations[-1] for buffer in buffers] == expected.tolist()
        assert buffers[0].truncations == [False] * 7 + [True]
        assert not any(buffers[0].terminations)


def test_unobserved_rewards_stay_unobserved(trajectories):
    bare = Trajectories(trajectories.states, trajectories.actions)
    assert_equal(trajectories_from_episodes(episodes_from_trajectories(bare), 5, 4), bare)


@needs_storage
def test_datasets_come_back_as_they_went(trajectories, folder):
    dataset = save_minari_dataset("bridge/star-v0", trajectories, MDP, author="us")
    assert (dataset.total_episodes, dataset.total_steps) == (6, 48)
    assert (dataset.observation_space.n, dataset.action_space.n) == (5, 4)
    assert_equal(load_minari_dataset("bridge/star-v0", 5, 4, 8), trajectories)
    assert_equal(trajectories_from_episodes(minari.load_dataset("bridge/star-v0"), 5, 4), trajectories)
    with pytest.raises(InputError, match="'bridge/star-v0' exists already"):
        save_minari_dataset("bridge/star-v0", trajectories, MDP)


@needs_storage
def test_a_dataset_of_another_environment_is_refused(trajectories, folder):
    save_minari_dataset("star-v0", trajectories, MDP)
    with pytest.raises(InputError, match=r"actions holds values 0\.\.3, expected 0\.\.1"):
        load_minari_dataset("star-v0", 5, 2)


@needs_storage
def test_a_damaged_dataset_is_refused(trajectories, folder):
    save_minari_dataset("star-v0", trajectories, MDP)
    data = folder / "star-v0" / "data" / "main_data.hdf5"
    data.write_bytes(data.read_bytes()[:500])
    with pytest.raises(InputError, match="'star-v0' cannot be read"):
        load_minari_dataset("star-v0", 5, 4)


@pytest.mark.parametrize("identifier", ["star", "star v0", "star-v"])
def test_a_malformed_id_leaves_nothing_behind(identifier, trajectories, folder, monkeypatch):
    monkeypatch.setattr("bridge_algos.envs.minari_io.require_minari", lambda name: minari)
    with pytest.raises(InputError, match="expected '\\(namespace/\\)name-v0' with a version number"):
        save_minari_dataset(identifier, trajectories, MDP)
    assert list(folder.iterdir()) == []


def test_a_missing_dataset_is_named(folder):
    with pytest.raises(InputError, match="'nowhere-v0' cannot be read"):
        load_minari_dataset("nowhere-v0", 5, 4)


def _episode(observations, actions, rewards):
    return minari.data_collector.EpisodeBuffer(observations=observations, actions=actions, rewards=rewards)


@pytest.mark.parametrize(
    ("episodes", "sentence"),
    [
        ([], "the data has no episode, expected episodes of one length H"),
        ([_episode([0, 1], [0], [1.0]), _episode([0, 1, 1], [0, 1], [1.0, 0.0])], "episodes of 1 to 2 steps"),
        ([_episode([0], [0], [1.0])], "episode 0 has 1 observations, 1 actions and 1 rewards"),
        ([_episode([0.5, 1.0], [0], [1.0])], "observations of episode 0 have shape (2,) of float64"),
        ([_episode([0, 1], [[0], [1]], [1.0])], "actions of episode 0 have shape (2, 1)"),
        ([_episode([[0, 1], [1]], [0], [1.0])], "expected a list of whole numbers"),
        ([_episode([7, 1], [0], [1.0])], "states holds values 7..7, expected 0..4"),
    ],
)
def test_episodes_that_are_no_trajectories_get_one_sentence(episodes, sentence):
    with pytest.raises(InputError) as caught:
        trajectories_from_episodes(episodes, 5, 4)
    assert sentence in str(caught.value)


def test_the_horizon_is_checked(trajectories):
    with pytest.raises(InputError, match="8 steps, expected the MDP's horizon 9"):
        trajectories_from_episodes(episodes_from_trajectories(trajectories), 5, 4, 9)


def test_final_states_of_another_shape_are_refused(trajectories):
    with pytest.raises(InputError, match=r"final_states has shape \(2,\)"):
        episodes_from_trajectories(trajectories, np.array([0, 1]))


@pytest.mark.parametrize("absent", ["minari", "h5py"])
def test_without_minari_one_sentence_says_what_to_install(absent, tmp_path):
    """In a fresh interpreter in which the package cannot be found."""
    code = f"""
import importlib.util, numpy as np
find = importlib.util.find_spec
importlib.util.find_spec = lambda name, *rest: None if name == {absent!r} else find(name, *rest)
from bridge_algos.envs import star_mdp
from bridge_algos.envs.minari_io import save_minari_dataset
from bridge_algos.trajectories import Trajectories
from bridge_theory.errors import InputError
zeros = np.zeros((1, 8), dtype=int)
try:
    save_minari_dataset("a-v0", Trajectories(zeros, zeros), star_mdp())
except InputError as error:
    assert "the package {absent!r}, which is not installed" in str(error), error
else:
    raise SystemExit("nothing was raised")
"""
    subprocess.run(
        [sys.executable, "-c", code], check=True, env={"MINARI_DATASETS_PATH": str(tmp_path), **_environment()}
    )
    assert list(tmp_path.iterdir()) == []


def _environment() -> dict[str, str]:
    import os

    return {name: value for name, value in os.environ.items() if name != "MINARI_DATASETS_PATH"}
