"""The picture: cumulative regret and every version of the theory, linear above, logarithmic below."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from bridge_algos.run.plots import STYLES, finish
from experiments.compare.comparison import Comparison, Row

LINES: dict[str, dict[str, Any]] = {
    "trivial": {"color": "#777777", "linestyle": "-", "linewidth": 1.1},
    "certified": {"color": "#009E73", "linestyle": "-", "linewidth": 1.6},
    "answers": {"color": "#009E73", "linestyle": (0, (5, 1)), "linewidth": 1.6},
    "a-priori": {"color": "#E69F00", "linestyle": (0, (6, 2)), "linewidth": 1.4},
    "played": {"color": "#CC79A7", "linestyle": (0, (3, 1, 1, 1)), "linewidth": 1.4},
    "stated": {"color": "#D55E00", "linestyle": "-", "linewidth": 1.6},
    "stated-sums": {"color": "#D55E00", "linestyle": (0, (4, 2)), "linewidth": 1.2},
    "rate": {"color": "#000000", "linestyle": (0, (1, 1.4)), "linewidth": 1.4},
}
"""Okabe-Ito colours; each line also differs in its dashes."""

COLOUR = STYLES["bridge"]["color"]

WIDTH, HEIGHT = 3.9, 5.4
"""Inches of one comparison: with type of 8 points, 6.5 points when printed 8 cm wide."""


def figure(comparisons: Sequence[Comparison]) -> Any:
    """A matplotlib figure with a column for each comparison; save it with :func:`bridge_algos.run.plots.save`."""
    from matplotlib.figure import Figure

    picture = Figure(figsize=(WIDTH * len(comparisons), HEIGHT), layout="constrained")
    panels = picture.subplots(2, len(comparisons), squeeze=False)
    for comparison, (linear, logarithmic) in zip(comparisons, panels.T, strict=True):
        draw(linear, comparison, logarithmic=False)
        draw(logarithmic, comparison, logarithmic=True)
        linear.set_title(f"{_run(comparison, comparisons)}\n{STYLES[comparison.algorithm]['label']}", fontsize=9)
    curves = {
        label: line for axes in picture.axes for line, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    picture.legend(
        curves.values(), curves, loc="outside lower center", ncols=len(comparisons), fontsize=8, frameon=False,
        handlelength=2.6,
    )  # fmt: skip
    return picture


def draw(axes: Any, comparison: Comparison, *, logarithmic: bool) -> None:
    """All curves of a comparison into one panel; those that are not about the run are drawn "for scale"."""
    empirical, rounds = comparison.empirical, comparison.rounds
    for row in comparison.rows:
        label = row.curve.label + (", for scale" if row.curve.missing else "")
        axes.plot(rounds, row.curve.mean, label=label, **LINES[row.curve.kind])
    axes.plot(rounds, empirical.mean, color=COLOUR, linewidth=2, label=_empirical_label(comparison))
    if empirical.lower is not None and empirical.upper is not None:
        low = np.maximum(empirical.lower, _floor(comparison)) if logarithmic else empirical.lower
        axes.fill_between(rounds, low, empirical.upper, color=COLOUR, alpha=0.18, linewidth=0)
    for row in comparison.rows:
        if row.verdict == "violated":
            _mark(axes, comparison, row, logarithmic)
    axes.set(xlabel="round t", ylabel=r"cumulative regret (utility)", xlim=(rounds[0], rounds[-1]))
    if logarithmic:
        axes.set(xscale="log", yscale="log")
        axes.set_ylim(bottom=_floor(comparison))
    else:
        axes.set_ylim(0, _ceiling(comparison))
    finish(axes)


def _mark(axes: Any, comparison: Comparison, row: Row, logarithmic: bool) -> None:
    """Shade where the stated bound is violated, and say so."""
    rounds, mean, bound = comparison.rounds, comparison.empirical.mean, row.curve.mean
    since = row.violated_from if row.violated_from is not None else rounds[-1]
    where = (rounds >= since) & (mean > bound)
    if where.sum() > 1:
        axes.fill_between(rounds, bound, mean, where=where, color="#D55E00", alpha=0.13, linewidth=0)
    if logarithmic:
        return
    axes.text(
        0.97 * rounds[-1], (mean[-1] + 2 * bound[-1]) / 3, f"violated\n{row.ledger or row.curve.source}", ha="right",
        va="center", fontsize=8, color="#A03A00",
    )  # fmt: skip


def _run(comparison: Comparison, comparisons: Sequence[Comparison]) -> str:
    """The environment, or the run where the environment does not tell columns apart."""
    titles = [(other.environment, other.algorithm) for other in comparisons]
    alone = titles.count((comparison.environment, comparison.algorithm)) == 1
    return comparison.environment if alone else comparison.run


def _empirical_label(comparison: Comparison) -> str:
    empirical = comparison.empirical
    if empirical.replay is not None:
        return "empirical regret (deterministic)"
    if empirical.lower is None:
        return "empirical regret (one seed)"
    return f"empirical regret, {empirical.seeds} seeds, 95 % confidence sequence"


def _floor(comparison: Comparison) -> float:
    """A third of the smallest positive mean regret: below, a logarithmic axis would only show noise."""
    positive = comparison.empirical.mean[comparison.empirical.mean > 0]
    smallest = float(positive.min()) if len(positive) else comparison.trivial / 1e3
    return max(smallest / 3, comparison.trivial / 1e5)


def _ceiling(comparison: Comparison) -> float:
    """The linear panel ends where bounds become vacuous, or early enough to show a regret that is far below."""
    empirical = comparison.empirical
    top = float((empirical.mean if empirical.upper is None else empirical.upper)[-1])
    return min(1.08 * comparison.trivial, 3 * top) if top > 0 else 1.08 * comparison.trivial
