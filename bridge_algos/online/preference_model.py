r"""The preference weights w: regularised logistic maximum likelihood, and its projection on the W-ball.

With rows :math:`x_l = slope (\phi(\tau_l^1) - \phi(\tau_l^2))` and outcomes :math:`o_l \in [0, 1]` the loss is
:math:`\sum_l -o_l \log \sigma(x_l^T w) - (1 - o_l) \log \sigma(-x_l^T w) + (\lambda/2) \|w\|^2` (the regulariser stands
outside the sum: audit C.1), its gradient :math:`g(w) - \sum_l o_l x_l` with
:math:`g(w) = \sum_l \sigma(x_l^T w) x_l + \lambda w`.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from bridge_algos.given import checked
from bridge_algos.mdp import FloatArray
from bridge_algos.online.cholesky import inverse_root, solve
from bridge_algos.online.oracles import sigmoid
from bridge_algos.shapes import Comparisons, DataMatrix, Outcomes, Weights
from bridge_theory.errors import InputError

EPSILON = float(np.finfo(float).eps)
GRADIENT_TOLERANCE = 1e-10
"""Newton stops when the gradient is this small relative to its largest possible size."""


@checked
def fit_exact(x: Comparisons, outcomes: Outcomes, lam: float, start: Weights) -> Weights:
    """The unique minimiser of the regularised logistic loss, by damped Newton.

    Args:
        x: (m, d) scaled feature differences; m may be 0.
        outcomes: (m,) in [0, 1].
        lam: lambda > 0, which makes the loss strictly convex.
        start: (d,) where to begin; the result does not depend on it beyond rounding.

    Raises:
        InputError: for a lambda that is not positive.
    """
    if not lam > 0:
        raise InputError(f"lambda is {lam}, expected a positive number; without it the optimum may not exist.")
    w = start.astype(np.float64)
    scale = float(np.abs(x).sum()) + lam
    margin = x.dot(w)
    loss = _loss(w, margin, outcomes, lam)
    for _ in range(100):
        p = sigmoid(margin)
        gradient = (p - outcomes).dot(x) + lam * w
        if gradient.dot(gradient) <= (GRADIENT_TOLERANCE * scale) ** 2:
            break
        step = solve(_jacobian(p, x, lam), gradient)
        length, descent = 1.0, float(gradient @ step)
        if descent <= 8 * EPSILON * (1 + abs(loss)):  # less than the loss can show: no line search
            w = w - step
            break
        while length > 1e-12:
            candidate = w - length * step
            margin = x.dot(candidate)
            new_loss = _loss(candidate, margin, outcomes, lam)
            if new_loss <= loss - 1e-4 * length * descent:
                break
            length /= 2
        else:
            break
        w, loss = candidate, new_loss
    return w


@checked
def fit_adam(
    x: Comparisons, outcomes: Outcomes, lam: float, start: Weights, steps: int = 10, rate: float = 0.01
) -> Weights:
    """Ten full-batch Adam steps on the mean loss, as the published runs fit w; far from the optimum by design."""
    w = start.astype(np.float64)
    count = max(len(x), 1)
    mean, shrinkage = np.ascontiguousarray(x.T) / count, lam / count
    answered = mean.dot(outcomes)
    first, second = np.zeros_like(w), np.zeros_like(w)
    for k in range(1, steps + 1):
        gradient = mean.dot(sigmoid(x.dot(w))) - answered + shrinkage * w
        first = 0.9 * first + gradient
        second = 0.999 * second + gradient * gradient
        root = sqrt(0.001 / (1 - 0.999**k))
        w = w - (0.1 * rate / (1 - 0.9**k) / root) * first / (np.sqrt(second) + 1e-8 / root)
    return w


@checked
def project(w: Weights, x: Comparisons, lam: float, matrix: DataMatrix, radius: float) -> Weights:
    r"""A point of the W-ball that minimises :math:`\|g(v) - g(w)\|_{V^{-1}}` locally (eq:constr).

    The problem is not convex; Gauss-Newton steps on the ball, started from w scaled to the sphere, never increase the
    objective. What is left of it is reported by :func:`projection_error`, and the repaired confidence set (audit R1)
    holds for any point of the ball with that error, so that no global optimum is needed.

    Args:
        w: (d,) estimate.
        x: (m, d) scaled feature differences.
        matrix: (d, d) positive definite V.
        radius: W > 0.
    """
    norm = float(np.linalg.norm(w))
    if norm <= radius:
        return w
    root = inverse_root(matrix)
    target = _g(w, x, lam)
    v = w * (radius / norm)
    residual = root @ (_g(v, x, lam) - target)
    left = float(residual @ residual)
    for _ in range(50):
        whitened = root @ _jacobian(sigmoid(x @ v), x, lam)
        step = _least_squares_in_ball(whitened, whitened @ v - residual, radius) - v
        if np.linalg.norm(step) <= 1e-14 * radius:  # stationary: any shorter step is lost in rounding
            break
        length = 1.0
        while length > 1e-6:
            candidate = v + length * step
            residual = root @ (_g(candidate, x, lam) - target)
            now = float(residual @ residual)
            if now < left * (1 - 1e-12):
                break
            length /= 2
        else:
            break
        improvement, v, left = left - now, candidate, now
        if improvement <= 1e-14 * left:
            break
    return v


@checked
def projection_error(v: Weights, x: Comparisons, outcomes: Outcomes, lam: float, matrix: DataMatrix) -> float:
    r"""The solver error :math:`e_t(v) = \|g(v) - \sum_l o_l x_l\|_{V^{-1}}` of audit R1 (0 at the exact optimum)."""
    return float(np.linalg.norm(inverse_root(matrix) @ (_g(v, x, lam) - x.T @ outcomes)))


def _g(w: Weights, x: Comparisons, lam: float) -> Weights:
    return np.asarray(x.T @ sigmoid(x @ w) + lam * w)


def _jacobian(p: Outcomes, x: Comparisons, lam: float) -> FloatArray:
    """Derivative of g, where p = sigma(x w)."""
    result = (x * (p - p * p)[:, None]).T.dot(x)
    result.flat[:: x.shape[1] + 1] += lam
    return np.asarray(result)


def _loss(w: Weights, margin: Outcomes, outcomes: Outcomes, lam: float) -> float:
    return float(np.add.reduce(np.logaddexp(0, margin) - outcomes * margin) + lam / 2 * w.dot(w))


def _least_squares_in_ball(a: FloatArray, b: FloatArray, radius: float) -> FloatArray:
    r"""argmin ||a v - b|| over ||v|| <= radius, ``a`` regular, by the secular equation in its singular basis.

    :math:`1 / \|v(\mu)\|` is concave and increasing in the multiplier mu, so that Newton's method from zero climbs to
    the solution without passing it, in a few steps.
    """
    left, singular, right = np.linalg.svd(a)
    projected, squares, mu = singular * (left.T @ b), singular**2, 0.0
    for _ in range(100):
        shifted = squares + mu
        coordinates = projected / shifted
        norm = float(np.linalg.norm(coordinates))
        if norm <= radius * (1 + 1e-14):
            break
        mu += norm**2 / float(coordinates @ (coordinates / shifted)) * (norm / radius - 1)
    return np.asarray(right.T @ coordinates)
