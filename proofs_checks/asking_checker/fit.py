"""A normal law near the posterior of the weights, by fixed-point steps in floats: a hint, which nothing trusts."""

from __future__ import annotations

import numpy as np

from proofs_checks.verify.enclosed import FloatArray
from proofs_checks.verify.features import IntArray

NODES, MASSES = np.polynomial.hermite_e.hermegauss(24)
MASSES = MASSES / MASSES.sum()


def sigmoid(z: FloatArray) -> FloatArray:
    """1 / (1 + e^-z), without overflow."""
    return np.asarray(0.5 * (1 + np.tanh(z / 2)))


def log_sigmoid(z: FloatArray) -> FloatArray:
    """Its logarithm, without overflow."""
    return np.asarray(np.minimum(z, 0.0) - np.log1p(np.exp(-np.abs(z))))


def fitted_normal(
    x: FloatArray, ones: IntArray, zeros: IntArray, precision: float, steps: int = 60
) -> tuple[FloatArray, FloatArray]:
    """Mean and lower-triangular root L of the covariance L L' of a normal law with high evidence.

    Args:
        x, ones, zeros: (m, d) differences, (m,) counts of their answers.
        precision: of the prior N(0, I / precision).
        steps: at most.
    """
    d, total = x.shape[1], ones + zeros
    mean, covariance = np.zeros(d), np.eye(d) / precision
    kept, best = (mean, np.asarray(np.linalg.cholesky(covariance))), -np.inf
    for _ in range(steps):
        mu, s = x @ mean, np.sqrt(np.maximum(np.vecdot(x @ covariance, x), 0))
        z = mu[:, None] + s[:, None] * NODES
        p = sigmoid(z)
        root = np.asarray(np.linalg.cholesky(covariance))
        value = (
            ones @ (log_sigmoid(z) @ MASSES)
            + zeros @ (log_sigmoid(-z) @ MASSES)
            - 0.5
            * (
                precision * ((root**2).sum() + mean @ mean)
                - d * (1 + np.log(precision))
                - 2 * np.log(np.diag(root)).sum()
            )
        )
        gain = value - best
        if gain > 0:
            kept, best = (mean, root), value
        if gain < 1e-7 and np.isfinite(gain):
            break
        curvature = total * ((p * (1 - p)) @ MASSES)
        inverse = np.linalg.inv((x.T * curvature) @ x + precision * np.eye(d))
        covariance = np.asarray((inverse + inverse.T) / 2)
        step = covariance @ (x.T @ (ones - total * (p @ MASSES)) - precision * mean)
        mean = mean + step * min(1.0, 4.0 / max(float(np.abs(x @ step).max(initial=0.0)), 1e-12))
    return kept
