"""The published-differences study in words and one figure."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.mdp import FloatArray
from bridge_algos.run.plots import STYLES, draw_means, finish
from bridge_algos.run.summary import Mean, mean_of, mean_over_seeds, spread_words
from experiments.published import ALGORITHMS, agreeing_rounds, published_curves, published_unit

BASE = "as documented"


def report(data: xr.Dataset) -> str:
    """Each difference's effect with its interval, the published unit, and what the published curves cannot decide."""
    return "\n".join([published_unit(_published()), "", *_table(data), "", *_sizes(data), "", *_undecided()])


def total(data: xr.Dataset, variant: str, algorithm: str, reading: str = "exact") -> Mean:
    """Cumulative suboptimality after the last round, over seeds."""
    return mean_of(_values(data, variant, algorithm, reading).sum(axis=1))


def effect(data: xr.Dataset, variant: str, algorithm: str) -> Mean:
    """A variant's total less that of the documented settings, paired by seed."""
    ours = (_values(data, name, algorithm, "exact").sum(axis=1) for name in (variant, BASE))
    return mean_of(next(ours) - next(ours))


def agreeing_sizes(data: xr.Dataset, variant: str, algorithm: str) -> int:
    """In how many rounds |Pi_t| agrees with the published means."""
    return agreeing_rounds(_values(data, variant, algorithm, "set_size"), _published()[algorithm]["policy_set_size"])


def _table(data: xr.Dataset) -> list[str]:
    rounds = data.sizes["round"]
    lines = [
        f"Total suboptimality after the last round ({spread_words(data.sizes['seed'])}), its paired difference to the "
        f"documented settings, and in how many of {rounds} rounds |Pi_t| agrees with the published one:",
        "",
        f"{'':<54}{'BRIDGE':>15}{'effect':>17}{'|Pi_t|':>9}{'PbRL':>18}{'effect':>17}{'|Pi_t|':>9}",
    ]
    row = f"{'published, in another unit':<54}"
    for name in ALGORITHMS:
        curve = _published()[name]["cumulative_regret"]
        row += f"{Mean(curve['mean'][-1], curve['ci95_half_width'][-1])!s:>{15 if name == 'bridge' else 18}}{'':>26}"
    lines.append(row.rstrip())
    for variant in (str(name) for name in data.variant.values):
        row = f"{variant:<54}"
        for name in ALGORITHMS:
            width = 15 if name == "bridge" else 18
            if np.isnan(_values(data, variant, name, "exact")).any():
                row += f"{'-':>{width}}{'-':>17}{'-':>9}"
                continue
            change = "" if variant == BASE else str(effect(data, variant, name))
            row += f"{total(data, variant, name)!s:>{width}}{change:>17}{agreeing_sizes(data, variant, name):>9}"
        lines.append(row)
    lines += ["", "The documented settings read differently:"]
    label = "greedy policy measured before the round's answer"
    row = f"{label:<62}"
    for name in ALGORITHMS:
        added = _values(data, BASE, name, "before").sum(axis=1) - _values(data, BASE, name, "exact").sum(axis=1)
        mean, half = mean_over_seeds(added)
        row += f"  {STYLES[name]['label']} {total(data, BASE, name, 'before')} ({mean:+.2f} ± {half:.2f})"
    lines.append(row)
    return lines


def _sizes(data: xr.Dataset) -> list[str]:
    complete = [
        str(name) for name in data.variant.values if not np.isnan(np.asarray(data.exact.sel(variant=name))).any()
    ]
    scores = {name: sum(agreeing_sizes(data, name, a) for a in ALGORITHMS) for name in complete}
    best = max(scores, key=lambda name: scores[name])
    return [
        f"|Pi_t| agrees in the most rounds, {scores[best]} of {2 * data.sizes['round']} over the two curves, with: "
        f"{best}; the documented settings agree in {scores[BASE]}. Regrets in two units are not compared."
    ]


def _undecided() -> list[str]:
    return [
        "Not stated, and not decided by the published curves: lambda (of the likelihood and of the data matrix), "
        "whether differences enter the data matrix as expected or observed and how often, whether the ten comparisons "
        "are summed or averaged, what a row without data does, and ties."
    ]


def _values(data: xr.Dataset, variant: str, algorithm: str, reading: str) -> FloatArray:
    return np.asarray(data[reading].sel(variant=variant, algorithm=algorithm).transpose("seed", "round"))


def _published() -> dict[str, Any]:
    curves = published_curves("starmdp")
    assert curves is not None  # StarMDP's are part of the package
    return curves


def figure(data: xr.Dataset) -> Any:
    """Totals of every variant with 95 % intervals; the published ones, in another unit, as bands."""
    from matplotlib.figure import Figure

    variants = [str(name) for name in data.variant.values]
    rows = np.arange(len(variants))[::-1]
    picture = Figure(figsize=(7.0, 0.22 * len(variants) + 1.3), layout="constrained")
    panels = picture.subplots(1, 2, sharey=True)
    for axes, name in zip(panels, ALGORITHMS, strict=True):
        color, curve = STYLES[name]["color"], _published()[name]["cumulative_regret"]
        mean, half = curve["mean"][-1], curve["ci95_half_width"][-1]
        axes.axvspan(mean - half, mean + half, color=color, alpha=0.18, linewidth=0, label="published, own unit")
        means = [total(data, variant, name) for variant in variants]
        draw_means(axes, means, rows, fmt="o", color=color, markersize=3.5, linewidth=1, label="ours, 95 %")
        base = means[variants.index(BASE)].mean
        axes.axvline(base, color="#444444", linestyle=":", linewidth=0.8, label="our mean as documented")
        axes.set(xlabel="total regret (reward)", yticks=rows, xlim=(0, None), ylim=(-0.7, len(variants) - 0.3))
        axes.set_title(STYLES[name]["label"], fontsize=9)
        finish(axes)
    panels[0].set_yticklabels(variants, fontsize=7)
    return picture
