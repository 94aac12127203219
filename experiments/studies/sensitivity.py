r"""How sensitive BRIDGE is: one setting at a time is moved away from a preset.

For every value of every factor: how often the optimal policy falls out of the offline set, and out of the online set
:math:`\Pi_t` in some round, with Clopper-Pearson intervals, and the cumulative regret of the greedy policy with its
95 % interval over seeds. All values see the same seeds, so that differences are paired. "The optimal policy" is one
fixed policy of the largest return; where others return as much, one of them may survive it.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.mdp import FloatArray
from bridge_algos.online.oracles import ReturnOracle
from bridge_algos.run.config import RunConfig, preset
from bridge_algos.run.plots import STYLES, draw_errors, finish
from bridge_algos.run.summary import Mean, lowest_regret, mean_of, verdict
from bridge_theory.cli.table import text_table
from bridge_theory.errors import InputError
from experiments.cells import Cell, run_cells
from experiments.intervals import clopper_pearson, share_text
from experiments.panels import legend_below
from experiments.seeds import all_seeds, changed, configured, entries, preset_text

FACTORS = {
    "radius": "offline radius (Hellinger)",
    "gamma": r"multiplier $\gamma_t$",
    "bonus_multiplier": "bonus multiplier",
    "n_demonstrations": "demonstrations n",
    "noise": "demonstration noise (prob.)",
    "oracle_options.rationality": r"rationality $\beta$",
    "oracle_options.mistakes": "mistakes (prob.)",
    "oracle_options.skip_below": "skipped below (reward)",
    "oracle_options.equal_within": "equal within (reward)",
    "oracle_options.myopia": "myopia discount",
}
"""Names of the factors on the axes: sets first, then B-Pref's imperfections of the teacher."""

PRESET = "preset"
OWN_FIT = "the preset's own fit"
"""A cell beside the factors, where the study fits weights otherwise than the preset throughout."""
_TEACHER = "oracle_options."


def compute(settings: dict[str, Any], directory: Path, jobs: int) -> xr.Dataset:
    """Frequencies' ingredients and regrets, (cell, seed, algorithm); a cell is one value of one factor."""
    config = configured(settings)
    cells = [_cell(settings, config, PRESET, 0.0)]
    for factor, values in settings["factors"].items():
        moved = [(value, changed(config, factor, value)) for value in values]
        own = preset_value(config, factor)
        cells += [_cell(settings, other, factor, float(value)) for value, other in moved if value != own]
    fit = preset(settings["preset"], settings["environment"]).fit
    if fit != config.fit:
        cells.append(_cell(settings, config.but(fit=fit), OWN_FIT, 0.0))
    data = run_cells(outcomes, cells, directory, jobs, f"sensitivity, {config.environment}")
    return data.drop_vars(["configuration", "seeds", "fresh"]).assign_attrs(
        settings=json.dumps(settings, sort_keys=True)
    )


def _cell(settings: dict[str, Any], config: RunConfig, factor: str, value: float) -> Cell:
    return {
        "factor": factor,
        "value": value,
        "configuration": entries(config),
        "seeds": settings["seeds"],
        "fresh": settings.get("fresh", False),
    }


def preset_value(config: RunConfig, factor: str) -> float:
    """The value that a factor has in the configuration."""
    if factor.startswith(_TEACHER):
        option, known = factor.removeprefix(_TEACHER), list(ReturnOracle.__dataclass_fields__)
        if option not in known:
            raise InputError(f"a study changes the teacher's {option!r}; expected one of {', '.join(known)}.")
        return float(getattr(ReturnOracle(**config.oracle_options), option))
    return float(getattr(config, factor))


def outcomes(cell: Cell) -> xr.Dataset:
    """What became of the optimal policy, and the regret, in each seed of a cell."""
    runs = all_seeds(cell["configuration"], cell["seeds"], cell["fresh"])
    return xr.concat([_outcome(run) for run in runs], dim="seed", join="exact")


