"""``log C(a, b)`` in double precision without the cancellation of three log-gammas, and without SciPy."""

from __future__ import annotations

import numpy as np

from bridge_theory.arithmetic.protocol import FloatArray

_FEW = 16  # from here on six terms of Stirling's series are exact to double precision
_STIRLING = (1 / 12, -1 / 360, 1 / 1260, -1 / 1680, 1 / 1188, -691 / 360360)


def log_binomial(top: FloatArray, bottom: FloatArray) -> FloatArray:
    r"""``log C(top, bottom)`` elementwise for integers ``0 <= bottom <= top``.

    Statement: with ``k = min(bottom, top - bottom)``, for small ``k`` the product
    :math:`\prod_{i\le k}(a-k+i)/i`, otherwise Stirling's formula arranged around the entropy
    :math:`k\log(a/k)+(a-k)\log(a/(a-k))`, which does not cancel.
    Source: elementary. Arguments: arrays that broadcast. Returns float64, relative error a few ulps. Errors: none.

    >>> float(log_binomial(np.float64(10), np.float64(3)) - np.log(120.0))
    0.0
    """
    top, bottom = np.broadcast_arrays(np.asarray(top, dtype=np.float64), np.asarray(bottom, dtype=np.float64))
    few = np.minimum(bottom, top - bottom)
    largest = float(few.max(initial=0.0))
    if largest < _FEW:
        return _product(top, few, int(largest))
    is_small = few < _FEW
    entropy = _stirling(np.where(is_small, 2.0 * _FEW, top), np.where(is_small, _FEW, few))
    return np.where(is_small, _product(top, np.where(is_small, few, 0.0), _FEW), entropy)


def _product(top: FloatArray, few: FloatArray, largest: int) -> FloatArray:
    product = np.ones_like(top)
    for i in range(1, largest + 1):
        product = np.where(i <= few, product * ((top - few + i) / i), product)
    return np.asarray(np.log(product))


def _stirling(top: FloatArray, few: FloatArray) -> FloatArray:
    rest = top - few
    entropy = few * np.log(top / few) - rest * np.log1p(-few / top)
    return np.asarray(entropy + 0.5 * np.log(top / (2 * np.pi * few * rest)) + _tail(top) - _tail(few) - _tail(rest))


def _tail(x: FloatArray) -> FloatArray:
    inverse_square = 1 / (x * x)
    total = np.zeros_like(x)
    for coefficient in reversed(_STIRLING):
        total = total * inverse_square + coefficient
    return np.asarray(total / x)
