r"""How far the mean of n independent random vectors can be from their expectation, in norm.

For vectors y with ||y|| <= b surely and :math:`L = \log(3/\delta)`, with probability at least :math:`1 - \delta`

.. math:: \|\bar y - E y\| \le \sqrt{s/n} + \sqrt{2 L (\lambda + 2 c \sqrt{s/n})/n} + c L / (3 n), \qquad
          c = b + \sqrt s,

where s bounds :math:`E\|y\|^2` and lambda the largest eigenvalue of :math:`E y y^T`, both computed from the sample.

Proof. (1) A variable X in [0, a] has :math:`P(\bar X \le EX - t) \le \exp(-n t^2 / (2 E X^2))` and :math:`E X^2 \le
a\,E X`; solving for EX gives :func:`expectation_bound`, which fails with probability :math:`e^{-L}`. Take
:math:`X = \|y\|^2` for s; for lambda take :math:`X = \langle q, y\rangle^2` with q the unknown top eigenvector, whose
sample mean is at most the sample's largest eigenvalue. (2) The centred sums :math:`\langle q, \sum (y_i - Ey)\rangle`
over unit vectors q have variance at most n lambda and are at most c a term, since :math:`\|Ey\| \le \sqrt s`; the
expectation of their largest, :math:`E\|\sum (y_i - Ey)\|`, is at most :math:`\sqrt{n s}`. Bousquet's inequality (2002)
bounds the largest. QED

A vector that is zero except in a share p of the draws has s and lambda at most p b^2: rare differences are cheap.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import beta

from bridge_algos.mdp import FloatArray

ROUNDING = 1 + 1e-9
"""Factor by which every bound is raised, more than what the rounding of its sums can hide."""


def expectation_bound(mean: FloatArray, largest: float, log_chance: float, n: int) -> FloatArray:
    """Upper bounds on expectations of variables in [0, largest], each failing with probability exp(-log_chance).

    Args:
        mean: sample means of n independent draws, any shape.

    >>> expectation_bound(np.array([0.0, 0.1]), 1.0, 3.0, 1000).round(4)
    array([0.006 , 0.1277])
    """
    half = largest * log_chance / (2 * n)
    return np.asarray((np.sqrt(half) + np.sqrt(half + mean)) ** 2 * ROUNDING)


def norm_radius(trace: FloatArray, top: FloatArray, reach: float, log_chance: float, n: int) -> FloatArray:
    """Bounds on the distance of a mean vector from its expectation; each fails with probability 3 exp(-log_chance).

    Args:
        trace: sample means of ||y||^2, any shape.
        top: largest eigenvalues of the sample means of y y', or anything larger, such as ``trace``.
        reach: b.
        log_chance: L.
        n: number of vectors, fixed before they were drawn.

    >>> norm_radius(np.array([0.2]), np.array([0.05]), 5.0, 8.0, 10_000).round(4)
    array([0.0241])
    """
    s = expectation_bound(trace, reach**2, log_chance, n)
    top_bound = np.minimum(s, expectation_bound(top, reach**2, log_chance, n))
    expected, largest = np.sqrt(s / n), reach + np.sqrt(s)
    spread = np.sqrt(2 * log_chance * (top_bound + 2 * largest * expected) / n)
    return np.asarray((expected + spread + largest * log_chance / (3 * n)) * ROUNDING)


def mean_radius(square: FloatArray, reach: float, log_chance: float, n: int) -> FloatArray:
    """Bounds on the distance of a mean number from its expectation; each fails with probability 3 exp(-log_chance).

    Bernstein's inequality on both sides, with the second moment bounded by :func:`expectation_bound`.

    Args:
        square: sample means of the squares of n independent draws of absolute value at most ``reach``, any shape.

    >>> mean_radius(np.array([0.2]), 5.0, 8.0, 10_000).round(4)
    array([0.0238])
    """
    s = expectation_bound(square, reach**2, log_chance, n)
    largest = reach + np.sqrt(s)
    return np.asarray((np.sqrt(2 * s * log_chance / n) + largest * log_chance / (3 * n)) * ROUNDING)


def chance_bound(events: int, n: int, delta: float) -> float:
    """The upper end of Clopper and Pearson's interval: exceeded by the true chance with probability at most delta.

    >>> round(chance_bound(0, 1000, 0.05), 5)
    0.00299
    """
    return 1.0 if events >= n else float(beta.ppf(1 - delta, events + 1, n - events)) * ROUNDING