def _outcome(run: xr.Dataset) -> xr.Dataset:
    return xr.Dataset(
        {
            "out_of_offline_set": run.optimum_in_offline_set == 0,
            "ruled_out": (run.optimum_ruled_out == 1).any("round"),
            "regret": run.suboptimality.sum("round").assign_attrs(units="reward"),
            "lowest_regret": ((), run.sizes["round"] * lowest_regret(run, "suboptimality"), {"units": "reward"}),
            "searched": run.best_candidate <= run.attrs["expert_return"] - run.attrs["optimum_return"] + 1e-9,
        },
        coords={"seed": run.seed, "algorithm": run.algorithm},
    )


def series(data: xr.Dataset, factor: str) -> xr.Dataset:
    """The cells of one factor in the order of its values, the preset's among them, with the values as coordinate."""
    config = configured(json.loads(data.attrs["settings"]))
    own = data.isel(cell=np.flatnonzero((data.factor == factor) | (data.factor == PRESET)))
    values = np.where(own.factor == PRESET, preset_value(config, factor), own.value)
    order = np.argsort(values, kind="stable")
    return own.assign_coords(value=("cell", values)).isel(cell=order)


def factors_of(data: xr.Dataset) -> list[str]:
    """The factors studied, in the order of ``FACTORS``, others last."""
    studied = json.loads(data.attrs["settings"])["factors"]
    order = list(FACTORS)
    return sorted(studied, key=lambda name: order.index(name) if name in order else len(order))


def figures(data: xr.Dataset) -> dict[str, Any]:
    """One figure for the settings of the sets, one for the imperfections of the teacher; a row of panels a factor."""
    factors = factors_of(data)
    teacher = [factor for factor in factors if factor.startswith(_TEACHER)]
    groups = {"sets": [factor for factor in factors if factor not in teacher], "teacher": teacher}
    return {suffix: _figure(data, group) for suffix, group in groups.items() if group}


def _figure(data: xr.Dataset, factors: list[str]) -> Any:
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    layout = ConstrainedLayoutEngine(hspace=0.12)  # each label nearer to its own panel than to the next
    picture = Figure(figsize=(4.4, 1.45 * len(factors) + 0.75), layout=layout)
    panels = picture.subplots(len(factors), 2, squeeze=False)
    config = configured(json.loads(data.attrs["settings"]))
    for (left, right), factor in zip(panels, factors, strict=True):
        own = series(data, factor)
        x = np.arange(float(own.sizes["cell"]))
        _draw_frequencies(left, x, own)
        _draw_regrets(right, x, own)
        at_preset = int(np.flatnonzero(own.factor.values == PRESET)[0])
        for axes in (left, right):
            axes.axvspan(at_preset - 0.3, at_preset + 0.3, color="#e4e4e4", zorder=0, label="the preset's value")
            axes.set_xlim(-0.5, len(x) - 0.5)
            axes.set_xlabel(FACTORS.get(factor, factor))
            finish(axes)
            axes.set_xticks(x, [_short(v) for v in own.value.values], fontsize=7)
            axes.tick_params(axis="y", labelsize=7)
    panels[0, 0].set_title("optimal policy lost (share of seeds)", fontsize=8)
    panels[0, 1].set_title(f"regret after {config.rounds} rounds (reward)", fontsize=8)
    legend_below(picture, 2)
    return picture


def _draw_frequencies(axes: Any, x: FloatArray, own: xr.Dataset) -> None:
    bridge = own.sel(algorithm="bridge")
    for lost, style in (
        (own.out_of_offline_set, {"label": "not in the offline set", "color": "#000000", "marker": "o"}),
        (bridge.ruled_out, {"label": r"ruled out of $\Pi_t$ in some round", "color": "#CC79A7", "marker": "s"}),
    ):
        count = np.asarray(lost.sum("seed"))
        trials = own.sizes["seed"]
        low, high = clopper_pearson(count, trials)
        share = count / trials
        shift = -0.08 if style["marker"] == "o" else 0.08
        axes.errorbar(x + shift, share, (share - low, high - share), markersize=3, linewidth=1, capsize=1.5, **style)
    axes.set_ylim(-0.04, 1.04)


def _draw_regrets(axes: Any, x: FloatArray, own: xr.Dataset) -> None:
    for i, name in enumerate(str(n) for n in own.algorithm.values):
        values = own.regret.sel(algorithm=name).transpose("seed", "cell").values
        style = {"linewidth": 1.2, **STYLES[name]}
        draw_errors(axes, x + 0.06 * (i - 1), values, style, low=own.lowest_regret.min("seed").values)
    axes.set_ylim(bottom=min(0, axes.get_ylim()[0]))


