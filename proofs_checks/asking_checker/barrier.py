r"""A search for dual points in floats, for a batch of directions at once: hints, which nothing trusts.

Maximises <v, w> over the likelihood set within the ball, with each row <D_k, w> + e_k >= 0 softened: violating it by s
costs P s. The best s for a barrier log(u + s) + log s - a s (u the row's value, a = tau P) has a closed form, so
that the rows add a smooth concave function psi(u) with :math:`\psi'(u) = 2 a / (2 + u a + \sqrt{4 + u^2 a^2})` to
the height, and every point of the set is feasible.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from proofs_checks.asking_checker.fit import log_sigmoid, sigmoid
from proofs_checks.verify.enclosed import FloatArray

PENALTY = 6.0
"""P, relative to the length of v; rows have length 1."""

GROWTH, NEWTON, ENOUGH, ROUGH, REFRESH = 10.0, 30, 1e-9, 1e-4, 3
"""Growth of tau, steps at most, gains below which a stage ends (the last, and others), and steps between curvatures."""


@dataclass(frozen=True, eq=False)
class Region:
    """The likelihood set in floats.

    Args:
        x, ones, zeros: differences (m, d) and counts (m,).
        level: least log-likelihood.
        weight_bound: W.
        inside: (d,) a point from which to start.
    """

    x: FloatArray
    ones: FloatArray
    zeros: FloatArray
    level: float
    weight_bound: float
    inside: FloatArray


@dataclass(frozen=True, eq=False)
class Found:
    """Points (B, d) and multipliers c (B,) and mu (B, k) of B directions."""

    points: FloatArray
    c: FloatArray
    mu: FloatArray


def search(
    region: Region, v: FloatArray, rows: FloatArray, offsets: FloatArray, accuracy: float, target: float
) -> Found:
    """Dual points for directions v (B, d) with rows (B, k, d) and offsets (B, k), to about ``accuracy`` nats.

    A direction whose bound seems to be at most ``target`` is left as it is.
    """
    size, k = rows.shape[:2]
    scale = region.weight_bound * np.maximum(np.linalg.norm(v, axis=1), 1e-9)
    tau, last = 1.0, max(10.0, (2 + k) * float(scale.max()) / accuracy)
    found = Found(np.repeat(region.inside[None], size, axis=0), np.zeros(size), np.zeros((size, k)))
    active = np.arange(size)
    while len(active):
        objective = v[active] / scale[active, None] * tau
        height = _Height(region, objective, rows[active], offsets[active], tau * PENALTY / region.weight_bound)
        w = _climb(height, found.points[active], ENOUGH if tau >= last else ROUGH)
        gradient, room = slopes(region, w), np.maximum(log_likelihood(region, w) - region.level, 1e-12)
        found.points[active], found.c[active] = w, scale[active] / (tau * room)
        found.mu[active] = height.soft(w)[0] * (scale[active] / tau)[:, None]
        c, mu = found.c[active], found.mu[active]
        rest = v[active] + c[:, None] * gradient + np.einsum("bk,bkd->bd", mu, rows[active])
        bound = c * (room - np.vecdot(gradient, w)) + (mu * offsets[active]).sum(axis=1)
        bound += region.weight_bound * np.linalg.norm(rest, axis=1)
        if tau >= last:
            break
        active, tau = active[bound > target - 0.01 * accuracy], min(tau * GROWTH, last)
    return found


def slopes(region: Region, w: FloatArray) -> FloatArray:
    """(B, d) gradients of the log-likelihood."""
    p = sigmoid(w @ region.x.T)
    return np.asarray((region.ones - (region.ones + region.zeros) * p) @ region.x)


def curvatures(region: Region, w: FloatArray) -> FloatArray:
    """(B, d, d) negative Hessians of the log-likelihood."""
    p = sigmoid(w @ region.x.T)
    return np.stack([(region.x.T * row) @ region.x for row in (region.ones + region.zeros) * p * (1 - p)])


def log_likelihood(region: Region, w: FloatArray) -> FloatArray:
    """(B,) of weights (B, d)."""
    z = w @ region.x.T
    return np.asarray(log_sigmoid(z) @ (region.ones + region.zeros) - z @ region.zeros)


@dataclass(frozen=True, eq=False)
class _Height:
    """What Newton's steps increase: the objective (B, d) and the barriers."""

    region: Region
    objective: FloatArray
    rows: FloatArray
    offsets: FloatArray
    a: float

    def value(self, w: FloatArray) -> FloatArray:
        """(B,) height, minus infinity outside."""
        room = log_likelihood(self.region, w) - self.region.level
        ball = self.region.weight_bound**2 - np.vecdot(w, w)
        inside = (room > 0) & (ball > 0)
        value = np.vecdot(self.objective, w) + np.log(np.where(inside, room, 1)) + np.log(np.where(inside, ball, 1))
        if self.rows.shape[1]:
            ua = self._along(w) * self.a
            # (u + s) a and s a, each in a form without cancellation
            ahead, slack = _positive_sum(ua, np.sqrt(4 + ua**2)) / 2, _positive_sum(-ua, np.sqrt(4 + ua**2)) / 2
            value = value + (np.log(ahead) + np.log(slack) - slack).sum(axis=1)
        return np.where(inside, value, -np.inf)

    def soft(self, w: FloatArray) -> tuple[FloatArray, FloatArray]:
        """psi' and -psi'' of the rows, (B, k)."""
        u = self._along(w)
        root = np.sqrt(4 + (u * self.a) ** 2)
        first = 2 * self.a / _positive_sum(u * self.a, root)
        return first, first**2 / 2 * (1 + u * self.a / root)

    def step(self, w: FloatArray, curvature: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Newton's steps (B, d), and what they would gain at first order (B,)."""
        region, eye = self.region, np.eye(w.shape[1])
        room = (log_likelihood(region, w) - region.level)[:, None]
        ball = (region.weight_bound**2 - np.vecdot(w, w))[:, None]
        gradient = slopes(region, w) / room
        slope = self.objective + gradient - 2 * w / ball
        bend = curvature / room[..., None] + gradient[:, :, None] * gradient[:, None]
        bend += 2 * eye / ball[..., None] + 4 * (w / ball)[:, :, None] * (w / ball)[:, None]
        if self.rows.shape[1]:
            first, second = self.soft(w)
            slope = slope + np.einsum("bk,bkd->bd", first, self.rows)
            bend += np.matmul(self.rows.transpose(0, 2, 1) * second[:, None], self.rows)
        step = np.linalg.solve(bend, slope[..., None])[..., 0]
        return step, np.vecdot(step, slope)

    def _along(self, w: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("bkd,bd->bk", self.rows, w) + self.offsets)


def _positive_sum(ua: FloatArray, root: FloatArray) -> FloatArray:
    """2 + u a + sqrt(4 + u^2 a^2), without cancellation."""
    return np.asarray(2 + np.where(ua > 0, ua + root, 4 / (root - np.minimum(ua, 0))))


def _climb(height: _Height, w: FloatArray, enough: float) -> FloatArray:
    """Newton's method with halved steps, each direction by itself."""
    here = height.value(w)
    for turn in range(NEWTON):
        if turn % REFRESH == 0:
            curvature = curvatures(height.region, w)
        step, gain = height.step(w, curvature)
        if gain.max() < enough:
            break
        length = np.where(gain > enough, 1.0, 0.0)
        noise = 1e-13 * np.abs(here)  # near the top the gain is below what the height's rounding shows
        for _ in range(30):
            there = height.value(w + length[:, None] * step)
            short = ~(there >= here + 0.1 * length * gain - noise)
            if not short.any():
                break
            length = np.where(short, length / 2, length)
        length = np.where(short, 0.0, length)
        if not length.any():
            break
        w, here = w + length[:, None] * step, np.where(short, here, there)
    return w
