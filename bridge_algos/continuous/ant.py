"""Ant-v5 on a pool of ``MjData``: contact forces as Gymnasium computes them, rewards for all rows at once."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge_algos.continuous.needs import need
from bridge_algos.continuous.starts import Starts
from bridge_algos.mdp import FloatArray, IntArray


class AntBlock:
    """Simulations of Ant-v5, stepped by one thread; ``mj_step`` leaves Python's lock to the other threads.

    Contact forces need ``mj_rnePostConstraint`` on the data that ``mj_step`` leaves, which MuJoCo's batch cannot run:
    hence one ``MjData`` a simulation.

    Args:
        reference: the unwrapped Gymnasium environment, which gives the model and the reward's weights.
        size: number of simulations.
    """

    def __init__(self, reference: Any, size: int) -> None:
        mujoco = need("mujoco")
        model = copy.copy(reference.model)
        if model.ntree == 1:  # then all constraints form one island, and looking for islands changes nothing
            model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ISLAND
        self._mujoco, self._model, self._reference = mujoco, model, reference
        self._torso = model.body(reference._main_body).id
        self._pool = [mujoco.MjData(model) for _ in range(size)]
        self._views = [(data.qpos, data.qvel, data.ctrl, data.cfrc_ext, data.xpos[self._torso]) for data in self._pool]

    def reset(self, starts: Starts, rows: IntArray) -> FloatArray:
        """Put start i into simulation ``rows[i]``; returns the (m, 105) observations."""
        for row, state in zip(rows.tolist(), starts.states, strict=True):
            data = self._pool[row]
            self._mujoco.mj_resetData(self._model, data)
            data.qpos[:] = state[: self._model.nq]
            data.qvel[:] = state[self._model.nq :]
            self._mujoco.mj_forward(self._model, data)
        return self._observations(*self._read(rows)[:3])

    def step(self, actions: NDArray[np.float32], rows: IntArray) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
        """One step under (m, 8) actions: observations, rewards, terminated (fallen, too high, or not finite)."""
        mj_step, rne, model, frames = (
            self._mujoco.mj_step,
            self._mujoco.mj_rnePostConstraint,
            self._model,
            self._reference.frame_skip,
        )
        before = np.array([self._views[row][4][0] for row in rows.tolist()])
        for row, action in zip(rows.tolist(), actions, strict=True):
            data = self._pool[row]
            self._views[row][2][:] = action
            mj_step(model, data, nstep=frames)
            rne(model, data)
        positions, velocities, forces, after = self._read(rows)
        return (
            self._observations(positions, velocities, forces),
            *self._outcome(actions, positions, velocities, forces, (after - before) / self._reference.dt),
        )

    def _read(self, rows: IntArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Positions, velocities, clipped contact forces (m, bodies, 6) and the torso's x of some simulations."""
        views = [self._views[row] for row in rows.tolist()]
        forces = np.clip(np.array([view[3] for view in views]), *self._reference._contact_force_range)
        return (
            np.array([view[0] for view in views]),
            np.array([view[1] for view in views]),
            forces,
            np.array([view[4][0] for view in views]),
        )

    def _observations(self, positions: FloatArray, velocities: FloatArray, forces: FloatArray) -> FloatArray:
        return np.concatenate([positions[:, 2:], velocities, forces[:, 1:].reshape(len(forces), -1)], axis=1)

    def _outcome(
        self,
        actions: NDArray[np.float32],
        positions: FloatArray,
        velocities: FloatArray,
        forces: FloatArray,
        x_velocities: FloatArray,
    ) -> tuple[FloatArray, NDArray[np.bool_]]:
        """Rewards and terminations, in the order of operations of Gymnasium's."""
        rules = self._reference
        low, high = rules._healthy_z_range
        finite = np.isfinite(positions).all(axis=1) & np.isfinite(velocities).all(axis=1)
        healthy = finite & (low <= positions[:, 2]) & (positions[:, 2] <= high)
        gains = x_velocities * rules._forward_reward_weight + healthy * rules._healthy_reward
        control = rules._ctrl_cost_weight * np.square(actions).sum(axis=1)
        contact = rules._contact_cost_weight * np.square(forces).reshape(len(forces), -1).sum(axis=1)
        return gains - (control + contact), ~healthy
