r"""The likelihood set with a point inside to search from, or the proof that it is empty."""

from __future__ import annotations

import numpy as np

from bridge_algos.asking.answers import Answers
from bridge_algos.asking.dual import LikelihoodSet, dual_bounds
from bridge_algos.mdp import FloatArray


def likelihood_set(answers: Answers, level: float, weight_bound: float, start: FloatArray) -> LikelihoodSet | None:
    """The set at a level, with an interior point found from ``start`` (inside the ball); None where none is found."""
    w = start
    for weight in (1.0, 0.1, 0.01, 1e-3, 1e-5):
        w = _inner_fit(answers, weight_bound, w, weight)
        if answers.log_likelihood(w[None])[0] - level > min(0.5, 10 * weight):
            return LikelihoodSet(answers, level, weight_bound, w)
    return None


def is_empty(answers: Answers, level: float, weight_bound: float, near: FloatArray) -> bool:
    """Whether duality proves that no weights in the ball are in the set: the answers contradict model or W."""
    w = _inner_fit(answers, weight_bound, near, 1e-7)[None]
    region = LikelihoodSet(answers, level, weight_bound, w[0])
    nothing = np.zeros_like(w)
    bound, _ = dual_bounds(region, nothing, np.zeros((1, 0, w.shape[1])), w, np.ones(1), np.zeros((1, 0)))
    return bool(bound[0] < 0)


def _inner_fit(answers: Answers, weight_bound: float, w: FloatArray, weight: float) -> FloatArray:
    """Maximise l(w) + weight log(W^2 - |w|^2) by damped Newton steps."""

    def height(w: FloatArray) -> float:
        room = weight_bound**2 - w @ w
        return float(answers.log_likelihood(w[None])[0] + weight * np.log(room)) if room > 0 else -np.inf

    here = height(w)
    for _ in range(50):
        _, gradient, curvature = (part[0] for part in answers.derivatives(w[None]))
        room = weight_bound**2 - w @ w
        radial = 2 * w / room
        slope = gradient - weight * radial
        hessian = curvature + weight * (np.outer(radial, radial) + 2 / room * np.eye(len(w)))
        step = np.linalg.solve(hessian, slope)
        rise = slope @ step
        if rise < 1e-6:
            break
        length = 1.0
        while height(w + length * step) < here + 0.1 * length * rise and length > 1e-6:
            length *= 0.5
        if length <= 1e-6:
            break
        w = w + length * step
        here = height(w)
    return w
