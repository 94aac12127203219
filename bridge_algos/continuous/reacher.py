"""Reacher-v5 through MuJoCo's own batch: Gymnasium's observation and reward, computed for all rows at once."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge_algos.continuous.needs import need
from bridge_algos.continuous.starts import Starts
from bridge_algos.mdp import FloatArray, IntArray


class ReacherBlock:
    """Simulations of Reacher-v5, stepped together by one thread.

    The body positions that MuJoCo leaves after an RK4 step are those of its fourth stage, not of the final joint
    angles; Gymnasium observes them so, and so does this.

    Args:
        reference: the unwrapped Gymnasium environment, which gives the model and the reward's weights.
        size: number of simulations.
    """

    def __init__(self, reference: Any, size: int) -> None:
        mujoco = need("mujoco")
        model = copy.copy(reference.model)
        if not model.geom_contype.any():  # then no two geoms can touch, and looking for contacts changes nothing
            model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        self._batch = need("mujoco.batch").Batch(model, size, nthread=1)
        self._qpos, self._qvel, self._ctrl, self._xpos = (
            self._batch.bind(name) for name in ("qpos", "qvel", "ctrl", "xpos")
        )
        self._fingertip, self._target = model.body("fingertip").id, model.body("target").id
        self._nq, self._frames = model.nq, reference.frame_skip
        self._weights = reference._reward_dist_weight, reference._reward_control_weight

    def reset(self, starts: Starts, rows: IntArray) -> FloatArray:
        """Put start i into simulation ``rows[i]``; returns the (m, 10) observations."""
        mujoco = need("mujoco")
        self._batch.reset(rows, stage=mujoco.mjtStage.mjSTAGE_NONE.value)
        self._qpos[rows] = starts.states[:, : self._nq]
        self._qvel[rows] = starts.states[:, self._nq :]
        self._batch.forward(rows)
        return self._observations(rows, self._to_target(rows))

    def step(self, actions: NDArray[np.float32], rows: IntArray) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
        """One step under (m, 2) actions: observations, rewards, terminated (never)."""
        self._ctrl[rows] = actions
        self._batch.step(rows, nstep=self._frames)
        to_target = self._to_target(rows)
        near, control = self._weights
        distance = np.sqrt(np.vecdot(to_target, to_target))  # the inner product that np.linalg.norm uses
        rewards = -distance * near + -np.square(actions).sum(axis=1) * control
        return self._observations(rows, to_target), rewards, np.zeros(len(rows), dtype=np.bool_)

    def _to_target(self, rows: IntArray) -> FloatArray:
        return np.asarray(self._xpos[rows, self._fingertip] - self._xpos[rows, self._target])

    def _observations(self, rows: IntArray, to_target: FloatArray) -> FloatArray:
        positions = self._qpos[rows]
        angles = np.ascontiguousarray(positions[:, :2])
        parts = [np.cos(angles), np.sin(angles), positions[:, 2:], self._qvel[rows, :2], to_target[:, :2]]
        return np.concatenate(parts, axis=1)
