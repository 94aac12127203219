"""Certified regret as a figure and in words."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.mdp import FloatArray
from bridge_algos.run.plots import finish
from bridge_theory.cli.table import text_table

LINES: tuple[tuple[str, str, str, dict[str, Any]], ...] = (
    ("repaired", "bound_trivial", "trivial bound", {"color": "#777777", "linestyle": (0, (1, 1.4))}),
    ("repaired", "bound_best", "certified, with kappa (R4)", {"color": "#D55E00", "linestyle": (0, (5, 1.5))}),
    ("repaired", "regret", "regret, sets with kappa", {"color": "#D55E00", "linestyle": "-"}),
    ("likelihood", "bound_likelihood", "certified, answers (G6)", {"color": "#0072B2", "linestyle": (0, (5, 1.5))}),
    ("likelihood", "regret", "regret, likelihood set", {"color": "#0072B2", "linestyle": "-"}),
)
"""Confidence set of the runs, what is drawn, its label and style, in the order of the legend."""

WIDTH, HEIGHT = 3.9, 3.6
"""Inches: with type of 8 points, 6.5 points when printed 8 cm wide."""


def figure(data: xr.Dataset) -> Any:
    """Regret and its bounds over the rounds, means over seeds; bands: 10 to 90 % of the seeds."""
    from matplotlib.figure import Figure

    picture = Figure(figsize=(WIDTH, HEIGHT), layout="constrained")
    axes = picture.subplots()
    rounds = np.arange(1, data.sizes["round"] + 1)
    for sets, name, label, style in LINES:
        rows = _rows(data, sets, name)
        axes.plot(rounds, rows.mean(axis=0), label=label, linewidth=1.7, **style)
        if sets == "likelihood":
            low, high = np.quantile(rows, (0.1, 0.9), axis=0)
            axes.fill_between(rounds, low, high, color=style["color"], alpha=0.15, linewidth=0)
    axes.set(xlabel="round", ylabel="cumulative regret (nats)", xlim=(1, rounds[-1]))
    axes.set_ylim(0, 1.05 * float(_rows(data, "repaired", "bound_trivial").mean(axis=0)[-1]))
    axes.legend(fontsize=8, frameon=False, loc="upper left", handlelength=2.6)
    finish(axes)
    return picture


def report(data: xr.Dataset) -> str:
    """The whole text."""
    settings = json.loads(data.attrs["settings"])
    ends = [t for t in (10, 25, 50, 100, 250, 500, 1000, 2000) if t < data.sizes["round"]] + [data.sizes["round"]]
    rows = [
        (f"{t}", *(_three(_rows(data, sets, name)[:, t - 1]) for sets, name, _, _ in LINES), *_left(data, t))
        for t in ends
    ]
    header = ("rounds", *(label for _, _, label, _ in LINES), "left, with kappa", "left, likelihood")
    alone = int((_rows(data, "repaired", "left")[:, 0] == 1).sum())
    held = {
        label: int((_rows(data, sets, "regret") <= _rows(data, sets, name) + 1e-9).all(axis=1).sum())
        for sets, name, label, _ in LINES
        if name != "regret"
    }
    covered = ", ".join(f"{label}: {count}" for label, count in held.items())
    n, seeds = settings["demonstrations"], settings["seeds"]
    return (
        f"{settings['environment']}, known dynamics, range {settings['range']:g} nats over all policies (W = ||w*|| = "
        f"{data.attrs['weight_bound']:.3g}), {n} demonstration{'' if n == 1 else 's'}, "
        f"{settings['comparisons']} comparisons a round, pair rule {settings['pair_rule']}, delta = "
        f"{settings['delta']:g}, {seeds} seed{'' if seeds == 1 else 's'}, "
        f"{alone} with one policy left from the start.\n\n"
        "Each seed is run with the sets of audit R1, whose width contains kappa, and with the likelihood set. 'R4' "
        "certifies the former; it assumes that the answers follow the Bradley-Terry model and spends delta. 'G6' "
        "certifies the latter from questions and answers alone; it assumes and spends the same, and needs neither "
        "kappa, nor fitted weights, nor a rule of play.\n\n"
        "Cumulative regret in nats and policies left, mean [10 %, 90 %] over the seeds:\n"
        f"{text_table(header, rows)}\n\n"
        f"Seeds of {seeds} whose regret stays below the bound in every round: {covered}."
    )


def _rows(data: xr.Dataset, sets: str, name: str) -> FloatArray:
    """(seeds, T) of the runs with these confidence sets."""
    runs = np.flatnonzero(data.confidence.values == sets)
    return np.asarray(data[name].transpose("run", "round").values[runs])


def _left(data: xr.Dataset, t: int) -> tuple[str, str]:
    one, two = (_rows(data, sets, "left")[:, t - 1].mean() for sets in ("repaired", "likelihood"))
    return f"{one:.1f}", f"{two:.1f}"


def _three(values: FloatArray) -> str:
    low, high = np.quantile(values, (0.1, 0.9))
    return f"{values.mean():.1f} [{low:.1f}, {high:.1f}]"
