"""The ladder of radii as a figure and in words."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr
from scipy.stats import quantile_test

from bridge_algos.mdp import FloatArray
from bridge_algos.run.interval import interval
from bridge_algos.run.plots import finish
from bridge_theory.cli.table import text_table
from experiments.intervals import clopper_pearson

STYLES: dict[str, dict[str, Any]] = {
    "zero": {"label": "zero (T8A)", "color": "#AAAAAA", "linewidth": 4.5},
    "leaving": {"label": "from data (T8B), 95 % quantile", "color": "#E69F00", "linewidth": 3},
    "stated": {"label": "stated", "color": "#D55E00"},
    "corollaries": {"label": "stated, with its corollaries' 6", "color": "#D55E00", "linestyle": (0, (4, 2))},
    "repaired": {"label": "repaired (T9)", "color": "#0072B2"},
    "sharp": {"label": "repaired, angle form", "color": "#0072B2", "linestyle": (0, (4, 2))},
    "data": {"label": "from data (T9, T10), median", "color": "#009E73"},
    "hand": {"label": "hand-set, published", "color": "#000000", "linestyle": (0, (1, 1.2))},
    "expert": {"label": "expert's distance, 95 % quantile", "color": "#CC79A7", "marker": "o", "markersize": 2.5},
}
"""Okabe-Ito colours; a dashed line is a variant of the solid one of its colour, wide lines lie below others."""

SMALLEST = 0.01
"""Below this the radius axis is linear, so that zero can be shown."""


def upper_quantile(values: FloatArray, level: float = 0.95) -> tuple[float, float, float]:
    """A quantile of distances over independent data sets with its distribution-free 95 % interval.

    The interval comes from order statistics; with too few data sets for one of its ends, that end is 0 or 1.
    """
    interval = quantile_test(values, p=level).confidence_interval(0.95)
    low, high = float(interval.low), float(interval.high)
    return float(np.quantile(values, level)), 0.0 if np.isnan(low) else low, 1.0 if np.isnan(high) else high


def figure(data: xr.Dataset) -> Any:
    """Radii above, the share of policies kept below, both against the number of demonstrations."""
    from matplotlib.figure import Figure

    picture = Figure(figsize=(4.2, 5.6), layout="constrained")
    radii, shares = picture.subplots(2, 1, sharex=True, height_ratios=(1.25, 1))
    n = np.asarray(data.demonstrations)
    for key, style in STYLES.items():
        radii.plot(n, _typical(data, key), **{"linewidth": 1.4, **style})
        kept = np.asarray(data.share.sel(rung=key).mean("counted"))
        shares.plot(n, 100 * kept, **{"linewidth": 1.4, **style})
    _draw_quantile_errors(radii, data)
    _mark_first(radii, data)
    radii.axhline(1, color="#444444", linewidth=0.7)
    radii.set_yscale("symlog", linthresh=SMALLEST, linscale=0.4)
    radii.set_yticks([0, *10.0 ** np.arange(-2, 1 + np.ceil(np.log10(radii.get_ylim()[1])))])
    radii.set(ylim=(-SMALLEST / 4, None), ylabel="radius (Hellinger distance)")
    radii.set_title(f"{data.attrs['environment']} (radius 1 keeps every policy)", fontsize=9)
    shares.set(xscale="log", yscale="log", xlim=(n[0], n[-1]), xlabel="demonstrations n")
    shares.set(ylabel="policies in the ball (%)", ylim=(None, 300))
    for axes in (radii, shares):
        finish(axes)
        axes.minorticks_off()
    handles, labels = radii.get_legend_handles_labels()
    picture.legend(handles, labels, loc="outside lower center", ncols=2, fontsize=7.5, frameon=False)
    return picture


def _typical(data: xr.Dataset, key: str) -> FloatArray:
    values = data.radius.sel(rung=key)
    return np.asarray(values.quantile(0.95, "dataset") if key in ("leaving", "expert") else values.median("dataset"))


def _draw_quantile_errors(axes: Any, data: xr.Dataset) -> None:
    distances = data.radius.sel(rung="expert").transpose("demonstrations", "dataset").values
    limits = np.array([upper_quantile(row) for row in distances])
    errors = np.abs(limits[:, 1:] - limits[:, :1]).T
    axes.errorbar(data.demonstrations, limits[:, 0], errors, fmt="none", ecolor="#CC79A7", elinewidth=0.8)


def _mark_first(axes: Any, data: xr.Dataset) -> None:
    """A dot where a formula first reaches 1, with the number of demonstrations, in the free place beside its line."""
    for key, shift, height, side in (("stated", 0.7, 0.3, "right"), ("repaired", 1.2, 1.7, "left")):
        n = json.loads(data.attrs["first"])[key]["informative"]
        axes.plot([n], [1], "o", color=STYLES[key]["color"], markersize=3.5)
        axes.annotate(f"n = {n:,}", (n * shift, height), fontsize=7.5, ha=side, color=STYLES[key]["color"])


def report(data: xr.Dataset) -> str:
    """The whole text."""
    return "\n\n".join((_setting(data), _formulas(data), _from_data(data), _hand_set(data), _reading(data)))


def _setting(data: xr.Dataset) -> str:
    about = data.attrs
    return (
        f"{about['environment']}, S = {about['states']}, A = {about['actions']}, H = {about['horizon']}, delta = "
        f"{about['delta']:g}, gamma_min = {about['gamma_min']:.3g} (smallest positive occupancy of the expert under "
        f"the real dynamics). {about['expert']}\n"
        f"Radii are Hellinger distances, not squared; from 1 on the ball keeps all {about['actions']}^"
        f"{about['states']} deterministic stationary policies. The ball and the expert's distance are taken under the "
        f"estimated dynamics: pooled counts, {about['empty_row'].replace('_', '-')} rows without data, the known first "
        f"state. {data.sizes['dataset']:,} data sets for each n; shares are exact counts, averaged over "
        f"{data.sizes['counted']} of them."
    )


def _formulas(data: xr.Dataset) -> str:
    first = json.loads(data.attrs["first"])
    hand = data.attrs["hand_radius"]
    rows = [(row["text"], f"{row['informative']:,}", f"{row['hand']:,}") for row in first.values()]
    table = text_table(("a-priori radius", "below 1 from n =", f"at most {hand:g} from n ="), rows)
    certificates = " ".join(row["words"] for row in first.values())
    return f"Radii from formulas (certified by enclosures at n and n - 1):\n{table}\n{certificates}"


def _from_data(data: xr.Dataset) -> str:
    header = ("n", "expert outside 0", "expert: median", "95 % quantile", "T8(B): 95 %", "T9+T10: median", "below 1 in")
    rows = []
    for n in data.demonstrations.values:
        radius = data.radius.sel(demonstrations=n)
        distance = radius.sel(rung="expert").values
        quantile, low, high = upper_quantile(distance)
        rows.append(
            (
                f"{n:,}",
                _percent(distance > 0),
                f"{np.median(distance):.3g}",
                f"{quantile:.3g} [{low:.3g}, {high:.3g}]",
                f"{np.quantile(radius.sel(rung='leaving'), 0.95):.3g}",
                f"{float(radius.sel(rung='data').median()):.3g}",
                _percent(radius.sel(rung="data").values < 1),
            )
        )
    missed = (data.radius.sel(rung="expert") > data.radius.sel(rung="data") + 1e-9).values
    return (
        "Over the data sets (95 % intervals: order statistics for the quantile, Clopper-Pearson for frequencies):\n"
        f"{text_table(header, rows)}\n"
        f"The T9 + T10 radius missed the expert in {missed.sum()} of {missed.size} data sets (allowed: a share of "
        f"{data.attrs['delta']:g}). Under the closed estimate (self-loops, T8A) the expert's distance is 0 surely, and "
        "the ball of radius 0 is the version space."
    )


def _hand_set(data: xr.Dataset) -> str:
    n, hand = data.attrs["published_demonstrations"], data.attrs["hand_radius"]
    here, first = data.sel(demonstrations=n), json.loads(data.attrs["first"])
    formula = {key: float(here.radius.sel(rung=key)[0]) for key in first}
    covering = [first[key]["text"] for key, radius in formula.items() if radius <= hand]
    within = {key: _percent(here.radius.sel(rung=key).values <= hand) for key in ("data", "leaving", "expert")}
    return (
        f"The published radius {hand:g} at n = {n} is certified by {' and '.join(covering) or 'none'} of the formulas. "
        f"The stated radius is {formula['stated']:,.0f} there, {formula['stated'] / hand:,.0f} times as large, and "
        f"comes down to {hand:g} at {first['stated']['hand'] / n:,.0f} times as many demonstrations; the repaired one "
        f"is {formula['repaired']:.3g}. From the data, T8(B) certifies it in {within['leaving']} of the data sets, T9 "
        f"with T10 in {within['data']}; the expert really is inside in {within['expert']}. The ball keeps "
        f"{_share(here, 'hand')} of the policies; the version space, which contains the expert surely, "
        f"{_share(here, 'zero')}."
    )


def _reading(data: xr.Dataset) -> str:
    first = json.loads(data.attrs["first"])
    zero = data.share.sel(rung="zero").mean("counted")
    useful = data.demonstrations.values[(data.radius.sel(rung="data").median("dataset") < 1).values]
    from_counts = f"{useful[0]:,} (median, of the n drawn)" if len(useful) else "none of the n drawn"
    once = (
        f" As soon as a radius is below 1, the ball keeps at most one policy in {data.attrs['actions']}: every "
        "trajectory starts in the same state, and there the policy must agree with the clone."
    )
    return (
        f"Each radius says something from this n on: stated {first['stated']['informative']:,}, with the corollaries' "
        f"6 {first['corollaries']['informative']:,}, repaired {first['repaired']['informative']:,}, its angle form "
        f"{first['sharp']['informative']:,}, T9 with T10 from counts {from_counts}, T8(B) and radius zero from the "
        f"first demonstration, where radius zero keeps {100 * float(zero[0]):.3g} % of all policies."
        f"{once if data.attrs['one_start'] else ''}"
    )


def _share(here: xr.Dataset, key: str) -> str:
    mean, lower, upper = interval(100 * here.share.sel(rung=key).values, low=0, high=100)
    return f"{float(mean):.3g} % [{float(lower):.3g}, {float(upper):.3g}]"


def _percent(happened: np.ndarray) -> str:
    """A frequency with its Clopper-Pearson 95 % interval."""
    low, high = clopper_pearson(np.sum(happened), len(happened))
    return f"{100 * np.mean(happened):.3g} % [{100 * float(low):.3g}, {100 * float(high):.3g}]"
