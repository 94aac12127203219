"""Trajectories as Minari episodes and datasets, and back."""

from __future__ import annotations

import importlib
import importlib.util
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from bridge_algos.demonstrations import excluded
from bridge_algos.mdp import TabularMDP
from bridge_algos.trajectories import Trajectories
from bridge_theory.errors import InputError

Read = TypeVar("Read")

# Minari asks for a web address, an author and an evaluation environment, which demonstrations need not have.
_MISSING_METADATA = r"(`(code_permalink|author|author_email|algorithm_name|eval_env)` is set to None|env_spec is None)"


def episodes_from_trajectories(trajectories: Trajectories, final_states: ArrayLike | None = None) -> list[Any]:
    """One Minari ``EpisodeBuffer`` for each trajectory: H actions and rewards, H + 1 observations, truncated at H.

    Args:
        trajectories: n trajectories. Unobserved rewards become nan, so that none is made up.
        final_states: (n,) the states s_{H+1} after the last action, which trajectories do not hold but Minari's
            episodes do. When None, the last observation repeats s_H.

    Raises:
        InputError: Minari is not installed, or ``final_states`` has another shape.
    """
    EpisodeBuffer = require_minari("minari").data_collector.EpisodeBuffer
    n, horizon = trajectories.states.shape
    final = np.asarray(trajectories.states[:, -1] if final_states is None else final_states)
    if final.shape != (n,) or final.dtype.kind not in "iu":
        raise InputError(f"final_states has shape {final.shape} of {final.dtype}, expected integers of shape ({n},).")
    observations = np.column_stack([trajectories.states, final])
    rewards = np.full((n, horizon), np.nan) if trajectories.rewards is None else trajectories.rewards
    truncations = [False] * (horizon - 1) + [True]
    return [
        EpisodeBuffer(
            id=index,
            observations=observations[index].tolist(),
            actions=trajectories.actions[index].tolist(),
            rewards=rewards[index].tolist(),
            terminations=[False] * horizon,
            truncations=list(truncations),
        )
        for index in range(n)
    ]


def trajectories_from_episodes(
    episodes: Iterable[Any], n_states: int, n_actions: int, horizon: int | None = None
) -> Trajectories:
    """Minari episodes (``EpisodeData``, ``EpisodeBuffer`` or a whole dataset) as trajectories, checked against an MDP.

    The last observation of each episode is dropped, as a trajectory ends with its last action. Rewards that are nan
    throughout mean "not observed".

    Raises:
        InputError: no episode, observations or actions that are not whole numbers, episodes of unequal length, or
            values or lengths that do not fit the MDP.
    """
    states, actions, rewards = [], [], []
    for index, episode in enumerate(episodes):
        observed, chosen = (
            _integers(episode.observations, "observations", index),
            _integers(episode.actions, "actions", index),
        )
        if len(observed) != len(chosen) + 1 or len(episode.rewards) != len(chosen):
            raise InputError(
                f"episode {index} has {len(observed)} observations, {len(chosen)} actions and {len(episode.rewards)} "
                "rewards, expected one observation more than actions, and a reward for each action."
            )
        states.append(observed[:-1])
        actions.append(chosen)
        rewards.append(np.asarray(episode.rewards, dtype=np.float64))
    lengths = sorted({len(row) for row in actions})
    if len(lengths) != 1:
        found = f"episodes of {lengths[0]} to {lengths[-1]} steps" if lengths else "no episode"
        raise InputError(
            f"the data has {found}, expected episodes of one length H; let terminated episodes run on in an absorbing "
            "state (as the MDP of mdp_from_gymnasium does) and cut longer ones."
        )
    pay = np.stack(rewards)
    observed_rewards = None if np.isnan(pay).all() else pay
    return Trajectories(np.stack(states), np.stack(actions), observed_rewards).checked(n_states, n_actions, horizon)


