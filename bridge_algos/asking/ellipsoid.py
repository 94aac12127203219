r"""An ellipsoid around the likelihood set (companion G5), for filters over many policies.

With :math:`\|w^*\| \le W` and :math:`\ell(w^*) \ge Q - \log(1/\delta)` (companion G1'), any point :math:`\hat w`, any
:math:`\eta > 0`, and for each answer an :math:`r_s \ge |\langle x_s, w^* - \hat w\rangle|`: let :math:`z_s = \langle
x_s, \hat w\rangle`, :math:`c_s = 2\sigma'(z_s)(e^{-r_s} + r_s - 1)/r_s^2` and

.. math:: A = \sum_s c_s x_s x_s^\top + \eta I, \quad u = \eta\hat w - \nabla\ell(\hat w), \quad
   \rho^2 = 2(\ell(\hat w) - Q + \log(1/\delta)) + \eta(W^2 - \|\hat w\|^2) + \|u\|^2_{A^{-1}} .

Then :math:`\|w^* - (\hat w - A^{-1}u)\|_A \le \rho`, and the set is empty when :math:`\rho^2 < 0`. Here
:math:`\hat w` maximises :math:`\ell(w) - \eta\|w\|^2/2`, so that u vanishes but for rounding. The ellipsoid tells
more about each :math:`\langle x_s, w^*\rangle`, so that a further pass makes it smaller.

The evidence Q is Jaakkola and Jordan's: it needs no integral, and a checker finds the same number from the answers.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log

import numpy as np

from bridge_algos.asking.elicitation import PRIOR_SCALES
from bridge_algos.mdp import FloatArray
from bridge_algos.online.cholesky import inverse_root, log_det
from bridge_algos.online.oracles import sigmoid
from bridge_algos.online.preference_model import fit_exact

PASSES = 4
"""How often the ellipsoid is drawn, each time from what the one before tells."""

TANGENT_STEPS = 8
"""How often the points of Jaakkola and Jordan's bound are improved; it holds for any."""

MOST_DOUBLINGS = 60
"""How often eta is doubled to bring the fit into the ball; the ellipsoid is right for any."""

ROUNDING = 1e-9
"""Relative to the terms of a number, what is added or taken away for the rounding of double arithmetic."""


@dataclass(frozen=True, eq=False)
class Ellipsoid:
    """The weights w with ||w - center||_matrix at most the radius.

    Args:
        center: (d,).
        matrix: (d, d) positive definite.
        radius: rho, at least 0.
        level: the log-likelihood that the weights of the set have at least.
        empty: whether no weights of norm at most W are likely enough, so that W or the model is refuted; then the
            ellipsoid is the ball of all weights.
    """

    center: FloatArray
    matrix: FloatArray
    radius: float
    level: float
    empty: bool = False


def likelihood_ellipsoid(x: FloatArray, outcomes: FloatArray, weight_bound: float, delta: float) -> Ellipsoid:
    r"""An ellipsoid that holds every w of the likelihood set with norm at most W (companion G5).

    It contains w* after every answer at once, with probability at least :math:`1 - \delta`, in the Bradley-Terry model.

    Args:
        x: (m, d) feature differences in the order of the answers; m may be 0.
        outcomes: (m,) answers in [0, 1].
        weight_bound: W.
        delta: failure probability.

    >>> around = likelihood_ellipsoid(np.ones((400, 1)), np.ones(400), 5.0, 0.05)
    >>> bool(abs(5.0 - around.center[0]) <= around.radius / around.matrix[0, 0] ** 0.5)  # always 1: w* = 5 is likely
    True
    """
    d = x.shape[1]
    eta, w = _shrunken_fit(x, outcomes, weight_bound)
    z = x @ w
    likelihood = _log_likelihood(z, outcomes)
    level = evidence(x, outcomes, weight_bound) - log(1 / delta)
    u = eta * w - (outcomes - sigmoid(z)) @ x
    slope = sigmoid(z) * sigmoid(-z)
    known = 2 * (likelihood - level) + eta * (weight_bound**2 - w @ w)
    known += ROUNDING * (1 + abs(likelihood) + abs(level) + 2 * d)
    reach = weight_bound * np.linalg.norm(x, axis=1)
    low, high = -reach, reach
    for _ in range(PASSES):
        far = np.maximum(np.maximum(high - z, z - low), 0) * (1 + ROUNDING)
        curvature = slope * _lower_curvature(far)
        matrix = (x.T * curvature) @ x + eta * np.eye(d)
        root = inverse_root(matrix)
        pull = root @ u
        square = known + (pull @ pull) * (1 + ROUNDING)
        if square < 0:
            return Ellipsoid(np.zeros(d), np.eye(d), weight_bound, level, empty=True)
        center, radius = w - root.T @ pull, float(np.sqrt(square)) * (1 + ROUNDING)
        middle, width = x @ center, radius * np.linalg.norm(x @ root.T, axis=1) * (1 + ROUNDING)
        low, high = np.maximum(low, middle - width), np.minimum(high, middle + width)
    return Ellipsoid(center, matrix, radius, level)


