r"""The ellipsoid of a run with ``confidence="likelihood"`` (companion G5), written down a second time.

It serves to contradict the run's claims: no bound of a certificate uses it. With :math:`\hat w` the maximiser of
:math:`\ell(w) - \eta\|w\|^2/2`, :math:`\eta` the first of :math:`d/W^2, 2d/W^2, 4d/W^2, \dots` for which it is in
the ball, and :math:`r_s` from the enclosure of each :math:`\langle x_s, w
\rangle` so far, :math:`A = \sum_s\sigma'(z_s)\,2(e^{-r_s} + r_s - 1)/r_s^2\,x_sx_s^\top + \eta I` and

.. math:: \rho^2 = 2(\ell(\hat w) - Q + \log(1/\delta)) + \eta(W^2 - \|\hat w\|^2) .
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from proofs_checks.verify.enclosed import FloatArray
from proofs_checks.verify.evidence import SCALES, STEPS, slope_of

PASSES = 4


class Around(NamedTuple):
    """The weights w with (w - center)' matrix (w - center) <= radius^2, around those of log-likelihood >= level."""

    center: FloatArray
    matrix: FloatArray
    radius: float
    level: float


def ellipsoid_around(x: FloatArray, outcomes: FloatArray, weight_bound: float, delta: float) -> Around:
    """The ellipsoid after the answers (m,) to differences (m, d); the ball of all weights where nothing is left."""
    d = x.shape[1]
    unit = d / weight_bound**2
    eta, w = unit, _fit(x, outcomes, unit)
    while np.linalg.norm(w) > weight_bound and eta < unit * 2.0**59:
        eta *= 2
        w = _fit(x, outcomes, eta)
    z = x @ w
    likelihood = float(np.sum(outcomes * _log_sigmoid(z) + (1 - outcomes) * _log_sigmoid(-z)))
    evidence = np.logaddexp.reduce([_evidence(x, outcomes, k * unit) for k in SCALES]) - np.log(len(SCALES))
    level = float(evidence + np.log(delta))
    square = 2 * (likelihood - level) + eta * (weight_bound**2 - w @ w)
    if square < 0:
        return Around(np.zeros(d), np.eye(d), weight_bound, level)
    reach = weight_bound * np.linalg.norm(x, axis=1)
    intervals = np.stack([-reach, reach])
    for _ in range(PASSES):
        r = np.maximum(np.abs(intervals - z).max(axis=0), 1e-4)
        weights = np.exp(_log_sigmoid(z) + _log_sigmoid(-z)) * 2 * (np.expm1(-r) + r) / r**2
        matrix = x.T @ (weights[:, None] * x) + eta * np.eye(d)
        width = np.sqrt(square * np.einsum("si,si->s", x, np.linalg.solve(matrix, x.T).T))
        intervals = np.stack([np.maximum(intervals[0], z - width), np.minimum(intervals[1], z + width)])
    return Around(w, matrix, float(np.sqrt(square)), level)


def _evidence(x: FloatArray, outcomes: FloatArray, precision: float) -> float:
    """Jaakkola and Jordan's bound on the log evidence under N(0, I / precision), after STEPS improvements from 0."""
    d, points = x.shape[1], np.zeros(len(x))
    pull = x.T @ (outcomes - 0.5)
    for step in range(STEPS + 1):
        kappa = slope_of(points)
        matrix = precision * np.eye(d) + 2 * x.T @ (kappa[:, None] * x)
        m = np.linalg.solve(matrix, pull)
        if step < STEPS:
            points = np.sqrt((x @ m) ** 2 + np.einsum("si,si->s", x, np.linalg.solve(matrix, x.T).T))
    heights = kappa * points**2 - np.logaddexp(points / 2, -points / 2)
    return float(heights.sum() + pull @ m / 2 - (np.linalg.slogdet(matrix)[1] - d * np.log(precision)) / 2)


def _fit(x: FloatArray, outcomes: FloatArray, eta: float) -> FloatArray:
    """The maximiser of l(w) - eta ||w||^2 / 2, by Newton steps that are halved until they gain."""

    def height(w: FloatArray) -> float:
        z = x @ w
        return float(np.sum(outcomes * _log_sigmoid(z) + (1 - outcomes) * _log_sigmoid(-z)) - eta * (w @ w) / 2)

    w = np.zeros(x.shape[1])
    for _ in range(60):
        p = np.exp(_log_sigmoid(x @ w))
        gradient = x.T @ (outcomes - p) - eta * w
        step = np.linalg.solve(x.T @ ((p * (1 - p))[:, None] * x) + eta * np.eye(len(w)), gradient)
        rise, length = float(gradient @ step), 1.0
        if rise < 1e-20:
            break
        while height(w + length * step) < height(w) and length > 1e-3 and rise > 1e-12:
            length /= 2
        w = w + length * step
    return w


def _log_sigmoid(z: FloatArray) -> FloatArray:
    return np.asarray(-np.logaddexp(0, -z))