def words(data: xr.Dataset) -> str:
    """What was found, factor by factor, with intervals; differences are paired."""
    settings = json.loads(data.attrs["settings"])
    seeds, config = data.sizes["seed"], configured(settings)
    base = data.isel(cell=int(np.flatnonzero(data.factor.values == PRESET)[0]))
    drawn = "each with its own environment, " if settings.get("fresh") else ""
    lines = [
        f"{config.environment}, {preset_text(settings)}, {config.rounds} rounds, {seeds} seeds, {drawn}"
        "95 % intervals (Clopper-Pearson for shares); differences are paired, to these settings",
        f"at these settings: optimal policy not in the offline set {share_text(base.out_of_offline_set)}, not among "
        f"those BRIDGE searches {share_text(~base.searched.sel(algorithm='bridge'))}, {_fate(base)}",
    ]
    for i in np.flatnonzero(data.factor.values == OWN_FIT):
        fit = preset(settings["preset"], settings["environment"]).fit
        lines.append(f"with the weights fitted as in the preset ({fit}): {_fate(data.isel(cell=i))}")
    lines.append("")
    for factor in factors_of(data):
        lines += [f"{factor} (the preset has {_short(preset_value(config, factor))})", _table(data, base, factor), ""]
    lines.append(_summary(data, base))
    return "\n".join(lines)


def _fate(cell: xr.Dataset) -> str:
    """How often the optimal policy was ruled out, and all regrets, in one cell."""
    regrets = ", ".join(f"{STYLES[name]['label']} {_regret(cell, name)}" for name in map(str, cell.algorithm.values))
    return f"ruled out of Pi_t in some round {share_text(cell.ruled_out.sel(algorithm='bridge'))}; regret {regrets}"


def _regret(cell: xr.Dataset, name: str) -> Mean:
    return mean_of(cell.regret.sel(algorithm=name), low=float(cell.lowest_regret.min()))


def _table(data: xr.Dataset, base: xr.Dataset, factor: str) -> str:
    own = series(data, factor)
    algorithms = [str(name) for name in data.algorithm.values if name != "bc"]
    rows = []
    for i, value in enumerate(own.value.values):
        here = own.isel(cell=i)
        row = [_short(value), share_text(here.out_of_offline_set), share_text(here.ruled_out.sel(algorithm="bridge"))]
        for name in algorithms:
            regret = here.regret.sel(algorithm=name)
            row += [str(_regret(here, name)), str(mean_of(regret - base.regret.sel(algorithm=name)))]
        rows.append(row)
    regrets = [text for n in algorithms for text in (f"regret {STYLES[n]['label']}", "difference")]
    return text_table(("value", "not in offline set", "ruled out of Pi_t", *regrets), rows)


def _summary(data: xr.Dataset, base: xr.Dataset) -> str:
    """Which values change BRIDGE's regret for sure, at 95 % over all values together (Bonferroni)."""
    level = 1 - 0.05 / max(1, int((~data.factor.isin([PRESET, OWN_FIT])).sum()))
    sentences = []
    for factor in factors_of(data):
        own = series(data, factor)
        moved: dict[str, list[str]] = {"lowers": [], "raises": []}
        for i, value in enumerate(own.value.values):
            gap = mean_of(own.isel(cell=i).regret.sel(algorithm="bridge") - base.regret.sel(algorithm="bridge"), level)
            if verdict(gap) in ("yes", "no") and gap.mean != 0:
                moved["lowers" if verdict(gap) == "yes" else "raises"].append(_short(value))
        found = [f"{way} BRIDGE's regret at {', '.join(values)}" for way, values in moved.items() if values]
        sentences.append(f"{factor}: {'; '.join(found) or 'no change of the regret of BRIDGE decided by these seeds'}")
    return "decided at 95 % over all values together (Bonferroni):\n  " + "\n  ".join(sentences)


def _short(value: float) -> str:
    return {np.inf: "∞", -np.inf: "-∞"}.get(value, f"{value:g}")
