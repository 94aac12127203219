"""Demonstrations of continuous control: from a file, or from a Minari dataset of an expert, a human or a robot."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from bridge_algos.continuous.environments import Environment
from bridge_algos.continuous.episodes import Episodes, load_episodes
from bridge_algos.envs.minari_io import read_dataset, require_minari, write_dataset
from bridge_theory.errors import InputError


def load_demonstrations(source: str | Path, environment: Environment, horizon: int | None = None) -> Episodes:
    """Demonstrations that fit an environment, from ``FILE.npz`` or the id of a local Minari dataset.

    Args:
        source: a path that ends in ``.npz``, or a Minari id such as "mujoco/reacher/expert-v0".
        environment: whose dimensions and action range they must have.
        horizon: longer episodes are cut to it; None keeps all steps.

    Raises:
        InputError: no such file or dataset, or one that does not fit.
    """
    if str(source).endswith(".npz"):
        episodes = load_episodes(source).checked(environment)
    else:
        _check_dataset_id(source)
        read = read_dataset(str(source), lambda dataset: episodes_from_minari(dataset, environment))
        episodes = read.checked(environment)
    return episodes if horizon is None else episodes.to_horizon(horizon)


def _check_dataset_id(source: str | Path) -> None:
    expected = "expected an .npz file, as 'bridge-rl expert demonstrate' writes, or the id of a local Minari dataset"
    if Path(source).is_file():
        raise InputError(f"{source} is a file of another kind, {expected} (whose own files are read by its id).")
    if not re.fullmatch(r"[\w./-]+-v\d+", str(source)):
        raise InputError(f"{source} is neither a file nor the id of a dataset (name-v0), {expected}.")


def save_minari_demonstrations(dataset_id: str, episodes: Episodes, environment: Environment, **metadata: Any) -> Any:
    """Write episodes as a Minari dataset into Minari's folder (environment variable ``MINARI_DATASETS_PATH``).

    Args:
        dataset_id: ``(namespace/)name-v0``, with a version; no dataset of that id may exist.
        episodes: checked against the environment.
        environment: recorded in the dataset, so that Minari can recover it.
        metadata: further arguments of ``minari.create_dataset_from_buffers``, such as ``author``.

    Returns:
        The ``minari.MinariDataset``.

    Raises:
        InputError: Minari or h5py is not installed, the id is malformed or taken, or the episodes do not fit.
    """
    episodes.checked(environment)
    defaults = {
        "description": f"Demonstrations in {environment.gymnasium_id}, cut after {episodes.horizon} steps.",
        "env": environment.gymnasium_id,
    }
    return write_dataset(dataset_id, lambda: episodes_to_minari(episodes), **(defaults | metadata))


def episodes_to_minari(episodes: Episodes) -> list[Any]:
    """One Minari ``EpisodeBuffer`` for each episode: L actions, L + 1 observations, terminated or truncated at L."""
    EpisodeBuffer = require_minari("minari").data_collector.EpisodeBuffer
    buffers = []
    for index, (length, ended) in enumerate(zip(episodes.lengths.tolist(), episodes.terminated.tolist(), strict=True)):
        last = [False] * (length - 1)
        buffers.append(
            EpisodeBuffer(
                id=index,
                observations=list(episodes.observations[index, : length + 1]),
                actions=list(episodes.actions[index, :length]),
                rewards=episodes.rewards[index, :length].tolist(),
                terminations=[*last, ended],
                truncations=[*last, not ended],
            )
        )
    return buffers


def episodes_from_minari(episodes: Iterable[Any], environment: Environment) -> Episodes:
    """Minari episodes (or a whole dataset) as arrays, padded with zeros to the longest.

    Raises:
        InputError: no episode, arrays of other dimensions, or observations that are not one more than the actions.
    """
    read = [_arrays(episode, index, environment) for index, episode in enumerate(episodes)]
    if not read:
        raise InputError("the data has no episode, expected at least one.")
    lengths = np.array([len(rewards) for _, _, rewards, _ in read])
    n, steps = len(read), int(lengths.max())
    padded = Episodes(
        np.zeros((n, steps + 1, environment.observation_size)),
        np.zeros((n, steps, environment.action_size), dtype=np.float32),
        np.zeros((n, steps)),
        lengths,
        np.array([ended for *_, ended in read]),
    )
    for index, (observations, actions, rewards, _) in enumerate(read):
        padded.observations[index, : len(observations)] = observations
        padded.actions[index, : len(actions)] = actions
        padded.rewards[index, : len(rewards)] = rewards
    return padded


def _arrays(episode: Any, index: int, environment: Environment) -> tuple[Any, Any, Any, bool]:
    parts = []
    for name, size in (("observations", environment.observation_size), ("actions", environment.action_size)):
        try:
            array = np.asarray(getattr(episode, name), dtype=np.float64)
        except (TypeError, ValueError):
            array = np.zeros(0)
        if array.ndim != 2 or array.shape[1] != size:
            raise InputError(
                f"{name} of episode {index} have shape {array.shape}, expected (steps, {size}), as {environment.name} "
                f"has {size}-dimensional {name}."
            )
        parts.append(array)
    observations, actions = parts
    rewards = np.asarray(episode.rewards, dtype=np.float64)
    if len(actions) == 0 or len(observations) != len(actions) + 1 or len(rewards) != len(actions):
        raise InputError(
            f"episode {index} has {len(observations)} observations, {len(actions)} actions and {len(rewards)} rewards, "
            "expected one observation more than actions, and a reward for each action."
        )
    return observations, actions, rewards, bool(episode.terminations[-1])
