r"""Audit R1 from a log: the data matrix, the solver's error and the radius of the confidence set, in ball arithmetic.

:math:`V = cI + G` with a ball c and the whole-number matrix :math:`G = \sum xx^\top`. No inverse is trusted: any matrix
L of floats will do whose :math:`E = LVL^\top - I` is small, which is checked. Then
:math:`V^{-1} = L^\top(I + E)^{-1}L`, so that :math:`\|x\|_{V^{-1}}` lies within :math:`\|Lx\|/\sqrt{1\pm\varepsilon}`
for any :math:`\varepsilon\ge\|E\|`, and :math:`\log\det V = -2\sum\log L_{ii} + \log\det(I + E)` for triangular L.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from flint import arb, arb_mat, fmpz_mat

from bridge_theory import confidence_radius_repaired, kappa_differences
from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.arithmetic.flint_balls import Ball, ball, ends, midpoint
from bridge_theory.errors import ComputationError
from proofs_checks.verify.enclosed import Enclosed, FloatArray, enlarged, largest_norms, product
from proofs_checks.verify.features import IntArray

_LARGEST_DEFECT = 0.01


@dataclass(frozen=True, eq=False)
class DataMatrix:
    """V with a certified whitening.

    Args:
        whitening: L, (d, d) lower triangular floats.
        defect: eps with ||L V L' - I|| <= eps < 1.
        log_det: log det V.
        scale: c.
    """

    whitening: FloatArray
    defect: float
    log_det: Ball
    scale: Ball

    @property
    def log_det_ratio(self) -> Ball:
        """log(det V / c^d)."""
        return self.log_det - len(self.whitening) * self.scale.log()

    def norm(self, vector: list[Ball]) -> Ball:
        """||x||_{V^-1} of a vector of balls."""
        whitened = arb_mat(self.whitening.tolist()) * arb_mat(len(vector), 1, vector)
        squared = sum((entry * entry for entry in whitened.entries()), start=arb(0))
        spread = ball(1) / (1 + arb(0, self.defect))
        return (squared * spread).max(arb(0)).sqrt()

    def whitened(self, features: Enclosed) -> Enclosed:
        """L x of the rows."""
        return product(features, Enclosed(np.ascontiguousarray(self.whitening.T), 0.0))

    def largest_norms(self, whitened: Enclosed) -> FloatArray:
        """Upper bounds on ||x||_{V^-1} from the rows L x."""
        return np.asarray(largest_norms(whitened) * enlarged(1 / np.sqrt(1 - self.defect)))


def data_matrix(scale: Ball, gram: IntArray) -> DataMatrix:
    """V = scale I + gram, with its whitening checked in ball arithmetic.

    Raises:
        ComputationError: when the matrix is too ill-conditioned for double precision.
    """
    d = len(gram)
    rounded = gram + midpoint(scale) * np.eye(d)
    try:
        whitening = np.tril(np.linalg.inv(np.linalg.cholesky(rounded)))
    except np.linalg.LinAlgError:
        raise ComputationError(
            f"the data matrix of {d} features is numerically singular; lambda is too small"
        ) from None
    left, exact = arb_mat(whitening.tolist()), arb_mat(fmpz_mat(gram.tolist()))
    for i in range(d):
        exact[i, i] += scale
    image = left * exact * left.transpose()
    defect = max(ends(sum((abs(image[i, j] - int(i == j)) for j in range(d)), start=arb(0)))[1] for i in range(d))
    if not (defect <= _LARGEST_DEFECT and (np.diag(whitening) > 0).all()):
        raise ComputationError(f"the data matrix of {d} features is too ill-conditioned to be checked")
    log_det = -2 * sum((arb(x).log() for x in np.diag(whitening).tolist()), start=arb(0))
    return DataMatrix(whitening, defect, log_det + d * (1 + arb(0, defect)).log(), scale)


def certified_scale(bound: Ball, weight_bound: Ball, lam: Ball) -> Ball:
    """kappa lambda with kappa = 2 + 2 cosh(2BW), the scale of R1's data matrix."""
    return kappa_differences(BALLS, B=bound, W=weight_bound) * lam


def solver_error(
    matrix: DataMatrix, differences: IntArray, outcomes: FloatArray, w: FloatArray, lam: Ball, slope: Ball
) -> Ball:
    r"""e(w) = ||g(w) - sum o x||_{V^-1} with g(w) = sum sigma(<x, w>) x + lambda w and x = slope * difference."""
    weights = [arb(value) for value in w.tolist()]
    residual = [lam * value for value in weights]
    if len(differences):
        x = arb_mat(fmpz_mat(differences.tolist()))
        utilities = (x * arb_mat(len(weights), 1, weights)).entries()
        surprise = [1 / (1 + (-slope * u).exp()) - arb(o) for u, o in zip(utilities, outcomes.tolist(), strict=True)]
        pulled = (x.transpose() * arb_mat(len(surprise), 1, surprise)).entries()
        residual = [value + slope * pull for value, pull in zip(residual, pulled, strict=True)]
    return matrix.norm(residual)


def radius(matrix: DataMatrix, error: Ball, bound: Ball, weight_bound: Ball, lam: Ball, delta: Ball) -> Ball:
    """rho_t(w) of audit R1, for any w of norm at most W."""
    return confidence_radius_repaired(
        BALLS, B=bound, W=weight_bound, lam=lam, delta_w=delta, log_det_ratio=matrix.log_det_ratio, residual=error
    )
