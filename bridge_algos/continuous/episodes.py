"""Episodes of continuous control: up to H steps each, kept on disk as plain arrays."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bridge_algos.files import atomic_write
from bridge_algos.mdp import FloatArray, IntArray
from bridge_algos.npz import read_arrays
from bridge_theory.errors import InputError

if TYPE_CHECKING:
    from bridge_algos.continuous.environments import Environment


@dataclass(frozen=True, eq=False)
class Episodes:
    """n episodes; episode i ends after ``lengths[i]`` <= H steps, and everything behind its end is zero.

    Args:
        observations: (n, H + 1, d_s); the first L precede the actions, the last one follows them.
        actions: (n, H, d_a) as they were sent to the environment.
        rewards: (n, H).
        lengths: (n,) steps L of each episode, from 1 to H.
        terminated: (n,) whether the environment ended it (a fall); otherwise it was cut.
    """

    observations: FloatArray
    actions: NDArray[np.float32]
    rewards: FloatArray
    lengths: IntArray
    terminated: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.lengths)

    def __getitem__(self, part: slice) -> Episodes:
        return Episodes(*(getattr(self, field.name)[part] for field in fields(self)))

    @property
    def horizon(self) -> int:
        return int(self.actions.shape[1])

    @property
    def mask(self) -> NDArray[np.bool_]:
        """(n, H): whether step h took place."""
        return np.asarray(np.arange(self.horizon) < self.lengths[:, None])

    @property
    def states(self) -> FloatArray:
        """(n, H, d_s): the observations that precede the actions."""
        return np.where(self.mask[:, :, None], self.observations[:, :-1], 0.0)

    @property
    def final_observations(self) -> FloatArray:
        """(n, d_s): the observation after the last action."""
        return np.asarray(self.observations[np.arange(len(self)), self.lengths])

    @property
    def returns(self) -> FloatArray:
        """(n,): sums of rewards."""
        return np.asarray(self.rewards.sum(axis=1))

    def checked(self, environment: Environment) -> Episodes:
        """The episodes in the types above, after making sure that they fit an environment.

        Raises:
            InputError: no episode, other dimensions, actions out of range, lengths that do not fit, or values that are
                no finite numbers.
        """
        d_s, d_a = environment.observation_size, environment.action_size
        if self.actions.ndim != 3 or self.actions.shape[2] != d_a or self.actions.size == 0:
            raise InputError(
                f"actions have shape {self.actions.shape}, expected (n, H, {d_a}) with n, H >= 1, as "
                f"{environment.name} has {d_a}-dimensional actions."
            )
        n, steps, _ = self.actions.shape
        expected = {"observations": (n, steps + 1, d_s), "rewards": (n, steps), "lengths": (n,), "terminated": (n,)}
        for name, shape in expected.items():
            if np.shape(getattr(self, name)) != shape:
                raise InputError(
                    f"{name} have shape {np.shape(getattr(self, name))}, expected {shape}, as {environment.name} has "
                    f"{d_s}-dimensional observations and the actions are of {n} episodes of up to {steps} steps."
                )
        if self.lengths.dtype.kind not in "iu" or self.lengths.min() < 1 or self.lengths.max() > steps:
            raise InputError(f"lengths are not whole numbers from 1 to {steps}, the number of steps of the actions.")
        for name in ("observations", "actions", "rewards"):
            values = getattr(self, name)
            if values.dtype.kind not in "iuf" or not np.isfinite(values).all():
                raise InputError(f"{name} ({values.dtype}) hold values that are not finite; expected real numbers.")
        if self.terminated.dtype.kind != "b":
            raise InputError(f"terminated has the type {self.terminated.dtype}, expected true or false.")
        low, high = environment.low, environment.high
        if (self.actions < low).any() or (self.actions > high).any():
            raise InputError(
                f"actions go from {self.actions.min():g} to {self.actions.max():g}, expected the range of "
                f"{environment.name}, {low.min():g} to {high.max():g}; clip or rescale them."
            )
        return Episodes(
            self.observations.astype(np.float64),
            self.actions.astype(np.float32),
            self.rewards.astype(np.float64),
            self.lengths.astype(np.int64),
            self.terminated,
        )

    def to_horizon(self, horizon: int) -> Episodes:
        """The first ``horizon`` steps: longer episodes are cut, and padded arrays of terminated ones made longer.

        Raises:
            InputError: an episode ends earlier without having been terminated.
        """
        if horizon < 1:
            raise InputError(f"the horizon is {horizon}, expected at least 1.")
        short = np.flatnonzero((self.lengths < horizon) & ~self.terminated)
        if len(short):
            raise InputError(
                f"episode {short[0]} was cut after {self.lengths[short[0]]} steps, expected the horizon {horizon} or "
                "an end by the environment; ask for a smaller horizon."
            )
        lengths = np.minimum(self.lengths, horizon)

        def fitted(array: Any, steps: int, last: FloatArray | IntArray) -> Any:
            padded = np.zeros((len(self), steps, *array.shape[2:]), dtype=array.dtype)
            kept = min(steps, array.shape[1])
            padded[:, :kept] = array[:, :kept]
            padded[np.arange(steps) >= last[:, None]] = 0
            return padded

        return Episodes(
            observations=fitted(self.observations, horizon + 1, lengths + 1),
            actions=fitted(self.actions, horizon, lengths),
            rewards=fitted(self.rewards, horizon, lengths),
            lengths=lengths,
            terminated=self.terminated & (self.lengths <= horizon),
        )


def episodes_digest(episodes: Episodes) -> str:
    """SHA-256 of the content, by which a run recognises its demonstrations."""
    content = hashlib.sha256()
    for part in fields(episodes):
        array = np.ascontiguousarray(getattr(episodes, part.name))
        content.update(f"{part.name} {array.shape} {array.dtype}".encode() + array.tobytes())
    return content.hexdigest()


def save_episodes(path: str | Path, episodes: Episodes) -> None:
    """Write the arrays to an ``.npz`` file, whole or not at all."""
    arrays: dict[str, Any] = {field.name: getattr(episodes, field.name) for field in fields(episodes)}
    with atomic_write(Path(path)) as handle:
        np.savez_compressed(handle, **arrays)


def load_episodes(path: str | Path) -> Episodes:
    """Read episodes that :func:`save_episodes` wrote; nothing in the file is executed.

    Raises:
        InputError: the file is missing, damaged, or lacks an array.
    """
    names = [field.name for field in fields(Episodes)]
    arrays = read_arrays(path, names)
    return Episodes(**{name: arrays[name] for name in names})
