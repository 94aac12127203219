r"""The likelihood set with a point inside to search from, or the proof that it is empty."""

from __future__ import annotations

import numpy as np
from scipy.special import expit

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
    return highest(answers, weight_bound, near)[1] < level


def highest(answers: Answers, weight_bound: float, near: FloatArray) -> tuple[float, float]:
    """The log-likelihood that was reached in the ball, searching from ``near``, and an upper bound on the largest.

    The bound is companion G2 with v = 0 and c = 1: by concavity it holds wherever the search ended.
    """
    w = near
    for weight in (1.0, 0.1, 0.01, 1e-3, 1e-5):
        w = _inner_fit(answers, weight_bound, w, weight)
    at = w[None]
    region = LikelihoodSet(answers, 0.0, weight_bound, w)
    bound, _ = dual_bounds(region, np.zeros_like(at), np.zeros((1, 0, len(w))), at, np.ones(1), np.zeros((1, 0)))
    return float(answers.log_likelihood(at)[0]), float(bound[0])


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


def needs_weight_bound(region: LikelihoodSet, span: FloatArray) -> bool:
    r"""Whether a certificate rests on ||w|| <= W, or the answers alone keep all weights inside (companion G3').

    With b = l(w^) - level, g the gradient at w^ and A_r = sum sigma'(z) 2 (e^(-r|x|) + r|x| - 1) / (r|x|)^2 x x', all
    weights of the set lie within r of w^ when b + ||g|| r - r^2 lambda_min(A_r) / 2 < 0. Directions outside of
    ``span``, in which neither candidates nor items differ, do not count.
    """
    answers, w = region.answers, region.interior
    value, gradient, _ = (part[0] for part in answers.derivatives(w[None]))
    x = answers.differences
    z, total = x @ w, answers.ones + answers.zeros
    slope = expit(z) * expit(-z) * total
    lengths = np.linalg.norm(x, axis=1)
    inner = x @ span.T
    for r in np.geomspace(1e-3, 1.0, 25) * (region.weight_bound - float(np.linalg.norm(w))):
        reach = np.maximum(r * lengths, 1e-6)
        factor = 2 * (np.expm1(-reach) + reach) / reach**2
        smallest = float(np.linalg.eigvalsh((inner.T * (slope * factor)) @ inner)[0]) if len(x) else 0.0
        if (value - region.level) + float(np.linalg.norm(gradient)) * r - r**2 * smallest / 2 < -1e-9:
            return False
    return True


def span_of_differences(features: FloatArray) -> FloatArray:
    """(k, d) orthonormal rows that span the differences of features (N, d).

    >>> span_of_differences(np.array([[1.0, 0.0], [1.0, 2.0]])).round(3) + 0.0
    array([[0., 1.]])
    """
    centered = features - features[0]
    _, sizes, directions = np.linalg.svd(np.linalg.qr(centered, mode="r"), full_matrices=False)
    span = directions[sizes > 1e-9 * max(float(sizes[0]), 1e-300)]
    return np.asarray(span * np.sign(span[np.arange(len(span)), np.abs(span).argmax(axis=1)])[:, None])
