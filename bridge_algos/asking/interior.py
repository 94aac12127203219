"""Convex programs of one size, many at once: minimise over a ball cut by half-spaces, by a barrier method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bridge_algos.mdp import FloatArray, IntArray

Objective = Callable[[FloatArray], tuple[FloatArray, FloatArray, FloatArray]]
"""Values (B,), gradients (B, n) and Hessians (B, n, n) of a convex function at points (B, n)."""

CENTRING, HALVINGS = 40, 40


@dataclass(frozen=True, eq=False)
class CutBall:
    """Points z of n coordinates, the first d of norm below the radius, with rows z > offsets; B such sets.

    Args:
        rows: (B, k, n).
        offsets: (B, k).
        radius: of the ball.
        dimension: d.
    """

    rows: FloatArray
    offsets: FloatArray
    radius: float
    dimension: int

    def __getitem__(self, index: IntArray) -> CutBall:
        return CutBall(self.rows[index], self.offsets[index], self.radius, self.dimension)

    def barrier(self, z: FloatArray) -> FloatArray:
        """(B,) minus the logs of all distances to the boundary; infinite outside."""
        inside = np.concatenate([self._room(z)[:, None], self._margins(z)], axis=1)
        logs = np.log(np.where(inside > 0, inside, 1.0)).sum(axis=1)
        return np.where((inside > 0).all(axis=1), -logs, np.inf)

    def derivatives(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gradients (B, n) and Hessians (B, n, n) of the barrier inside."""
        d = self.dimension
        scaled = self.rows / self._margins(z)[..., None]
        radial = np.zeros_like(z)
        radial[:, :d] = 2 * z[:, :d] / self._room(z)[:, None]
        hessian = scaled.swapaxes(1, 2) @ scaled + radial[:, :, None] * radial[:, None, :]
        hessian[:, np.arange(d), np.arange(d)] += 2 / self._room(z)[:, None]
        return radial - scaled.sum(axis=1), hessian

    def _room(self, z: FloatArray) -> FloatArray:
        w = z[:, : self.dimension]
        return np.asarray(self.radius**2 - np.vecdot(w, w))

    def _margins(self, z: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("bkn,bn->bk", self.rows, z) - self.offsets)


def minimise(objective: Objective, sets: CutBall, z: FloatArray, strengths: FloatArray) -> FloatArray:
    """Points (B, n) near the minima, from points inside; within (k + 2) / strengths[-1] of them where Newton converged.

    Args:
        strengths: increasing factors of the objective against the barrier.
    """
    for strength in strengths:
        z = _centred(objective, sets, z, float(strength))
    return z


def inner_points(sets: CutBall) -> tuple[IntArray, FloatArray]:
    """Indices of the sets in which a point inside was found, and these points."""
    count, k, d = sets.rows.shape
    slack = np.concatenate([sets.rows, -np.ones((count, k, 1))], axis=2)
    limit = np.zeros((count, 1, d + 1))
    limit[..., d] = -1.0
    lifted = CutBall(
        np.concatenate([slack, limit], axis=1),
        np.concatenate([sets.offsets, -np.ones((count, 1))], axis=1),
        sets.radius,
        d,
    )
    slope = np.zeros(d + 1)
    slope[d] = -1.0

    def lower(z: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        return -z[:, d], np.broadcast_to(slope, z.shape), np.zeros((len(z), d + 1, d + 1))

    start = np.zeros((count, d + 1))
    start[:, d] = np.minimum(-sets.offsets.max(axis=1), 0.0) - 1.0
    z = minimise(lower, lifted, start, np.geomspace(1.0, 1e6, 25) / sets.radius)
    found = np.flatnonzero(z[:, d] > 1e-7 * sets.radius)
    return found, z[found, :d]


def _centred(objective: Objective, sets: CutBall, z: FloatArray, strength: float) -> FloatArray:
    """Damped Newton steps on strength * objective + barrier, until each promises little."""
    z = z.copy()
    todo = np.arange(len(z))

    def height(at: IntArray, points: FloatArray) -> FloatArray:
        return np.asarray(strength * objective(points)[0] + sets[at].barrier(points))

    for _ in range(CENTRING):
        _, slope, curvature = objective(z[todo])
        gradient, hessian = sets[todo].derivatives(z[todo])
        gradient = gradient + strength * slope
        step = -np.linalg.solve(hessian + strength * curvature, gradient[..., None])[..., 0]
        fall = -np.vecdot(gradient, step)
        before, length = height(todo, z[todo]), np.ones(len(todo))
        waiting = np.arange(len(todo))
        for _ in range(HALVINGS):
            here = todo[waiting]
            after = height(here, z[here] + length[waiting, None] * step[waiting])
            waiting = waiting[~(after <= before[waiting] - 0.1 * length[waiting] * fall[waiting])]
            if not len(waiting):
                break
            length[waiting] *= 0.5
        length[waiting] = 0.0
        z[todo] += length[:, None] * step
        todo = todo[(fall > 1e-4) & (length > 0)]
        if not len(todo):
            break
    return z