def evidence(x: FloatArray, outcomes: FloatArray, weight_bound: float) -> float:
    """Q, a lower bound on the log evidence of the answers under an equal mixture of normal laws of the weights.

    The precisions are those of a session: PRIOR_SCALES in units of d / W^2.

    >>> round(evidence(np.ones((3, 1)), np.ones(3), 1.0), 3)  # the exact evidence is -1.861
    -1.874
    """
    unit = x.shape[1] / weight_bound**2
    parts = [_quadratic_evidence(x, outcomes, scale * unit) for scale in PRIOR_SCALES]
    return float(np.logaddexp.reduce(parts) - log(len(parts)))


def _quadratic_evidence(x: FloatArray, outcomes: FloatArray, precision: float) -> float:
    r"""Log evidence from below under N(0, I / precision), by the integral of a normal law below the likelihood.

    For any xi (Jaakkola and Jordan): log sigma(z) >= z/2 - log(2 cosh(xi/2)) - kappa (z^2 - xi^2), kappa = tanh(xi/2) /
    (4 xi). The best xi^2 is the second moment of z under that law.
    """
    d, points = x.shape[1], np.zeros(len(x))
    pull = (outcomes - 0.5) @ x
    for step in range(TANGENT_STEPS + 1):
        kappa = np.where(points > 1e-6, np.tanh(points / 2) / (4 * np.maximum(points, 1e-6)), 0.125)
        root = inverse_root(precision * np.eye(d) + 2 * (x.T * kappa) @ x)
        mean = root.T @ (root @ pull)
        if step < TANGENT_STEPS:
            points = np.sqrt((x @ mean) ** 2 + ((x @ root.T) ** 2).sum(axis=1))
    heights = kappa * points**2 - np.logaddexp(points / 2, -points / 2)
    fit, volume, prior = float(pull @ mean) / 2, log_det(root) / 2, d * log(precision) / 2
    size = 1 + float(np.abs(heights).sum()) + abs(fit) + abs(volume) + abs(prior)
    return float(heights.sum() + fit - volume + prior - ROUNDING * size)


def _shrunken_fit(x: FloatArray, outcomes: FloatArray, weight_bound: float) -> tuple[float, FloatArray]:
    """The first eta of d / W^2, twice that, ... whose maximiser of l(w) - eta ||w||^2 / 2 is in the ball, and that."""
    d = x.shape[1]
    eta, w = d / weight_bound**2, np.zeros(d)
    for _ in range(MOST_DOUBLINGS):
        w = fit_exact(x, outcomes, eta, w)
        if np.linalg.norm(w) <= weight_bound:
            break
        eta *= 2
    return eta, w


def _log_likelihood(z: FloatArray, outcomes: FloatArray) -> float:
    return -float(outcomes @ np.logaddexp(0, -z) + (1 - outcomes) @ np.logaddexp(0, z))


def _lower_curvature(far: FloatArray) -> FloatArray:
    """2 (e^-r + r - 1) / r^2, rounded down; it falls from 1."""
    r = np.maximum(far, 1e-3)
    value = np.where(far < 1e-3, 1 - far / 3, 2 * (np.expm1(-r) + r) / r**2)
    return np.asarray(value * (1 - ROUNDING))
