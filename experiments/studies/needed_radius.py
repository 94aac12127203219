r"""Is the expert in the offline set by luck or by construction? The radius that each data set would have needed.

The expert lies in the ball around the clone when the radius is at least
:math:`\rho = \hat P^{\pi^*}(\text{hit } D)^{1/2}`, D the states where the clone differs from the expert. Where the
expert's action is recorded less often than another one, the clone differs for sure; where it ties with others, in a
state without data above all, a coin decides. Both extremes of the coins are computed, so that every data set is one of
three: the expert is inside whatever the coins, the coins decide, or it is outside whatever the coins. Without noise the
first extreme is the certificate of audit T8(B), which the demonstrations alone yield.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.hellinger import disagreement_probability
from bridge_algos.mdp import FloatArray
from bridge_algos.run.offline import offline_stage
from bridge_algos.run.plots import finish
from bridge_theory.cli.table import text_table
from bridge_theory.errors import InputError
from experiments.cells import Cell, run_cells
from experiments.intervals import clopper_pearson, share_text
from experiments.panels import legend_below
from experiments.seeds import changed, configured, entries, preset_text, worlds

_COLOURS = ("#000000", "#0072B2", "#009E73", "#E69F00", "#D55E00")


def compute(settings: dict[str, Any], directory: Path, jobs: int) -> xr.Dataset:
    """Needed radii (cell, seed); a cell is one environment, n and noise."""
    cells = []
    for world in settings["environments"]:
        config = configured(world)
        for n in sorted({*settings["n"], config.n_demonstrations}):
            for noise in settings["noise"]:
                drawn = changed(changed(config, "n_demonstrations", n), "noise", noise)
                cells.append(
                    {
                        "environment": world["environment"],
                        "n": n,
                        "noise": float(noise),
                        "configuration": entries(drawn),
                        "seeds": settings["seeds"],
                    }
                )
    data = run_cells(needed_radii, cells, directory, jobs, "needed radius")
    return data.drop_vars(["configuration", "seeds"]).assign_attrs(settings=json.dumps(settings, sort_keys=True))


def needed_radii(cell: Cell) -> xr.Dataset:
    """The radius that contains the expert, and its extremes over the clone's coins, in each seed."""
    found = []
    for config, world, seed in worlds(cell["configuration"], cell["seeds"]):
        expert = world.expert.policy
        if expert.ndim != 1:
            raise InputError("the needed radius is that of a stationary expert; choose another entry 'expert'.")
        stage = offline_stage(config, world, seed)
        own = stage.pairs[np.arange(len(expert)), expert]
        outvoted = own < stage.pairs.max(axis=1)
        tied = ~outvoted & ((stage.pairs == own[:, None]).sum(axis=1) > 1)
        sets = np.array([expert != stage.clone, outvoted, outvoted | tied], dtype=np.float64)
        found.append([*np.sqrt(disagreement_probability(stage.estimate, expert, sets)), (own == 0).sum()])
    names = ("needed", "needed_lucky", "needed_unlucky", "unrecorded")
    columns = np.array(found).T
    distance = {"units": "Hellinger distance"}
    variables = {
        name: ("seed", column, distance if name != "unrecorded" else {"units": "states without the expert's action"})
        for name, column in zip(names, columns, strict=True)
    }
    return xr.Dataset(variables, coords={"seed": np.arange(cell["seeds"])})


def figures(data: xr.Dataset) -> dict[str, Any]:
    """How often the expert is outside by radius, and the needed radius by n; a row an environment."""
    from matplotlib.figure import Figure

    settings = json.loads(data.attrs["settings"])
    rows = settings["environments"]
    picture = Figure(figsize=(4.4, 1.5 * len(rows) + 0.7), layout="constrained")
    panels = picture.subplots(len(rows), 2, squeeze=False)
    for (left, right), world in zip(panels, rows, strict=True):
        config, own = configured(world), _of(data, world["environment"])
        radius, preset_n = float(config.radius), config.n_demonstrations
        for noise, colour in zip(settings["noise"], _COLOURS, strict=False):
            style = {"color": colour, "label": f"noise {noise:.0%}", "linewidth": 1.3}
            _draw_survival(left, _cell_of(own, preset_n, noise), style)
            some = own.isel(cell=np.flatnonzero(own.noise == noise))
            right.plot(some.n, some.needed.quantile(0.95, "seed"), marker=".", markersize=4, **style)
        left.axvline(radius, color="#777777", linestyle="--", linewidth=1)
        right.axhline(radius, color="#777777", linestyle="--", linewidth=1, label="preset's radius")
        right.axvline(preset_n, color="#bbbbbb", linestyle=":", linewidth=1, label="preset's n")
        left.set(xlim=(0, 1), ylim=(-0.03, 1.03), ylabel=world["environment"])
        right.set(xscale="log", ylim=(-0.03, 1.03))
        for axes in (left, right):
            finish(axes)
        right.set_xticks(settings["n"], [str(n) for n in settings["n"]])
        right.minorticks_off()
    for axes, title, label in (
        (panels[:, 0], "share of data sets with\nthe expert outside", "radius of the offline set"),
        (panels[:, 1], "radius that keeps the expert\nin 95 % of data sets", "demonstrations n"),
    ):
        axes[0].set_title(title, fontsize=8)
        axes[-1].set_xlabel(label)
    legend_below(picture, 3)
    return {"": picture}


