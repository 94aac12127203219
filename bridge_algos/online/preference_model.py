r"""The preference weights w: regularised logistic maximum likelihood, and its projection on the W-ball.

With rows :math:`x_l = slope (\phi(\tau_l^1) - \phi(\tau_l^2))` and outcomes :math:`o_l \in [0, 1]` the loss is
:math:`\sum_l -o_l \log \sigma(x_l^T w) - (1 - o_l) \log \sigma(-x_l^T w) + (\lambda/2) \|w\|^2` (the regulariser stands
outside the sum: audit C.1), its gradient :math:`g(w) - \sum_l o_l x_l` with
:math:`g(w) = \sum_l \sigma(x_l^T w) x_l + \lambda w`.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.optimize

from bridge_algos.mdp import FloatArray
from bridge_algos.online.oracles import sigmoid
from bridge_algos.shapes import Comparisons, DataMatrix, Outcomes, Weights
from bridge_theory.errors import InputError

GRADIENT_TOLERANCE = 1e-10
"""Newton stops when the gradient is this small relative to its largest possible size."""


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
    loss = _loss(w, x, outcomes, lam)
    for _ in range(100):
        p = sigmoid(x @ w)
        gradient = x.T @ (p - outcomes) + lam * w
        if np.abs(gradient).max() <= GRADIENT_TOLERANCE * scale:
            break
        hessian = (x * (p * (1 - p))[:, None]).T @ x
        hessian[np.diag_indices(len(w))] += lam
        step = np.linalg.solve(hessian, gradient)
        length, descent = 1.0, float(gradient @ step)
        if descent <= 8 * np.finfo(float).eps * (1 + abs(loss)):  # less than the loss can show: no line search
            w = w - step
            break
        while length > 1e-12:
            candidate = w - length * step
            new_loss = _loss(candidate, x, outcomes, lam)
            if new_loss <= loss - 1e-4 * length * descent:
                break
            length /= 2
        else:
            break
        w, loss = candidate, new_loss
    return w


def fit_adam(
    x: Comparisons, outcomes: Outcomes, lam: float, start: Weights, steps: int = 10, rate: float = 0.01
) -> Weights:
    """Ten full-batch Adam steps on the mean loss, as the published runs fit w; far from the optimum by design."""
    w = start.astype(np.float64)
    first, second = np.zeros_like(w), np.zeros_like(w)
    for k in range(1, steps + 1):
        gradient = (x.T @ (sigmoid(x @ w) - outcomes) + lam * w) / max(len(x), 1)
        first = 0.9 * first + 0.1 * gradient
        second = 0.999 * second + 0.001 * gradient**2
        w = w - rate * (first / (1 - 0.9**k)) / (np.sqrt(second / (1 - 0.999**k)) + 1e-8)
    return w


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
    root = scipy.linalg.cholesky(matrix, lower=True)
    target = _g(w, x, lam)
    v = w * (radius / norm)
    residual = scipy.linalg.solve_triangular(root, _g(v, x, lam) - target, lower=True)
    for _ in range(50):
        p = sigmoid(x @ v)
        jacobian = (x * (p * (1 - p))[:, None]).T @ x
        jacobian[np.diag_indices(len(v))] += lam
        whitened = scipy.linalg.solve_triangular(root, jacobian, lower=True)
        goal = _least_squares_in_ball(whitened, whitened @ v - residual, radius)
        if np.linalg.norm(goal - v) <= 1e-14 * radius:  # stationary: any shorter step is lost in rounding
            break
        length = 1.0
        while length > 1e-6:
            candidate = v + length * (goal - v)
            new = scipy.linalg.solve_triangular(root, _g(candidate, x, lam) - target, lower=True)
            if new @ new < residual @ residual * (1 - 1e-12):
                break
            length /= 2
        else:
            break
        improvement = residual @ residual - new @ new
        v, residual = candidate, new
        if improvement <= 1e-14 * (residual @ residual):
            break
    return v


def projection_error(v: Weights, x: Comparisons, outcomes: Outcomes, lam: float, matrix: DataMatrix) -> float:
    r"""The solver error :math:`e_t(v) = \|g(v) - \sum_l o_l x_l\|_{V^{-1}}` of audit R1 (0 at the exact optimum)."""
    difference = _g(v, x, lam) - x.T @ outcomes
    return float(np.sqrt(max(0.0, float(difference @ np.linalg.solve(matrix, difference)))))


def _g(w: Weights, x: Comparisons, lam: float) -> Weights:
    return np.asarray(x.T @ sigmoid(x @ w) + lam * w)


def _loss(w: Weights, x: Comparisons, outcomes: Outcomes, lam: float) -> float:
    margin = x @ w
    return float((np.logaddexp(0, margin) - outcomes * margin).sum() + lam / 2 * (w @ w))


def _least_squares_in_ball(a: FloatArray, b: FloatArray, radius: float) -> FloatArray:
    """argmin ||a v - b|| over ||v|| <= radius, ``a`` regular, by the secular equation in its singular basis."""
    left, singular, right = np.linalg.svd(a)
    projected = singular * (left.T @ b)

    def norm(mu: float) -> float:
        return float(np.linalg.norm(projected / (singular**2 + mu)))

    if norm(0.0) <= radius:
        return np.asarray(right.T @ (projected / singular**2))
    mu = scipy.optimize.brentq(lambda m: norm(m) - radius, 0.0, float(np.linalg.norm(projected)) / radius)
    return np.asarray(right.T @ (projected / (singular**2 + mu)))
