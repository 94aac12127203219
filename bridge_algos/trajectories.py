"""Trajectories: sampling them all at once, and keeping demonstrations on disk without pickles."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bridge_algos.files import atomic_write
from bridge_algos.given import RULES, checked
from bridge_algos.mdp import Dynamics, FloatArray, IntArray, TabularMDP, running_sums
from bridge_algos.npz import read_arrays
from bridge_algos.policies import action_probabilities
from bridge_algos.shapes import Policies
from bridge_theory.errors import InputError


@dataclass(frozen=True, eq=False)
class Trajectories:
    """n trajectories of H state-action pairs.

    Args:
        states: (n, H) integers s_1..s_H.
        actions: (n, H) integers a_1..a_H.
        rewards: (n, H) realised rewards of the H steps, or None where they were not observed.
    """

    states: IntArray
    actions: IntArray
    rewards: FloatArray | None = None

    def __len__(self) -> int:
        return int(self.states.shape[0])

    def __getitem__(self, part: slice) -> Trajectories:
        return Trajectories(self.states[part], self.actions[part], None if self.rewards is None else self.rewards[part])

    @property
    def horizon(self) -> int:
        return int(self.states.shape[1])

    def checked(self, n_states: int, n_actions: int, horizon: int | None = None) -> Trajectories:
        """Itself, after making sure that shapes and ranges fit an MDP; raises InputError otherwise."""
        for name, size in (("n_states", n_states), ("n_actions", n_actions), ("horizon", horizon)):
            if not (size is None and name == "horizon"):
                RULES[name](name, size)
        for name, array, count in (("states", self.states, n_states), ("actions", self.actions, n_actions)):
            if array.ndim != 2 or array.dtype.kind not in "iu":
                raise InputError(f"{name} has shape {array.shape} of {array.dtype}, expected integers of shape (n, H).")
            if array.size == 0:
                raise InputError(
                    f"{name} has shape {array.shape}: no data; expected at least one trajectory of one step."
                )
            if array.min() < 0 or array.max() >= count:
                raise InputError(
                    f"{name} holds values {array.min()}..{array.max()}, expected 0..{count - 1}; "
                    "are these demonstrations from another environment?"
                )
        if self.states.shape != self.actions.shape:
            raise InputError(f"states has shape {self.states.shape} but actions {self.actions.shape}; they must agree.")
        if horizon is not None and self.horizon != horizon:
            raise InputError(f"the trajectories have {self.horizon} steps, expected the MDP's horizon {horizon}.")
        if self.rewards is not None and self.rewards.shape != self.states.shape:
            raise InputError(f"rewards has shape {self.rewards.shape}, expected that of states, {self.states.shape}.")
        if self.rewards is not None and (self.rewards.dtype.kind not in "iuf" or not np.isfinite(self.rewards).all()):
            raise InputError(
                "rewards has an entry that is not a finite number; leave them out where not all are known."
            )
        return self


@checked
def sample_trajectories(mdp: TabularMDP, policy: ArrayLike, n: int, rng: np.random.Generator) -> Trajectories:
    """n independent trajectories of a policy in an MDP, with their realised rewards; vectorised over trajectories.

    Args:
        policy: any form that :func:`bridge_algos.policies.action_probabilities` takes.
        n: number of trajectories, at least 1.
        rng: the source of all randomness.
    """
    states, actions, arrivals = sample_paths(mdp.dynamics, policy, n, rng)
    return Trajectories(states, actions, mdp.realised_rewards(states, actions, arrivals))


@checked
def sample_paths(
    dynamics: Dynamics, policy: ArrayLike, n: int, rng: np.random.Generator
) -> tuple[IntArray, IntArray, IntArray]:
    """States s_1..s_H, actions a_1..a_H and arrivals s_2..s_{H+1}, each (n, H)."""
    horizon = dynamics.horizon
    probabilities = action_probabilities(policy, dynamics.n_states, dynamics.n_actions, horizon)
    deterministic = np.asarray(policy).dtype.kind in "iu"
    table = probabilities.argmax(axis=2) if deterministic else running_sums(probabilities)
    kernel = dynamics.cumulative
    states, actions, arrivals = (np.empty((n, horizon), dtype=np.int64) for _ in range(3))
    current = np.searchsorted(dynamics.cumulative_initial, rng.random(n), side="right")
    for h in range(horizon):
        states[:, h] = current
        actions[:, h] = table[h, current] if deterministic else _draw(table[h, current], rng)
        current = _draw(kernel[current, actions[:, h]], rng)
        arrivals[:, h] = current
    return states, actions, arrivals


def _draw(cumulative: FloatArray, rng: np.random.Generator) -> IntArray:
    return np.asarray((cumulative > rng.random(len(cumulative))[:, None]).argmax(axis=1))


@checked
def sample_each(mdp: TabularMDP, policies: Policies, n: int, rng: np.random.Generator) -> Trajectories:
    """n trajectories of each of M deterministic stationary policies, as one batch of M n, policy after policy.

    The same trajectories as from M calls of :func:`sample_trajectories` with the same generator, at half the cost in a
    round of the online loop.

    Args:
        policies: (M, S) integers, actions in range.
    """
    horizon, n_states, n_actions = mdp.horizon, mdp.n_states, mdp.n_actions
    laws = mdp.dynamics.cumulative.reshape(-1, n_states)
    chosen = (np.arange(n_states) * n_actions + policies).ravel()
    rows = n_states * np.arange(len(policies))[:, None]
    uniform = rng.random((len(policies), horizon + 1, n))
    pairs = np.empty((horizon, len(policies), n), dtype=np.int64)
    arrivals = np.empty_like(pairs)
    current = np.searchsorted(mdp.dynamics.cumulative_initial, uniform[:, 0], side="right")
    for h in range(horizon):
        pairs[h] = chosen.take(rows + current)
        arrivals[h] = current = (laws.take(pairs[h], axis=0) > uniform[:, h + 1, :, None]).argmax(axis=-1)
    visited, reached = (steps.reshape(horizon, -1).T for steps in (pairs, arrivals))
    states, actions = np.divmod(visited, n_actions)
    return Trajectories(states, actions, mdp.realised_rewards(states, actions, reached))


def save_trajectories(path: str | Path, trajectories: Trajectories) -> None:
    """Write trajectories to an ``.npz`` file, whole or not at all."""
    arrays: dict[str, Any] = {"states": trajectories.states, "actions": trajectories.actions}
    if trajectories.rewards is not None:
        arrays["rewards"] = trajectories.rewards
    with atomic_write(Path(path)) as handle:
        np.savez_compressed(handle, **arrays)


def load_trajectories(path: str | Path, n_states: int, n_actions: int, horizon: int | None = None) -> Trajectories:
    """Read trajectories from an ``.npz`` file and check them against an MDP; nothing in the file is executed.

    Raises:
        InputError: when the file is missing, is no ``.npz``, lacks an array or does not fit the MDP.
    """
    arrays = read_arrays(path, ("states", "actions"))
    read = Trajectories(arrays["states"], arrays["actions"], arrays.get("rewards"))
    read.checked(n_states, n_actions, horizon)
    # indices computed from small integers, such as one byte each, would overflow
    return Trajectories(read.states.astype(np.int64), read.actions.astype(np.int64), read.rewards)
