"""MuJoCo environments of Gymnasium, stepped many at a time with Gymnasium's own numbers.

An environment gives *blocks*: a fixed number of simulations that one thread steps together. Reacher-v5 and Ant-v5 have
blocks of their own, equal to ``gymnasium.make(...)`` bit by bit; any other MuJoCo environment is stepped through its
``step`` (slower).
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from bridge_algos.continuous.ant import AntBlock
from bridge_algos.continuous.gymnasium_block import GymnasiumBlock
from bridge_algos.continuous.needs import need
from bridge_algos.continuous.reacher import ReacherBlock
from bridge_algos.continuous.starts import Starts
from bridge_algos.envs.gymnasium_ids import why_not_mujoco
from bridge_algos.mdp import FloatArray, IntArray
from bridge_theory.errors import InputError

SHORT_NAMES = {"reacher": "Reacher-v5", "ant": "Ant-v5"}
_BLOCKS: dict[str, type[ReacherBlock] | type[AntBlock]] = {"Reacher-v5": ReacherBlock, "Ant-v5": AntBlock}


class Block(Protocol):
    """Simulations of one environment, numbered 0, 1, ...; ``rows`` are ascending numbers of some of them."""

    def reset(self, starts: Starts, rows: IntArray) -> FloatArray:
        """Put start i into simulation ``rows[i]``; returns the (m, d_s) observations."""

    def step(self, actions: NDArray[np.float32], rows: IntArray) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
        """One step of the simulations ``rows`` under (m, d_a) actions: observations, rewards, terminated."""


@dataclass(frozen=True, eq=False)
class Environment:
    """A Gymnasium MuJoCo environment for batched rollouts; made by :func:`make_environment`.

    Args:
        name: short name where there is one ("reacher"), else the Gymnasium id.
        gymnasium_id: such as "Reacher-v5".
        reference: one ``gymnasium`` environment without wrappers, which draws the initial states.
        max_steps: H after which Gymnasium truncates.
        new_block: makes a block of the given number of simulations.
    """

    name: str
    gymnasium_id: str
    reference: Any
    max_steps: int
    new_block: Callable[[int], Block]

    @property
    def observation_size(self) -> int:
        return int(self.reference.observation_space.shape[0])

    @property
    def action_size(self) -> int:
        return int(self.reference.action_space.shape[0])

    @property
    def low(self) -> NDArray[np.float32]:
        """Least action, (d_a,)."""
        return np.asarray(self.reference.action_space.low)

    @property
    def high(self) -> NDArray[np.float32]:
        """Greatest action, (d_a,)."""
        return np.asarray(self.reference.action_space.high)


def make_environment(name: str) -> Environment:
    """The environment of a short name ("reacher", "ant") or of any Gymnasium id of a MuJoCo environment.

    Raises:
        InputError: there is no such MuJoCo environment, or MuJoCo is not installed.
    """
    gymnasium_id = SHORT_NAMES.get(name.lower(), name)
    expected = f"expected one of {', '.join(SHORT_NAMES)} or the id of a MuJoCo environment of Gymnasium"
    if problem := why_not_mujoco(gymnasium_id):
        raise InputError(f"{problem}; {expected}.")
    need("mujoco")
    gymnasium = need("gymnasium")
    mujoco_env = need("gymnasium.envs.mujoco").MujocoEnv
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # an older version of an environment was asked for
            reference = gymnasium.make(gymnasium_id)
    except (gymnasium.error.Error, ImportError) as error:
        raise InputError(f"Gymnasium cannot make {name!r} ({error}); {expected}.") from None
    if not isinstance(reference.unwrapped, mujoco_env):
        raise InputError(f"{name!r} is not simulated by MuJoCo; {expected}.")
    if reference.spec.max_episode_steps is None:
        raise InputError(f"{name!r} has no largest number of steps; register it with max_episode_steps.")
    short = next((key for key, value in SHORT_NAMES.items() if value == gymnasium_id), gymnasium_id)
    raw = reference.unwrapped
    block = _BLOCKS.get(gymnasium_id)
    return Environment(
        name=short,
        gymnasium_id=gymnasium_id,
        reference=raw,
        max_steps=int(reference.spec.max_episode_steps),
        new_block=(lambda size: block(raw, size)) if block else lambda size: GymnasiumBlock(gymnasium_id, size),
    )


def draw_starts(environment: Environment, n: int, rng: np.random.Generator) -> Starts:
    """n initial states with Gymnasium's reset noise: start i is that of ``reset(seed=starts.seeds[i])``.

    Share them between policies: with common initial states, differences of policies vary less.

    Raises:
        InputError: n is less than one.
    """
    if n < 1:
        raise InputError(f"{n} initial states were asked for, expected at least one.")
    return starts_of_seeds(environment, rng.integers(0, 2**31, size=n))


def starts_of_seeds(environment: Environment, seeds: IntArray) -> Starts:
    """The initial states of given (n,) seeds of Gymnasium's ``reset``."""
    raw = environment.reference
    states = np.empty((len(seeds), raw.model.nq + raw.model.nv))
    for state, seed in zip(states, seeds, strict=True):
        raw.reset(seed=int(seed))
        state[:] = raw.state_vector()
    return Starts(np.asarray(seeds, dtype=np.int64), states)
