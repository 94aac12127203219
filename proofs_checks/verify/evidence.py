r"""The evidence of the answers, from below, in balls (companion G1'): what w* must reach, whatever was asked.

With :math:`\nu` a law of weights fixed before the answers, :math:`\int e^{\ell_t(w) - \ell_t(w^*)} d\nu(w)` is a
nonnegative martingale of mean 1, so that :math:`\ell_t(w^*) \ge \log\int e^{\ell_t}d\nu - \log(1/\delta)` for all t at
once with probability at least :math:`1-\delta`. Here :math:`\nu` is an equal mixture of :math:`N(0, I/\lambda_k)`, and
for each of them and any numbers :math:`\xi_s`, m the integral is bounded by that of a normal law (Jaakkola, Jordan):

.. math:: \log\sigma(z) \ge z/2 - \log(2\cosh(\xi/2)) - \kappa(z^2 - \xi^2), \qquad \kappa = \tanh(\xi/2)/(4\xi),

.. math:: \log\int e^{\ell}d\nu \ge \sum_s\big(\kappa_s(\xi_s^2 - \langle x_s, m\rangle^2) - \log(2\cosh(\xi_s/2)) +
   (o_s - 1/2)\langle x_s, m\rangle\big) - \lambda\|m\|^2/2 - \tfrac12\log\det(A/\lambda), \quad
   A = \lambda I + 2\sum_s\kappa_s x_s x_s^\top .

What finds xi and m is not trusted.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from flint import arb, arb_mat, fmpz_mat

from bridge_theory.arithmetic.flint_balls import Ball, ball, ends
from bridge_theory.errors import ComputationError
from proofs_checks.verify.enclosed import UNIT, Enclosed, FloatArray, enlarged, product
from proofs_checks.verify.features import IntArray

SCALES = (1, 4, 16)
"""Precisions of the mixture in units of d / W^2, which no answer has a say in."""

STEPS = 8
"""How often xi is improved from 0: for the bound any number would do, for a run's claims it is the run's."""

_FLAT = 1e-6
"""Below this xi the coefficient kappa is taken at 0, where it is 1/8."""


@dataclass(frozen=True, eq=False)
class Answers:
    """Answers to questions of different features, each difference once.

    Args:
        differences: (m, d) whole numbers.
        ones, zeros: (m,) how often the answer was 1 and 0.
    """

    differences: IntArray
    ones: IntArray
    zeros: IntArray

    @classmethod
    def counted(cls, differences: IntArray, outcomes: FloatArray) -> Answers:
        """The answers (n,), each 0 or 1, to questions of differences (n, d)."""
        distinct, place = np.unique(differences, axis=0, return_inverse=True)
        place = place.ravel()
        counts = (np.bincount(place[outcomes == answer], minlength=len(distinct)) for answer in (1, 0))
        return cls(distinct, *counts)

    @property
    def total(self) -> IntArray:
        """(m,) answers to each difference."""
        return self.ones + self.zeros

    @cached_property
    def rows(self) -> Any:
        """The differences as balls."""
        return arb_mat(fmpz_mat(self.differences.tolist()))

    def margins(self, w: FloatArray) -> list[Ball]:
        """<x_s, w> of every difference."""
        if not len(self.differences):
            return []
        return list((self.rows * arb_mat(len(w), 1, [arb(value) for value in w.tolist()])).entries())

    def log_likelihood(self, margins: list[Ball]) -> Ball:
        """log P_w of all answers, from the margins of w."""
        parts = zip(margins, self.ones.tolist(), self.zeros.tolist(), strict=True)
        total = arb(0)
        for z, one, zero in parts:
            total -= one * (1 + (-z).exp()).log() + zero * (1 + z.exp()).log()
        return total


def log_evidence(answers: Answers, weight_bound: Fraction) -> Ball:
    """A lower bound on the log of the mixture's evidence; the ball's lower end is one for certain."""
    d = answers.differences.shape[1]
    parts = [_normal_evidence(answers, scale * d / weight_bound**2) for scale in SCALES]
    return (sum((part.exp() for part in parts), start=arb(0)) / len(parts)).log()


def _normal_evidence(answers: Answers, precision: Fraction) -> Ball:
    """The bound for one normal law, at the numbers that :func:`tangents` found."""
    points, m = tangents(answers, float(precision))
    lam, total, kappas = ball(precision), arb(0), []
    margins = answers.margins(m)
    for z, point, one, zero in zip(
        margins, points.tolist(), answers.ones.tolist(), answers.zeros.tolist(), strict=True
    ):
        xi = arb(point)
        kappa = (xi / 2).tanh() / (4 * xi) if point else arb(0.125)
        total += (one + zero) * (kappa * (xi * xi - z * z) - (2 * (xi / 2).cosh()).log()) + (one - zero) * z / 2
        kappas.append((one + zero) * kappa)
    weights = [arb(value) for value in m.tolist()]
    square = sum((weight * weight for weight in weights), start=arb(0))
    return total - lam * square / 2 - _log_det_ratio(answers, kappas, lam) / 2


def _log_det_ratio(answers: Answers, kappas: list[Ball], lam: Ball) -> Ball:
    r"""log det(I + 2 sum kappa_s x_s x_s' / lambda), from above: its upper end.

    For A = lambda I + 2 sum kappa x x' and any L of floats whose image E = L A L' - I is small, log det A is at most
    -2 log det L + d log(1 + ||E||).
    """
    x = answers.differences.astype(np.float64)
    d = x.shape[1]
    # a larger kappa makes a larger matrix: an upper bound; a float of a number is nearer to it than 2 UNIT
    above = np.array([float(kappa.upper()) for kappa in kappas]) * (1 + 8 * UNIT)
    scaled = 2 * above[:, None] * x
    size = float(np.abs(scaled).max(initial=0.0))
    gram = product(Enclosed(x.T.copy(), 0.0), Enclosed(scaled, enlarged(4 * UNIT * size)))
    precision = ends(lam)[1]
    matrix = Enclosed(gram.mid + precision * np.eye(d), 0.0)
    matrix = matrix._replace(rad=enlarged(gram.rad + 2 * UNIT * matrix.size))
    try:
        whitening = np.tril(np.linalg.inv(np.linalg.cholesky((matrix.mid + matrix.mid.T) / 2)))
    except np.linalg.LinAlgError:
        raise ComputationError(f"the evidence's matrix of {d} features is numerically singular") from None
    left = Enclosed(np.ascontiguousarray(whitening), 0.0)
    image = product(product(left, matrix), Enclosed(np.ascontiguousarray(whitening.T), 0.0))
    defect = enlarged(float(np.abs(image.mid - np.eye(d)).sum(axis=1).max()) * (1 + 4 * d * UNIT) + d * image.rad)
    if not (defect < 1 and (np.diag(whitening) > 0).all()):
        raise ComputationError(f"the evidence's matrix of {d} features is too ill-conditioned to be checked")
    log_det = -2 * sum((arb(value).log() for value in np.diag(whitening).tolist()), start=arb(0))
    return log_det + d * (1 + arb(defect)).log() - d * lam.log()


def tangents(answers: Answers, precision: float) -> tuple[FloatArray, FloatArray]:
    """Good numbers xi (m,) and m (d,) for the bound: xi^2 is the second moment of z under the normal law before."""
    x, total = answers.differences.astype(np.float64), answers.total
    pull = (answers.ones - answers.zeros) @ x / 2
    points = np.zeros(len(x))
    for step in range(STEPS + 1):
        covariance = np.linalg.inv(precision * np.eye(x.shape[1]) + 2 * (x.T * (total * slope_of(points))) @ x)
        m = covariance @ pull
        if step < STEPS:
            points = np.sqrt(np.maximum((x @ m) ** 2 + np.einsum("ij,jk,ik->i", x, covariance, x), 0))
    return np.where(points > _FLAT, points, 0.0), m


def slope_of(points: FloatArray) -> FloatArray:
    """kappa = tanh(xi/2) / (4 xi)."""
    safe = np.where(points > _FLAT, points, 1.0)
    return np.asarray(np.where(points > _FLAT, np.tanh(safe / 2) / (4 * safe), 0.125))
