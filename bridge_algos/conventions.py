"""Which number of an array of an MDP means what: the order of a kernel's axes, and what a reward is paid for.

A shape often tells: (5, 2, 5) can only be P[s, a, s']. Where it does not, as for (3, 3, 3), or for one reward a state,
the two readings are different problems, so that the reading has to be named.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

AXES = ("state-action", "action-state")
"""P[s, a, s'] and P[a, s, s']."""

REWARD_ON = ("arrival", "departure", "pair", "transition")
"""Of the state arrived at (S,), of the state acted in (S,), of the pair (S, A), of the transition (S, A, S)."""

_IN_A_FILE = "in an .npz file as an entry of that name"


def settled(
    kernel: NDArray[np.float64], reward: NDArray[np.float64], axes: str, reward_on: str
) -> tuple[NDArray[np.float64], NDArray[np.float64], str, list[str]]:
    """An MDP's arrays in the one convention used here: P[s, a, s'], and no reward on departure.

    Args:
        kernel: three axes, the last of them s'.
        reward: one to three axes.
        axes: one of ``AXES``, or empty where the shapes tell.
        reward_on: one of ``REWARD_ON``, or empty where the shapes tell.

    Returns:
        Kernel, reward, what the reward is on, and what is ambiguous or contradictory, one sentence a fault.
    """
    faults = _unknown("axes", axes, AXES) + _unknown("reward_on", reward_on, REWARD_ON)
    if faults:
        return kernel, reward, reward_on, faults
    if axes == "action-state":
        kernel = kernel.swapaxes(0, 1)
        reward = reward.swapaxes(0, 1) if reward.ndim == 3 else reward
    elif not axes and (_moves(kernel) or _moves(reward)):
        faults.append(
            f"transitions has shape {kernel.shape}, which fits P[s, a, s'] and P[a, s, s']; give axes='state-action' "
            f"for the first or axes='action-state' for the second ({_IN_A_FILE})."
        )
    if reward_on:
        expected = {"arrival": 1, "departure": 1, "pair": 2, "transition": 3}[reward_on]
        if reward.ndim != expected:
            faults.append(f"reward_on is {reward_on!r}, which needs {expected} axes, but reward has {reward.ndim}.")
    elif reward.ndim == 1 and _varies(reward):
        faults.append(
            f"reward has shape {reward.shape}, one number a state, which may be paid on arrival in a state or for "
            "acting in it; give reward_on='arrival' for the first or reward_on='departure' for the second "
            f"({_IN_A_FILE})."
        )
    elif reward.ndim == 2 and len(set(kernel.shape)) == 1 and _varies(reward):
        faults.append(
            f"reward has shape {reward.shape}, which fits r(s, a) and r(s, s') alike, for there are as many actions as "
            f"states; give reward_on='pair' for the first, or an array r[s, a, s'] for the second ({_IN_A_FILE})."
        )
    if reward_on == "departure" and not faults:
        reward, reward_on = np.repeat(reward[:, None], kernel.shape[1], axis=1), "pair"
    return kernel, reward, reward_on or {1: "arrival", 2: "pair"}.get(reward.ndim, "transition"), faults


def _unknown(name: str, value: str, known: tuple[str, ...]) -> list[str]:
    return [] if value in ("", *known) else [f"{name} is {value!r}, expected one of {', '.join(known)}."]


def _moves(array: NDArray[np.float64]) -> bool:
    """Whether an array with three equal axes is another one with its first two exchanged."""
    return array.ndim == 3 and len(set(array.shape)) == 1 and not np.array_equal(array, array.swapaxes(0, 1))


def _varies(array: NDArray[np.float64]) -> bool:
    return bool((array != array.flat[0]).any())
