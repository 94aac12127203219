"""The paper's offline ablation table as data, and how well another table agrees with it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib.resources import files

import numpy as np
import xarray as xr
from scipy.stats import spearmanr
from scipy.stats import t as student

from bridge_algos.mdp import FloatArray

RUNS = 100
"""Each published cell is a mean over so many runs."""

QUANTILE = float(student.ppf(0.975, RUNS - 1))
"""95 % half-width of such a mean, in standard errors."""

ROUNDING = 0.05
"""The published means have one decimal."""


@dataclass(frozen=True)
class Agreement:
    """How a table of shares (in percent) lies beside the published one.

    Args:
        rmse: root mean square difference of the cells, in percentage points.
        rank_correlation: Spearman's, NaN where all our cells are equal.
        overlapping: cells whose 95 % intervals overlap; none where ours, of one seed, has no interval.
        cells: cells compared.
    """

    rmse: float
    rank_correlation: float
    overlapping: int
    cells: int


def published(data: xr.Dataset) -> tuple[FloatArray, FloatArray]:
    """Published mean and plus-minus of each cell of ``data``, in percent; NaN where the table has no such cell."""
    record = json.loads(files("experiments").joinpath("data/published_table.json").read_text())
    table = {
        (noise, n): (mean, spread)
        for noise, means, spreads in zip(record["noise"], record["mean"], record["plus_minus"], strict=True)
        for n, mean, spread in zip(record["demonstrations"], means, spreads, strict=True)
    }
    pairs = zip(data.noise.values.tolist(), data.demonstrations.values.tolist(), strict=True)
    found = np.array([table.get(pair, (np.nan, np.nan)) for pair in pairs])
    return found[:, 0], found[:, 1]


def half_width(spread: FloatArray) -> FloatArray:
    """95 % half-width of a published mean, the plus-minus read as a standard deviation over the runs."""
    return np.asarray(QUANTILE * spread / np.sqrt(RUNS) + ROUNDING)


def agreement(mean: FloatArray, half: FloatArray, data: xr.Dataset) -> Agreement:
    """Ours, with 95 % half-widths, against the published table, over the cells that it has."""
    theirs, spread = published(data)
    here = np.isfinite(theirs)
    ours, gap = mean[here], np.abs(mean - theirs)[here]
    constant = np.ptp(ours) == 0
    return Agreement(
        rmse=float(np.sqrt(np.mean(gap**2))),
        rank_correlation=np.nan if constant else float(spearmanr(ours, theirs[here]).statistic),
        overlapping=int((np.isfinite(half[here]) & (gap <= (half + half_width(spread))[here])).sum()),
        cells=int(here.sum()),
    )


def least_deviation(mean: FloatArray, ceiling: float) -> FloatArray:
    r"""Least standard deviation, as a fraction, of shares in :math:`[0,c]\cup\{100\}` percent with the given means.

    From :math:`(x-c)(100-x)\le0` on that set: :math:`\operatorname{Var}X\ge(m-c)(100-m)`. The means are taken as
    rounded: the least over everything that they may stand for.

    >>> least_deviation(np.array([60.0, 100.0]), 20.0).round(3)
    array([0.4, 0. ])
    """
    ends = [np.minimum(mean + shift, 100) for shift in (-ROUNDING, ROUNDING)]
    variances = [np.maximum((m - ceiling) * (100 - m), 0.0) for m in ends]  # concave, least at an end
    return np.asarray(np.sqrt(np.minimum(*variances)) / 100)
