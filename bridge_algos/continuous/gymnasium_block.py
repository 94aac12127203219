"""Any MuJoCo environment of Gymnasium through its own ``step``: the slower path that needs no knowledge of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bridge_algos.continuous.needs import need
from bridge_algos.continuous.starts import Starts
from bridge_algos.mdp import FloatArray, IntArray


class GymnasiumBlock:
    """Copies of a Gymnasium environment, stepped one after the other by one thread.

    Args:
        gymnasium_id: such as "Hopper-v5".
        size: number of copies.
    """

    def __init__(self, gymnasium_id: str, size: int) -> None:
        gymnasium = need("gymnasium")
        self._copies = [gymnasium.make(gymnasium_id).unwrapped for _ in range(size)]

    def reset(self, starts: Starts, rows: IntArray) -> FloatArray:
        """Put start i into copy ``rows[i]``; returns the (m, d_s) observations."""
        seeds = zip(rows.tolist(), starts.seeds.tolist(), strict=True)
        return np.array([self._copies[row].reset(seed=seed)[0] for row, seed in seeds], dtype=np.float64)

    def step(self, actions: NDArray[np.float32], rows: IntArray) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
        """One step of the copies ``rows`` under (m, d_a) actions: observations, rewards, terminated."""
        results = [self._copies[row].step(action) for row, action in zip(rows.tolist(), actions, strict=True)]
        observations, rewards, terminated, _, _ = zip(*results, strict=True)
        return np.array(observations, dtype=np.float64), np.array(rewards, dtype=np.float64), np.array(terminated)
