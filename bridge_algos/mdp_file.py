"""MDPs on disk: an ``.npz`` file of plain arrays, checked when it is read; nothing in it is executed."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from bridge_algos.conventions import AXES
from bridge_algos.envs.registry import make_mdp, mdp_names
from bridge_algos.files import atomic_write
from bridge_algos.mdp import TabularMDP
from bridge_algos.npz import read_arrays
from bridge_theory.errors import InputError

REQUIRED = ("transitions", "initial", "horizon", "reward")


def save_mdp(path: str | Path, mdp: TabularMDP) -> None:
    """Write an MDP, whole or not at all."""
    with atomic_write(Path(path)) as handle:
        np.savez_compressed(
            handle,
            transitions=mdp.transitions,
            initial=mdp.initial,
            horizon=np.array(mdp.horizon),
            reward=mdp.reward,
            state_names=np.array(mdp.state_names),
            action_names=np.array(mdp.action_names),
            axes=np.array(mdp.axes),
            reward_on=np.array(mdp.reward_on),
        )


def load_mdp(source: str | Path) -> TabularMDP:
    """The MDP of a built-in name or of an ``.npz`` file, as :func:`save_mdp` writes it or of one's own arrays.

    The file has the arrays ``transitions``, ``initial``, ``horizon`` and ``reward`` of :class:`TabularMDP`, and may
    have ``state_names``, ``action_names``, and ``axes`` and ``reward_on``, which are needed where the shapes leave open
    what is meant.

    Raises:
        InputError: when it is neither, or the file does not hold a valid MDP.

    >>> load_mdp("starmdp").n_states
    5
    """
    if str(source).lower() in mdp_names():
        return make_mdp(str(source))
    if not os.path.exists(source):
        if not str(source).endswith(".npz"):
            return make_mdp(str(source))  # says why there is none
        raise InputError(f"{source} is neither a file nor one of the environments {', '.join(mdp_names())}.")
    arrays = read_arrays(source, REQUIRED)
    names: dict[str, Any] = {
        key: tuple(arrays[key].ravel().tolist()) for key in ("state_names", "action_names") if key in arrays
    }
    horizon = arrays["horizon"]
    if horizon.shape != () or horizon.dtype.kind not in "iu":
        raise InputError(
            f"{source} has a horizon of shape {horizon.shape} of {horizon.dtype}, expected one whole number."
        )
    conventions: dict[str, Any] = {key: str(arrays[key][()]) for key in ("axes", "reward_on") if key in arrays}
    if not conventions and len(names) == 2:  # save_mdp wrote it before it named them: it always had these
        conventions = {"axes": AXES[0], "reward_on": "arrival" if arrays["reward"].ndim == 1 else ""}
        if arrays["reward"].ndim == 2:
            conventions["reward_on"] = "pair"
    return TabularMDP(
        transitions=arrays["transitions"],
        initial=arrays["initial"],
        horizon=int(horizon),
        reward=arrays["reward"],
        name=Path(source).stem,
        **names,
        **conventions,
    )
