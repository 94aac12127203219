r"""How far apart two candidates can be over the likelihood set: a bound by duality (companion G2).

For weights in Ball(W) with :math:`\ell_t(w) \ge L` and :math:`D w \ge 0` (the rows of D say that the contender beats
its rivals), every direction v, point w_0, :math:`c \ge 0` and :math:`\mu \ge 0`

.. math:: \langle v, w \rangle \le c\,(\ell_t(w_0) - \langle \nabla \ell_t(w_0), w_0 \rangle - L)
          + W \| v + c \nabla \ell_t(w_0) + D^T \mu \|_2 .

A barrier method finds (w_0, c, mu) for a batch of contenders at once; the number that is kept is the right-hand side,
which holds whatever it found. Rounding is added.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridge_algos.asking.answers import Answers
from bridge_algos.mdp import FloatArray

ROUNDING = 1e-10
"""Added to a bound, relative to the size of its terms: far above float64's rounding, but no proof of it.

What is proved to the last digit is what ``bridge-rl verify`` says of a session.
"""

PENALTY = 5.0
"""What violating a rival's row costs in the search; it limits sum(mu) and keeps the search feasible."""

FIRST_STEPS, GROWTH, STAGES, CENTRING, CENTRED = 30.0, 10.0, 12, 30, 0.05


@dataclass(frozen=True, eq=False)
class LikelihoodSet:
    r""":math:`C_t = \{w : \ell_t(w) \ge level,\ \|w\| \le W\}`.

    Args:
        answers: of the session so far.
        level: Q_t - log(1/delta).
        weight_bound: W.
        interior: (d,) a point strictly inside, from which searches start.
    """

    answers: Answers
    level: float
    weight_bound: float
    interior: FloatArray


@dataclass(frozen=True, eq=False)
class Certificates:
    """Dual points of a batch of B contenders.

    Args:
        bound: (B,) upper bounds on <v, w> over the set, valid for any values of the other fields.
        reached: (B,) the largest value of <v, w> that was reached inside (within the penalty), for the search only.
        points: (B, d) w_0.
        multipliers: (B,) c.
        rival_multipliers: (B, k) mu.
        rest: (B, d) the vector v + c grad + D' mu, whose norm is part of the bound.
        inside: (B, d) the points that reached it.
    """

    bound: FloatArray
    reached: FloatArray
    points: FloatArray
    multipliers: FloatArray
    rival_multipliers: FloatArray
    rest: FloatArray
    inside: FloatArray


