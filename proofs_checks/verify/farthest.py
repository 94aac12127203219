r"""Where in the likelihood set a direction is largest: floats in search of good hints, none of which is trusted.

The set is :math:`\{w : \ell(w) \ge L, \|w\| \le W\}`; a barrier method follows the path of

.. math:: \tau\langle v, w\rangle + \log(\ell(w) - L) + \log(W^2 - \|w\|^2)

as tau grows, from a point inside, which maximises :math:`\ell(w) + a\log(W^2 - \|w\|^2)` with a small a.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from proofs_checks.verify.enclosed import FloatArray
from proofs_checks.verify.evidence import Answers

GROWTH, STAGES = 10.0, 7
STEPS = 40

Expansion = tuple[float, FloatArray, FloatArray]
"""Value, gradient and Hessian at a point; the value is -infinity outside of the domain."""


def fit_in_ball(answers: Answers, weight_bound: float, start: FloatArray) -> FloatArray:
    """Weights inside the ball with nearly the largest likelihood there."""
    w = start
    for weight in (1.0, 0.1, 0.01, 1e-3):

        def height(w: FloatArray, weight: float = weight) -> Expansion:
            return _sum(expansion(answers, w), _room(weight_bound, w), weight)

        w = _climb(height, w)
    return w


def farthest(answers: Answers, level: float, weight_bound: float, v: FloatArray, start: FloatArray) -> FloatArray:
    """Weights of the set with nearly the largest <v, w>, from a point inside."""
    w, tau = start, 1 / (weight_bound * max(float(np.linalg.norm(v)), 1e-300))
    for _ in range(STAGES):
        tau *= GROWTH

        def height(w: FloatArray, tau: float = tau) -> Expansion:
            value, gradient, hessian = _sum(_slack(answers, level, w), _room(weight_bound, w), 1.0)
            return value + tau * float(v @ w), gradient + tau * v, hessian

        w = _climb(height, w)
    return w


def _climb(height: Callable[[FloatArray], Expansion], w: FloatArray) -> FloatArray:
    """Damped Newton steps up a concave function."""
    value, gradient, hessian = height(w)
    for _ in range(STEPS):
        shift = 1e-13 * float(np.trace(hessian)) * np.eye(len(w))
        step = np.linalg.solve(hessian + shift, -gradient)
        rise, length = float(gradient @ step), 1.0
        if not rise > 1e-3:
            break
        while length > 1e-9:
            candidate = height(w + length * step)
            if candidate[0] >= value + 0.05 * length * rise:
                break
            length /= 2
        else:
            break
        w = w + length * step
        value, gradient, hessian = candidate
    return w


def expansion(answers: Answers, w: FloatArray) -> Expansion:
    """The log-likelihood with its derivatives."""
    x = answers.differences.astype(np.float64)
    z = x @ w
    p = 1 / (1 + np.exp(-np.clip(z, -700, 700)))
    value = -float(answers.ones @ np.logaddexp(0, -z) + answers.zeros @ np.logaddexp(0, z))
    gradient = (answers.ones - answers.total * p) @ x
    return value, gradient, -(x.T * (answers.total * p * (1 - p))) @ x


def _slack(answers: Answers, level: float, w: FloatArray) -> Expansion:
    """log(l(w) - L)."""
    value, gradient, hessian = expansion(answers, w)
    slack = value - level
    if not slack > 0:
        return -np.inf, gradient, hessian
    gradient = gradient / slack
    return float(np.log(slack)), gradient, hessian / slack - np.outer(gradient, gradient)


def _room(weight_bound: float, w: FloatArray) -> Expansion:
    """log(W^2 - |w|^2)."""
    room = weight_bound**2 - float(w @ w)
    if not room > 0:
        return -np.inf, w, np.eye(len(w))
    radial = 2 * w / room
    return float(np.log(room)), -radial, -np.outer(radial, radial) - 2 / room * np.eye(len(w))


def _sum(one: Expansion, two: Expansion, weight: float) -> Expansion:
    return one[0] + weight * two[0], one[1] + weight * two[1], one[2] + weight * two[2]
