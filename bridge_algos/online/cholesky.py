r"""Norms in the inverse of a positive definite matrix, through its Cholesky factor.

With :math:`V = L L^T` the vector :math:`L^{-1} x` has the Euclidean norm :math:`\|x\|_{V^{-1}}`. LAPACK is called
directly: for the small matrices of a round the checks around it would take most of the time.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack

from bridge_algos.mdp import FloatArray
from bridge_theory.errors import ComputationError


def inverse_root(matrix: FloatArray) -> FloatArray:
    """The inverse of the lower Cholesky factor of a symmetric positive definite matrix, both (d, d).

    Raises:
        ComputationError: when the matrix is not positive definite to rounding.

    >>> inverse_root(np.diag([4.0, 16.0])).diagonal()
    array([0.5 , 0.25])
    """
    root, failed = lapack.dpotrf(matrix, lower=1, clean=1)
    if failed:
        raise ComputationError("the data matrix is not positive definite to rounding; use a larger lambda.")
    return np.asarray(lapack.dtrtri(root, lower=1)[0])


def solve(matrix: FloatArray, vector: FloatArray) -> FloatArray:
    """The solution v of ``matrix v = vector`` for a symmetric positive definite matrix.

    Raises:
        ComputationError: when the matrix is not positive definite to rounding.

    >>> solve(np.diag([4.0, 16.0]), np.array([2.0, 4.0]))
    array([0.5 , 0.25])
    """
    _, solution, failed = lapack.dposv(matrix, vector, lower=1)
    if failed:
        raise ComputationError("a matrix is not positive definite to rounding; use a larger lambda.")
    return np.asarray(solution)


def log_det(inverse: FloatArray) -> float:
    """The logarithm of the determinant of the matrix whose :func:`inverse_root` is given.

    >>> bool(np.isclose(log_det(inverse_root(np.diag([4.0, 16.0]))), np.log(64)))
    True
    """
    return -2 * float(np.log(inverse.diagonal()).sum())
