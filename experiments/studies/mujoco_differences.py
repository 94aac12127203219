"""Two differences between our first Reacher runs and the published ones, made as published, one after the other.

The paper leaves open, and the authors' public code (github.com/pfriedric/bridge at 54a96a8, which was read, not run)
settles, among others: the expert has the Zoo's settings, and each candidate is rolled out from its own initial states,
so that candidates also differ by luck. The published regret of the policy chosen is read off the same rollouts and
clipped at zero in each round; every step is read in three ways. In all steps the clone standardises its observations as
the expert does, as published; our first runs did not, and what that changed is not measured here.
"""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.mdp import FloatArray
from bridge_algos.run import plots
from bridge_algos.run.runner import run
from bridge_algos.run.summary import Mean, mean_of, spread_words, verdict
from experiments.published import ALGORITHMS, agreement, published_curves
from experiments.studies.mujoco import COMPARED, configured, joined

READINGS = {
    "published": "on the rollouts that chose it, clipped at zero (as published)",
    "seen": "on the rollouts that chose it",
    "fresh": "on fresh initial states",
}
MARKS = {"published": "v", "seen": "o", "fresh": "s"}


def compute(settings: dict[str, Any], directory: Path, jobs: int) -> xr.Dataset:
    """Runs with the expert among the candidates along ``step``; each step's ``changes`` join those before it."""
    config, parts = configured(settings).but(include_expert=True), []
    for number, step in enumerate(settings["steps"]):
        config = config.but(**step["changes"])
        results = run(config, directory / f"step-{number}", settings["seeds"], jobs).sel(seed=range(settings["seeds"]))
        parts.append(results[COMPARED])
    return joined(parts, "step", [step["label"] for step in settings["steps"]])


def total(data: xr.Dataset, step: str, algorithm: str, reading: str) -> Mean:
    """Cumulative regret after the last round, over seeds."""
    return mean_of(_totals(data, step, algorithm, reading))


def effect(data: xr.Dataset, step: str, before: str, algorithm: str, reading: str) -> Mean:
    """Cumulative regret of a step less that of another step, paired by seed."""
    return mean_of(_totals(data, step, algorithm, reading) - _totals(data, before, algorithm, reading))


def _totals(data: xr.Dataset, step: str, algorithm: str, reading: str) -> FloatArray:
    own = data["suboptimality" if reading == "fresh" else "suboptimality_seen"].sel(step=step, algorithm=algorithm)
    if reading == "published":
        own = own.clip(min=0)
    return np.asarray(own.sum("round").transpose("seed"))


def figures(data: xr.Dataset) -> dict[str, Any]:
    """Final regret of each algorithm over the steps, three readings, beside the published interval."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    picture, labels = Figure(figsize=(6.8, 3.4), layout="constrained"), [str(step) for step in data.step.values]
    curves, heights = _published(data), np.arange(len(labels))[::-1]
    for axes, name in zip(picture.subplots(1, 2, sharey=True), ALGORITHMS, strict=True):
        if curves is not None:
            published = _final(curves, name)
            low, high = published.mean - published.half_width, published.mean + published.half_width
            axes.axvspan(low, high, color="0.88", label="published, 95 % interval")
            axes.axvline(published.mean, color="0.5", linewidth=1)
        for offset, reading in zip((0.22, 0.0, -0.22), READINGS, strict=True):
            totals = [total(data, label, name, reading) for label in labels]
            plots.draw_means(
                axes,
                totals,
                heights + offset,
                fmt=MARKS[reading],
                markersize=4,
                color=plots.STYLES[name]["color"],
                markerfacecolor="none" if reading == "fresh" else None,
                label=READINGS[reading],
            )
        axes.set(yticks=heights, xlabel=f"regret after {data.sizes['round']} rounds (reward)")
        axes.set_yticklabels([fill(label, 22) for label in labels], fontsize=8)
        axes.set_title(plots.STYLES[name]["label"], fontsize=9)
        axes.set_xlim(left=min(0.0, axes.get_xlim()[0]))
        plots.finish(axes)
    marks = [Line2D([], [], color="0.3", marker=MARKS[key], markersize=4, label=READINGS[key]) for key in READINGS]
    marks[-1].set_markerfacecolor("none")
    bands = [handle for handle in axes.get_legend_handles_labels()[0] if isinstance(handle, Patch)]
    picture.suptitle(
        f"{_environment(data).capitalize()}, {data.sizes['seed']} seeds, the expert is a candidate", fontsize=10
    )
    picture.legend(handles=[*bands, *marks], loc="outside lower center", ncols=2, fontsize=7, frameon=False)
    return {"": picture}


def words(data: xr.Dataset) -> str:
    """What each step makes of the final regret and of |Pi_t|, beside the published numbers."""
    curves = _published(data)
    lines = [
        f"{data.sizes['seed']} seeds, expert among the candidates, {data.sizes['round']} rounds; "
        f"{spread_words(data.sizes['seed'])}. Each step keeps the changes of those before it."
    ]
    labels = [str(step) for step in data.step.values]
    for before, label in zip([None, *labels], labels, strict=False):
        own = data.sel(step=label)
        lines += [
            "",
            f"{label}: the expert returns {mean_of(own.expert_return)}, the clone {mean_of(own.clone_return)}.",
        ]
        for name in ALGORITHMS:
            told = "; ".join(f"{total(data, label, name, reading)} {what}" for reading, what in READINGS.items())
            size = float(own.set_size.sel(algorithm=name).isel(round=-1).mean())
            lines.append(f"  {plots.STYLES[name]['label']}: cumulative regret {told}; {size:.1f} policies left.")
            if before is not None:
                lines.append(f"    below the step before? {_decided(data, label, before, name)}")
    lines += ["", "The last step against the first:"]
    lines += [
        f"  {plots.STYLES[name]['label']} below? {_decided(data, labels[-1], labels[0], name)}" for name in ALGORITHMS
    ]
    if curves is None:
        return "\n".join([*lines, "", "Not compared with the published curves, which have other rounds."])
    lines += [
        "",
        "Compared with the published runs as they stand, which besides compare the greedy policy with a random one, on "
        "demonstrations with sampled actions, and repeat a seed's last value once it has stopped: agreement of totals "
        "does not show that these steps are what differs.",
    ]
    lines += [f"Published: the expert returns {curves['expert_return']:.2f}, the clone {curves['bc_return']:.2f}."]
    for name in ALGORITHMS:
        left = curves[name]["policy_set_size"]["mean"][-1]
        found = agreement(total(data, labels[-1], name, "published"), _final(curves, name))
        lines.append(
            f"{plots.STYLES[name]['label']}, last step, as published: {found}; published: {left:.1f} policies left."
        )
    return "\n".join(lines)


def _decided(data: xr.Dataset, step: str, before: str, algorithm: str) -> str:
    gaps = {reading: effect(data, step, before, algorithm, reading) for reading in ("published", "fresh")}
    told = "; ".join(f"{verdict(gap)}, paired difference {gap}, {READINGS[reading]}" for reading, gap in gaps.items())
    return f"{told}."


def _published(data: xr.Dataset) -> dict[str, Any] | None:
    """The published curves, or None where they have another number of rounds."""
    curves = published_curves(_environment(data))
    return curves if curves is not None and curves["rounds"] == data.sizes["round"] else None


def _environment(data: xr.Dataset) -> str:
    return configured(json.loads(data.attrs["settings"])).environment


def _final(curves: dict[str, Any], algorithm: str) -> Mean:
    return Mean(*(curves[algorithm]["cumulative_regret"][key][-1] for key in ("mean", "ci95_half_width")))
