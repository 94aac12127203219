r"""The interval of a mean over seeds, inside the range of what is averaged.

For a quantity without a range it is Student's. For one in [low, high] it is Student's on the scale of
:math:`g(m) = \log(m - low) - \log(high - m)` (one of the logarithms where one end is infinite), carried back: the delta
method gives :math:`g` the standard error :math:`g'(m)\,se(m)`. It cannot leave the range, it is Student's where the
standard error is small beside the distance to the ends, and it is the usual one for means of positive quantities and
of shares (W. Meeker, G. Hahn, L. Escobar, "Statistical Intervals", 2nd ed., 2017).
"""

from __future__ import annotations

import numpy as np
import scipy.stats
from numpy.typing import ArrayLike

from bridge_algos.given import checked
from bridge_algos.mdp import FloatArray
from bridge_theory.errors import InputError

SHOWN_SEEDS = 5
"""Fewer seeds than these are shown one by one: an interval would say more about Student's law than about them."""

ROUNDING = 1e-9
"""How far a mean may lie outside its range, relative to the size of both, by rounding alone."""


@checked
def interval(
    values: ArrayLike, low: ArrayLike = -np.inf, high: ArrayLike = np.inf, level: float = 0.95
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mean and the ends of its interval over the first axis, whose entries are independent seeds.

    Args:
        values: (seeds, ...) numbers.
        low, high: ends of the range of a value, numbers or arrays of the shape of one seed's values.
        level: of the interval, which is approximate.

    Returns:
        Three arrays of the shape of one seed's values; the ends are those of the range for one seed.

    Raises:
        InputError: for a mean outside the range.

    >>> [round(float(end), 2) for end in interval([1.0, 0.0, 9.0, 2.0, 3.0], low=0)]
    [3.0, 0.69, 12.96]
    >>> [round(float(end), 2) for end in interval([1.0, 0.0, 9.0, 2.0, 3.0])]
    [3.0, -1.39, 7.39]
    """
    given = [np.asarray(part) for part in (values, low, high)]
    if any(part.dtype.kind not in "iuf" or np.isnan(part).any() for part in given) or not np.isfinite(given[0]).all():
        raise InputError("values must hold finite numbers, and low and high numbers; give the numbers of the seeds.")
    data = given[0].astype(np.float64)
    mean = data.mean(axis=0)
    low, high = (np.broadcast_to(end.astype(np.float64), mean.shape) for end in given[1:])
    slack = ROUNDING * (1 + np.abs(mean))
    if ((mean < low - slack) | (mean > high + slack)).any():
        raise InputError("a mean lies outside the range given for its values; give the range of the quantity.")
    if len(data) < 2:
        return mean, low.copy(), high.copy()
    reach = scipy.stats.t.ppf((1 + level) / 2, len(data) - 1) * data.std(axis=0, ddof=1) / np.sqrt(len(data))
    return mean, *_within(mean, reach, low, high)


def _within(mean: FloatArray, reach: FloatArray, low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
    below, above = np.maximum(mean - low, 0.0), np.maximum(high - mean, 0.0)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        slope = 1 / below + 1 / above  # g'(m); zero where both ends are infinite
        factor = np.exp(slope * reach)
        ratio = below / above  # exp(g), where both ends are finite
        both = [low + (high - low) * odds / (1 + odds) for odds in (ratio / factor, ratio * factor)]
        both[1] = np.where(np.isfinite(ratio * factor), both[1], high)
        ends = [
            np.where(
                np.isinf(low) & np.isinf(high),
                mean + sign * reach,
                np.where(
                    np.isinf(high),
                    low + below * factor**sign,
                    np.where(np.isinf(low), high - above * factor**-sign, both[(sign + 1) // 2]),
                ),
            )
            for sign in (-1, 1)
        ]
    certain = (reach == 0) | (below == 0) | (above == 0)
    lower, upper = (np.where(certain, mean, end) for end in ends)
    return np.asarray(lower), np.asarray(upper)
