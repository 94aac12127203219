"""Confidence intervals of what the studies count."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bridge_algos.mdp import FloatArray


def clopper_pearson(successes: ArrayLike, trials: int, level: float = 0.95) -> tuple[FloatArray, FloatArray]:
    """Limits of a success probability after independent trials; they enclose it with probability at least ``level``.

    Source: C. Clopper, E. Pearson, "The use of confidence or fiducial limits illustrated in the case of the binomial",
    Biometrika 26 (1934) 404-413. Args: how many of ``trials`` >= 1 trials succeeded, an array or a number. Returns two
    arrays of its shape. The limits are floating-point estimates.

    >>> [round(float(limit), 4) for limit in clopper_pearson(0, 100)]
    [0.0, 0.0362]
    """
    from scipy.stats import beta

    k = np.asarray(successes, dtype=np.float64)
    tail = (1 - level) / 2
    low = np.where(k > 0, beta.ppf(tail, np.maximum(k, 1), trials - k + 1), 0.0)
    high = np.where(k < trials, beta.ppf(1 - tail, k + 1, np.maximum(trials - k, 1)), 1.0)
    return low, high


def share_text(events: ArrayLike, decimals: int = 0) -> str:
    """How often something happened, with its Clopper-Pearson 95 % interval.

    >>> share_text([True, False, True, True])
    '75% [19%, 99%]'
    """
    happened = np.asarray(events)
    low, high = clopper_pearson(happened.sum(), happened.size)
    return f"{happened.mean():.{decimals}%} [{float(low):.{decimals}%}, {float(high):.{decimals}%}]"


def median_interval(values: ArrayLike, level: float = 0.95) -> tuple[float, float]:
    """Limits of the median of a law from independent draws of it, by order statistics (the sign test's interval).

    They enclose the median with probability at least ``level`` whatever the law; the j-th smallest and j-th largest
    draws, with the largest j for which a fair coin's binomial law allows it. Draws may be infinite. With too few draws
    the limits are 0 and infinity, so that draws must not be negative.

    >>> median_interval(range(1, 21)), median_interval([3, 5])
    ((6.0, 15.0), (0.0, inf))
    """
    from scipy.stats import binom

    ordered = np.sort(np.asarray(values, dtype=np.float64))
    allowed = np.flatnonzero(binom.cdf(np.arange(len(ordered)), len(ordered), 0.5) <= (1 - level) / 2)
    if not len(allowed):
        return 0.0, float("inf")
    rank = int(allowed[-1])
    return float(ordered[rank]), float(ordered[len(ordered) - 1 - rank])