def _draw_survival(axes: Any, cell: xr.Dataset, style: dict[str, Any]) -> None:
    radii = np.linspace(0, 1, 201)
    outside = np.asarray(cell.needed)[:, None] > radii
    low, high = clopper_pearson(outside.sum(axis=0), len(outside))
    axes.plot(radii, outside.mean(axis=0), **style)
    axes.fill_between(radii, low, high, color=style["color"], alpha=0.15, linewidth=0)


def _of(data: xr.Dataset, environment: str) -> xr.Dataset:
    return data.isel(cell=np.flatnonzero(data.environment == environment))


def _cell_of(own: xr.Dataset, n: int, noise: float) -> xr.Dataset:
    return own.isel(cell=int(np.flatnonzero((own.n == n) & (own.noise == noise))[0]))


def words(data: xr.Dataset) -> str:
    """Luck or construction, environment by environment, with Clopper-Pearson intervals."""
    settings = json.loads(data.attrs["settings"])
    lines = [
        f"{data.sizes['seed']} data sets a line; shares with 95 % Clopper-Pearson intervals. 'Surely inside': whatever "
        "the coins of the clone's ties; 'coins': inside or outside by those coins alone; 'surely outside': outvoted by "
        "noise, whatever the coins."
    ]
    for world in settings["environments"]:
        config, own = configured(world), _of(data, world["environment"])
        radius, n = float(config.radius), config.n_demonstrations
        told = (own.n == n) | own.noise.isin(settings["told_noise"])
        rows = [_row(own.isel(cell=i), radius) for i in np.flatnonzero(told)]
        lines += [
            "",
            f"{world['environment']}, {preset_text(world)} (radius {radius:g}, n = {n})",
            text_table(
                ("n", "noise", "expert outside", "surely inside", "coins", "surely outside", "needed 50/95/100 %"), rows
            ),
            _answer(_cell_of(own, n, 0.0), radius, world["environment"]),
        ]
    return "\n".join(lines)


def _row(cell: xr.Dataset, radius: float) -> tuple[str, ...]:
    outside, sure, coins, lost = _partition(cell, radius)
    quantiles = "/".join(f"{float(cell.needed.quantile(q)):.2f}" for q in (0.5, 0.95, 1.0))
    shares = [share_text(event, 1) for event in (outside, sure, coins, lost)]
    return (f"{int(cell.n)}", f"{float(cell.noise):.0%}", *shares, quantiles)


def _partition(cell: xr.Dataset, radius: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Booleans (seed,): outside; inside whatever the coins; decided by the coins; outside whatever the coins."""
    sure, lost = cell.needed_unlucky.values <= radius, cell.needed_lucky.values > radius
    return cell.needed.values > radius, sure, ~sure & ~lost, lost


def _answer(cell: xr.Dataset, radius: float, environment: str) -> str:
    _, sure, coins, _ = _partition(cell, radius)
    unlucky, needed = cell.needed_unlucky.values, cell.needed.values
    verdict = "by construction" if sure.all() else "by luck where the coins decide"
    return (
        f"{environment}, without noise: the expert is inside {verdict}: in {share_text(sure, 1)} of the data sets no "
        f"outcome of the coins could push it out, in {share_text(coins, 1)} the coins decided. The largest radius that "
        "the unluckiest coins could have asked for, which the demonstrations alone tell (audit T8(B)), is "
        f"{unlucky.max():.3f}; "
        f"the coins drawn asked for at most {needed.max():.3f}, and radius 0 sufficed in {share_text(needed == 0, 1)}. "
        f"On average {float(cell.unrecorded.mean()):.1f} states have no record of the expert's action."
    )