def save_minari_dataset(
    dataset_id: str,
    trajectories: Trajectories,
    mdp: TabularMDP,
    final_states: ArrayLike | None = None,
    **metadata: Any,
) -> Any:
    """Write trajectories as a Minari dataset into Minari's folder (environment variable ``MINARI_DATASETS_PATH``).

    Args:
        dataset_id: ``(namespace/)name-v0``, with a version; no dataset of that id may exist.
        trajectories: checked against the MDP.
        mdp: gives the spaces, ``Discrete(S)`` and ``Discrete(A)``, and the description, which says where the
            trajectories are none that it can produce.
        final_states: as in :func:`episodes_from_trajectories`.
        metadata: further arguments of ``minari.create_dataset_from_buffers``, such as ``author`` or ``code_permalink``.

    Returns:
        The ``minari.MinariDataset``.

    Raises:
        InputError: Minari or h5py is not installed, the id is malformed or taken, or the trajectories do not fit.
    """
    from gymnasium.spaces import Discrete

    trajectories.checked(mdp.n_states, mdp.n_actions, mdp.horizon)
    fault = excluded(mdp, trajectories)
    kind = f"Trajectories of {mdp.name}" if fault is None else f"Trajectories that {mdp.name} excludes ({fault})"
    last = "repeats s_H" if final_states is None else "is the state after the last action"
    defaults = {
        "description": f"{kind}; the last observation of an episode {last}.",
        "observation_space": Discrete(mdp.n_states),
        "action_space": Discrete(mdp.n_actions),
    }
    return write_dataset(
        dataset_id, lambda: episodes_from_trajectories(trajectories, final_states), **(defaults | metadata)
    )


def write_dataset(dataset_id: str, episodes: Callable[[], list[Any]], **arguments: Any) -> Any:
    """Create a Minari dataset of episode buffers, made once the id is known to be free; other arguments are Minari's.

    Raises:
        InputError: Minari or h5py is not installed, or the id is malformed or taken.
    """
    minari = require_minari("minari")
    if arguments.get("data_format", "hdf5") == "hdf5":
        require_minari("h5py")
    from minari.dataset.minari_dataset import DATASET_ID_RE
    from minari.storage.datasets_root_dir import get_dataset_path

    match = DATASET_ID_RE.fullmatch(dataset_id)
    if match is None or match.group("version") is None:
        raise InputError(f"the dataset id is {dataset_id!r}, expected '(namespace/)name-v0' with a version number.")
    if Path(get_dataset_path(dataset_id)).exists():
        raise InputError(f"a Minari dataset {dataset_id!r} exists already; choose another name or version.")
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=_MISSING_METADATA, category=UserWarning)
        return minari.create_dataset_from_buffers(dataset_id, episodes(), **arguments)


def load_minari_dataset(dataset_id: str, n_states: int, n_actions: int, horizon: int | None = None) -> Trajectories:
    """Read a local Minari dataset as trajectories, checked against an MDP; nothing is downloaded.

    Raises:
        InputError: Minari or h5py is not installed, there is no such dataset, or it does not fit the MDP.
    """
    return read_dataset(dataset_id, lambda dataset: trajectories_from_episodes(dataset, n_states, n_actions, horizon))


def read_dataset(dataset_id: str, convert: Callable[[Any], Read]) -> Read:
    """What ``convert`` makes of a local Minari dataset; nothing is downloaded.

    Raises:
        InputError: Minari or h5py is not installed, or there is no such dataset.
    """
    minari = require_minari("minari")
    try:
        return convert(minari.load_dataset(dataset_id))
    except InputError:
        raise
    except ImportError as error:
        raise InputError(f"the Minari dataset {dataset_id!r} needs another package ({error}).") from None
    except (OSError, KeyError, ValueError, AssertionError) as error:
        raise InputError(f"the Minari dataset {dataset_id!r} cannot be read ({error}); download or save it.") from None


def _integers(values: Any, name: str, index: int) -> np.ndarray[Any, np.dtype[np.int64]]:
    try:
        array = np.asarray(values)
    except ValueError:
        array = np.empty((0, 0))
    if array.ndim != 1 or array.dtype.kind not in "iu":
        raise InputError(
            f"{name} of episode {index} have shape {array.shape} of {array.dtype}, expected a list of whole numbers."
        )
    return array.astype(np.int64)


def require_minari(name: str) -> Any:
    """Import ``minari`` or a package that it needs, or say in a sentence what to install."""
    if importlib.util.find_spec(name) is None:
        raise InputError(
            f"Minari datasets need the package {name!r}, which is not installed; pip install 'bridge-rl[continuous]'."
        )
    return importlib.import_module(name)
