"""Initial states."""

from __future__ import annotations

from dataclasses import dataclass

from bridge_algos.mdp import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Starts:
    """n initial states.

    Args:
        seeds: (n,) seeds of Gymnasium's ``reset``, which give these states.
        states: (n, nq + nv) positions and velocities (MuJoCo's qpos, qvel).
    """

    seeds: IntArray
    states: FloatArray

    def __len__(self) -> int:
        return len(self.seeds)

    def __getitem__(self, part: slice) -> Starts:
        return Starts(self.seeds[part], self.states[part])
