"""The figures of a run: cumulative suboptimality and the size of the policy set, with 95 % bands or few seeds."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from bridge_algos.files import atomic_write
from bridge_algos.mdp import FloatArray
from bridge_algos.run.candidates import label as search_label
from bridge_algos.run.interval import SHOWN_SEEDS, interval
from bridge_algos.run.summary import Mean, cumulative, lowest_regret, most_policies

STYLES: dict[str, dict[str, Any]] = {
    "bridge": {"label": "BRIDGE", "color": "#0072B2"},
    "bridge-known": {"label": "BRIDGE, known dynamics", "color": "#56B4E9"},
    "pbrl": {"label": "PbRL", "color": "#D55E00"},
    "bc": {"label": "BC", "color": "#009E73", "linestyle": (0, (1, 1.2))},
}
"""Okabe-Ito colours, told apart by colour-blind readers and in grey."""

EXPERT: dict[str, Any] = {"label": "expert", "color": "#444444", "linestyle": "--", "linewidth": 1}


def figure(results: xr.Dataset) -> Any:
    """A matplotlib figure with both panels; add curves if you like, then save it with :func:`save`."""
    from matplotlib.figure import Figure

    picture = Figure(figsize=(6.6, 3.2), layout="constrained")
    regret, size = picture.subplots(1, 2)
    draw_cumulative(regret, results)
    draw_sizes(size, results)
    return picture


def draw_cumulative(
    axes: Any, results: xr.Dataset, variable: str = "suboptimality", yardstick: str | None = None
) -> None:
    """Cumulative regret of every algorithm, see :func:`draw_seeds`; never clipped at zero.

    The line at zero is the expert's, or that of another ``yardstick``, by the name it has in the legend.
    """
    rounds = np.asarray(results["round"])
    lowest = lowest_regret(results, variable) * np.arange(1, len(rounds) + 1)
    for name in (str(n) for n in results.algorithm.values):
        draw_seeds(axes, rounds, cumulative(results, variable, name), labelled(results, name), low=lowest)
    axes.axhline(0, **(EXPERT if yardstick is None else {**EXPERT, "label": yardstick}))
    axes.set(xlabel="online round t", ylabel="cumulative regret (reward)", xlim=_span(rounds))
    axes.set_title("regret of the greedy policy", fontsize=9)
    finish(axes)


def _span(rounds: np.ndarray) -> tuple[float, float]:
    """From the first round to the last, of positive length even for a single round."""
    return rounds[0], max(rounds[-1], rounds[0] + 1)


def draw_sizes(axes: Any, results: xr.Dataset) -> None:
    """Number of policies left in Pi_t, see :func:`draw_seeds`, on a logarithmic scale."""
    rounds = np.asarray(results["round"])
    for name in (str(n) for n in results.algorithm.values if n != "bc"):
        sizes = np.asarray(results.set_size.sel(algorithm=name).transpose("seed", "round"))
        draw_seeds(axes, rounds, sizes, labelled(results, name), low=1.0, high=most_policies(results, name))
    axes.set(yscale="log", xlabel="online round t", ylabel=r"policies in $\Pi_t$", xlim=_span(rounds))
    axes.set_ylim(bottom=0.9)
    axes.set_title("policies not ruled out", fontsize=9)
    finish(axes)


def labelled(results: xr.Dataset, name: str) -> dict[str, Any]:
    """The style of an algorithm, whose label says when it searches a part of its set, or the clone alone."""
    return {**STYLES[name], "label": STYLES[name]["label"] + search_label(results, name)}


def draw_seeds(
    axes: Any, x: Any, values: FloatArray, style: dict[str, Any], low: ArrayLike = -np.inf, high: ArrayLike = np.inf
) -> None:
    """The mean of values (seeds, len(x)) in the range low to high: with its 95 % band, or with each of a few seeds."""
    mean, lower, upper = interval(values, low, high)
    axes.plot(x, mean, **{"linewidth": 1.6, **style})
    if len(values) >= SHOWN_SEEDS:
        axes.fill_between(x, lower, upper, color=style["color"], alpha=0.18, linewidth=0)
    elif len(values) > 1:
        for seed in values:
            axes.plot(x, seed, **{**style, "linewidth": 0.6, "alpha": 0.6, "label": None})


def draw_errors(axes: Any, x: ArrayLike, values: FloatArray, style: dict[str, Any], low: ArrayLike = -np.inf) -> None:
    """The means of values (seeds, len(x)) not below ``low``, with bars for 95 % intervals, or dots for a few seeds."""
    mean, lower, upper = interval(values, low)
    if len(values) >= SHOWN_SEEDS:
        axes.errorbar(x, mean, [mean - lower, upper - mean], **{"marker": ".", "markersize": 4, "capsize": 2, **style})
        return
    axes.plot(x, mean, **{"marker": ".", "markersize": 4, **style})
    if len(values) > 1:
        dots = {"color": style["color"], "linestyle": "none", "marker": "_", "markersize": 5, "markeredgewidth": 0.8}
        for seed in values:
            axes.plot(x, seed, **dots)


def draw_means(axes: Any, means: Sequence[Mean], heights: ArrayLike, **style: Any) -> None:
    """Means side by side at some heights, with bars for 95 % intervals, or dots for a few seeds."""
    few = any(each.seeds for each in means)
    reach = None if few else [each.half_width for each in means]
    axes.errorbar([each.mean for each in means], heights, xerr=reach, capsize=2, **style)
    for each, height in zip(means, np.asarray(heights), strict=True):
        if len(each.seeds) > 1:
            axes.plot(each.seeds, np.full(len(each.seeds), height), "|", markersize=5, color=style["color"])


def finish(axes: Any) -> None:
    """The common look: small readable type and a light grid."""
    axes.grid(visible=True, color="#dddddd", linewidth=0.5)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.tick_params(labelsize=8)
    axes.xaxis.label.set_size(8.5)
    axes.yaxis.label.set_size(8.5)


def save(picture: Any, stem: Path) -> list[Path]:
    """Write ``stem``.png and ``stem``.pdf whole or not at all, with one legend for all panels below them.

    A picture that has legends of its own, or no labelled curve, gets none.
    """
    curves = {
        label: line for axes in picture.axes for line, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    if curves and not picture.legends and all(axes.get_legend() is None for axes in picture.axes):
        picture.legend(curves.values(), curves, loc="outside lower center", ncols=4, fontsize=8, frameon=False)
    paths = [stem.with_suffix(".png"), stem.with_suffix(".pdf")]
    for path in paths:
        buffer = io.BytesIO()
        metadata = {"CreationDate": None} if path.suffix == ".pdf" else {}
        picture.savefig(buffer, format=path.suffix[1:], dpi=200, metadata=metadata)
        with atomic_write(path) as handle:
            handle.write(buffer.getvalue())
    return paths
