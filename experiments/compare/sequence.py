r"""Confidence sequences for the mean of bounded variables: intervals that are valid for every sample size at once.

The hedged capital process of I. Waudby-Smith and A. Ramdas, "Estimating means of bounded random variables by betting",
Journal of the Royal Statistical Society B 86 (2024) 1-27, theorem 3. For independent :math:`X_i \in [0, 1]` of mean
:math:`\mu` and bets :math:`\lambda_i` that depend on :math:`X_1, ..., X_{i-1}` alone,

.. math:: K^+_m(\mu) = \prod_{i\le m} (1 + \lambda^+_i(\mu) (X_i - \mu)), \qquad
   K^-_m(\mu) = \prod_{i\le m} (1 - \lambda^-_i(\mu) (X_i - \mu))

are nonnegative martingales, so that by Ville's inequality :math:`(K^+ + K^-) / 2` never reaches 1/alpha, with
probability at least 1 - alpha. What is excluded below is only what one half alone excludes. Both are monotone in
:math:`\mu`, so that the set is an interval.
"""

from __future__ import annotations

import numpy as np

from bridge_algos.mdp import FloatArray
from bridge_theory.errors import InputError

LARGEST_BET = 0.75
"""Fraction of the capital that a bet may lose at worst."""

_HALVINGS = 50


def confidence_sequence(
    values: FloatArray, low: FloatArray | float, high: FloatArray | float, alpha: float = 0.05
) -> tuple[FloatArray, FloatArray]:
    r"""Lower and upper end of the interval for the mean after all m observations.

    Statement: for independent observations of one mean in [low, high], with probability at least 1 - alpha the interval
    contains that mean for every m at once: one may look, add observations and look again. Each column has its own
    interval, and the statement holds for each column, not for all columns together.

    Args:
        values: (m, ...) observations in order; m >= 1.
        low, high: the known range, one number or one a column; equal where the value is known.
        alpha: in (0, 1).

    Returns:
        Two arrays of shape (...).

    Raises:
        InputError: for an observation outside the range, which would void the statement, or an alpha outside (0, 1).

    >>> lower, upper = confidence_sequence(np.array([0.25] * 100), 0.0, 1.0)
    >>> bool(lower < 0.25 < upper), float(np.round(upper - lower, 2))
    (True, 0.05)
    """
    low, high = (np.broadcast_to(np.asarray(end, dtype=np.float64), values.shape[1:]) for end in (low, high))
    slack = 1e-9 * (1 + np.abs(low) + np.abs(high))
    if not 0 < alpha < 1:
        raise InputError(f"alpha is {alpha}, expected a number strictly between 0 and 1.")
    if (
        not len(values)
        or not np.isfinite(values).all()
        or (values < low - slack).any()
        or (values > high + slack).any()
    ):
        raise InputError("a confidence sequence needs observations, all of them inside the range that is known.")
    width = np.where(high > low, high - low, 1.0)
    x = np.clip((values - low) / width, 0, 1)
    bets = _bets(x, alpha)
    lower, upper = _lower_end(x, bets, alpha), 1 - _lower_end(1 - x, bets, alpha)
    known = high <= low
    return np.where(known, low, low + width * lower), np.where(known, high, low + width * upper)


def _bets(x: FloatArray, alpha: float) -> FloatArray:
    """The bets that the authors propose, from the running mean and variance before each observation."""
    index = np.arange(1, len(x) + 1).reshape(-1, *[1] * (x.ndim - 1))
    means = (0.5 + np.cumsum(x, axis=0)) / (index + 1)
    variances = (0.25 + np.cumsum((x - means) ** 2, axis=0)) / (index + 1)
    before = np.concatenate([np.full((1, *x.shape[1:]), 0.25), variances[:-1]])
    return np.asarray(np.sqrt(2 * np.log(2 / alpha) / (before * index * np.log1p(index))))


def _lower_end(x: FloatArray, bets: FloatArray, alpha: float) -> FloatArray:
    """The largest mean found by bisection below which every mean has been excluded; 0 when none has."""
    excluded, open_ = np.zeros(x.shape[1:]), np.ones(x.shape[1:])
    for _ in range(_HALVINGS):
        middle = (excluded + open_) / 2
        gain = 1 + np.minimum(bets, LARGEST_BET / middle) * (x - middle)
        reached = np.cumsum(np.log(gain), axis=0).max(axis=0) >= np.log(2 / alpha) + 1e-9
        excluded, open_ = np.where(reached, middle, excluded), np.where(reached, open_, middle)
    return excluded
