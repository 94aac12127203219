"""The figures of a run: cumulative suboptimality with 95 % bands, and the size of the policy set."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.files import atomic_write
from bridge_algos.run.summary import cumulative, mean_over_seeds

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
    """Cumulative regret of every algorithm: mean and 95 % band over seeds; never clipped at zero.

    The line at zero is the expert's, or that of another ``yardstick``, by the name it has in the legend.
    """
    rounds = np.asarray(results["round"])
    for name in (str(n) for n in results.algorithm.values):
        draw_band(axes, rounds, *mean_over_seeds(cumulative(results, variable, name)), STYLES[name])
    axes.axhline(0, **(EXPERT if yardstick is None else {**EXPERT, "label": yardstick}))
    axes.set(xlabel="online round t", ylabel="cumulative regret (reward)", xlim=_span(rounds))
    axes.set_title("regret of the greedy policy", fontsize=9)
    finish(axes)


def _span(rounds: np.ndarray) -> tuple[float, float]:
    """From the first round to the last, of positive length even for a single round."""
    return rounds[0], max(rounds[-1], rounds[0] + 1)


def draw_sizes(axes: Any, results: xr.Dataset) -> None:
    """Mean number of policies left in Pi_t, with its 95 % band, on a logarithmic scale."""
    rounds = np.asarray(results["round"])
    for name in (str(n) for n in results.algorithm.values if n != "bc"):
        sizes = np.asarray(results.set_size.sel(algorithm=name).transpose("seed", "round"))
        draw_band(axes, rounds, *mean_over_seeds(sizes), STYLES[name], floor=1)
    axes.set(yscale="log", xlabel="online round t", ylabel=r"policies in $\Pi_t$", xlim=_span(rounds))
    axes.set_ylim(bottom=0.9)
    axes.set_title("policies not ruled out", fontsize=9)
    finish(axes)


def draw_band(axes: Any, x: Any, mean: Any, half: Any, style: dict[str, Any], floor: float | None = None) -> None:
    """A line with its band; an infinite band (one seed) is left out."""
    axes.plot(x, mean, **{"linewidth": 1.6, **style})
    if np.isfinite(half).all():
        low = mean - half if floor is None else np.maximum(mean - half, floor)
        axes.fill_between(x, low, mean + half, color=style["color"], alpha=0.18, linewidth=0)


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