def dual_bounds(
    region: LikelihoodSet, v: FloatArray, rows: FloatArray, w0: FloatArray, c: FloatArray, mu: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The right-hand side of the certificate, rounded up, for B contenders.

    Args:
        v: (B, d) directions.
        rows: (B, k, d) rows D, k may be 0.
        w0, c, mu: (B, d), (B,), (B, k); c and mu at least 0.

    Returns:
        (B,) upper bounds, and (B, d) the vectors whose norms are part of them.
    """
    value, gradient, _ = region.answers.derivatives(w0)
    along = np.vecdot(gradient, w0)
    rest = v + c[:, None] * gradient + np.einsum("bk,bkd->bd", mu, rows)
    bound = c * (value - along - region.level) + region.weight_bound * np.linalg.norm(rest, axis=1)
    # what rounding can hide grows with the size of every term that was added
    size = c * (1 + np.abs(value) + np.abs(along) + abs(region.level))
    sums = np.abs(v).sum(axis=1) + mu.sum(axis=1) + c * np.abs(gradient).sum(axis=1)
    counted = c * (region.answers.total * (1 + np.abs(region.answers.differences).max(initial=0.0)))
    return np.asarray(bound + ROUNDING * (1 + size + region.weight_bound * (sums + 1e-3 * counted))), rest


def shared_bounds(region: LikelihoodSet, v: FloatArray, point: FloatArray) -> FloatArray:
    """Upper bounds on <v, w> over the set for all directions (N, d), (N,), each with its best c at one point (d,)."""
    w, size = point[None], len(v)
    c = _best_multiplier(region, v, w, np.zeros(size))
    return dual_bounds(region, v, np.zeros((size, 0, v.shape[1])), w, c, np.zeros((size, 0)))[0]


def search(
    region: LikelihoodSet,
    v: FloatArray,
    rows: FloatArray,
    tolerance: float,
    target: float | FloatArray | None = None,
    ease: FloatArray | None = None,
) -> Certificates:
    """Certificates of B contenders, to a tolerance, or good enough to decide whether a bound is at most ``target``.

    Maximises <v, w> - PENALTY s over the set with D w >= -ease - s, s >= 0, by a barrier method. With a target a
    contender's search also ends when its bound is at most the target, or when a point above the target is reached.

    Args:
        ease: (B, k) nonnegative, where the rows are known up to so much; it adds <mu, ease> to the bounds. None: 0.
    """
    size = len(v)
    k = rows.shape[1]
    problem = _Barrier(region, v, rows, np.full(size, 1.0), np.zeros((size, k)) if ease is None else ease)
    w = np.repeat(region.interior[None], size, axis=0)
    s = np.maximum(0, -np.einsum("bkd,bd->bk", rows, w).min(axis=1, initial=0.0)) + 0.1 * region.weight_bound
    scale = region.weight_bound * np.maximum(np.linalg.norm(v, axis=1), 1e-12) + (PENALTY * s if k else 0.0)
    problem.tau = FIRST_STEPS / scale
    best = Certificates(
        np.full(size, np.inf), np.full(size, -np.inf), w.copy(), np.zeros(size), np.zeros((size, k)), v.copy(), w.copy()
    )
    active = np.arange(size)
    for _ in range(STAGES):
        w[active], s[active] = problem.centre(active, w[active], s[active])
        improved = _record(best, problem, active, w[active], s[active])
        active = active[improved]
        open_ = best.bound - best.reached > tolerance
        if target is not None:
            open_ &= (best.bound > target) & (best.reached <= target)
        active = active[open_[active]]
        if not len(active):
            break
        problem.tau[active] *= GROWTH
    return best


def _record(best: Certificates, problem: _Barrier, active: np.ndarray, w: FloatArray, s: FloatArray) -> np.ndarray:
    """Keep the better of the certificate at these points and the best one before; which contenders got closer."""
    region, v, rows, tau = problem.region, problem.v[active], problem.rows[active], problem.tau[active]
    slack = region.answers.log_likelihood(w) - region.level
    margins = problem.margins(active, w, s)
    mu = 1 / (tau[:, None] * margins)
    c = _best_multiplier(region, v + np.einsum("bk,bkd->bd", mu, rows), w, 1 / (tau * slack))
    reached = np.vecdot(v, w) - (PENALTY * s if rows.shape[1] else 0)
    bound, rest = dual_bounds(region, v, rows, w, c, mu)
    bound = bound + np.vecdot(mu, problem.ease[active]) * (1 + ROUNDING)
    better = bound < best.bound[active]
    to = active[better]
    best.bound[to], best.points[to] = bound[better], w[better]
    best.multipliers[to], best.rival_multipliers[to], best.rest[to] = c[better], mu[better], rest[better]
    further = reached > best.reached[active]
    best.inside[active[further]] = w[further]
    closer = better | further
    best.reached[active] = np.maximum(best.reached[active], reached)
    return np.asarray(closer)


def _best_multiplier(region: LikelihoodSet, u: FloatArray, w: FloatArray, c: FloatArray) -> FloatArray:
    """The c >= 0 that minimises c a + W ||u + c g||, in closed form; the given one where that has no minimum."""
    value, g, _ = region.answers.derivatives(w)
    a = value - np.vecdot(g, w) - region.level
    norm = np.maximum(np.linalg.norm(g, axis=1), 1e-300)
    along = np.vecdot(u, g) / norm
    across = np.sqrt(np.maximum(np.vecdot(u, u) - along**2, 0))
    ratio = -a / (region.weight_bound * norm)
    inner = np.abs(ratio) < 1
    ratio = np.where(inner, ratio, np.sign(ratio))
    root = np.sqrt(np.where(inner, 1 - ratio**2, 1.0))
    best = (ratio * across / root - along) / norm
    return np.where(inner, np.maximum(best, 0), np.where(ratio >= 1, c, 0.0))


class _Barrier:
    """tau (<v, w> - PENALTY s) + log(l(w) - L) + log(W^2 - |w|^2) + sum log(D w + ease + s) + log s, for a batch."""

    def __init__(
        self, region: LikelihoodSet, v: FloatArray, rows: FloatArray, tau: FloatArray, ease: FloatArray
    ) -> None:
        self.region, self.v, self.rows, self.tau, self.ease = region, v, rows, tau, ease

    def margins(self, index: np.ndarray, w: FloatArray, s: FloatArray) -> FloatArray:
        """(B, k) D w + ease + s."""
        return np.asarray(np.einsum("bkd,bd->bk", self.rows[index], w) + self.ease[index] + s[:, None])

    def value(self, index: np.ndarray, w: FloatArray, s: FloatArray) -> FloatArray:
        """(B,) the barrier function; -inf outside."""
        region, rows = self.region, self.rows[index]
        inside = np.stack([region.answers.log_likelihood(w) - region.level, region.weight_bound**2 - np.vecdot(w, w)])
        total = self.tau[index] * np.vecdot(self.v[index], w)
        if rows.shape[1]:
            inside = np.concatenate([inside, self.margins(index, w, s).T, s[None]])
            total = total - self.tau[index] * PENALTY * s
        feasible = (inside > 0).all(axis=0)
        return np.where(feasible, total + np.log(np.where(inside > 0, inside, 1.0)).sum(axis=0), -np.inf)

    def centre(self, index: np.ndarray, w: FloatArray, s: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Newton's method to near the central point; each step goes as far as the function rises."""
        w, s = w.copy(), s.copy()
        todo = np.arange(len(index))
        height = self.value(index, w, s)
        for _ in range(CENTRING):
            at = index[todo]
            dw, ds, rise = self._step(at, w[todo], s[todo])
            before = height[todo]
            length = np.ones(len(todo))
            waiting = np.arange(len(todo))
            for _ in range(30):
                here = todo[waiting]
                after = self.value(
                    at[waiting], w[here] + length[waiting, None] * dw[waiting], s[here] + length[waiting] * ds[waiting]
                )
                short = after < before[waiting] + 0.05 * length[waiting] * rise[waiting] - 1e-9 * np.abs(
                    before[waiting]
                )
                height[here[~short]] = after[~short]
                waiting = waiting[short]
                if not len(waiting):
                    break
                length[waiting] *= 0.4
            length[waiting] = 0.0
            w[todo] += length[:, None] * dw
            s[todo] += length * ds
            todo = todo[(length > 0) & (rise > CENTRED)]
            if not len(todo):
                break
        return w, s

    def _step(self, index: np.ndarray, w: FloatArray, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Newton direction in (w, s) and the rise that it promises."""
        region, rows, tau = self.region, self.rows[index], self.tau[index]
        value, slope, curvature = region.answers.derivatives(w)
        inside = value - region.level
        room = region.weight_bound**2 - np.vecdot(w, w)
        slope = slope / inside[:, None]
        radial = 2 * w / room[:, None]
        gradient = tau[:, None] * self.v[index] + slope - radial
        hessian = curvature / inside[:, None, None] + slope[:, :, None] * slope[:, None, :]
        hessian += radial[:, :, None] * radial[:, None, :] + (2 / room)[:, None, None] * np.eye(w.shape[1])
        hessian += (1e-13 * np.trace(hessian, axis1=1, axis2=2))[:, None, None] * np.eye(w.shape[1])
        if not rows.shape[1]:
            dw = np.linalg.solve(hessian, gradient[..., None])[..., 0]
            return dw, np.zeros(len(w)), np.vecdot(gradient, dw)
        inverse = 1 / self.margins(index, w, s)
        gradient += np.einsum("bk,bkd->bd", inverse, rows)
        scaled = inverse[..., None] * rows
        hessian += scaled.swapaxes(1, 2) @ scaled
        mixed = np.einsum("bk,bkd->bd", inverse, scaled)
        gradient_s = -tau * PENALTY + inverse.sum(axis=1) + 1 / s
        solved = np.linalg.solve(hessian, np.stack([gradient, mixed], axis=2))
        own = (inverse**2).sum(axis=1) + 1 / s**2 - np.vecdot(mixed, solved[..., 1])
        ds = (gradient_s - np.vecdot(mixed, solved[..., 0])) / own
        dw = solved[..., 0] - ds[:, None] * solved[..., 1]
        return dw, ds, np.vecdot(gradient, dw) + gradient_s * ds
