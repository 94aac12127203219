r"""What demonstrations buy: regret over the number of demonstrations n and of online rounds T.

A run of the most rounds gives the regret after every smaller T, so that only n varies. The trade-off beside the heat
maps is the iso-regret line :math:`\{(T, n): R_T(n) = X\}` of the pairs played, which the theory bounds, beside the n
that ``bridge-rl plan`` asks for at the same X under each version of the theory.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.mdp import FloatArray
from bridge_algos.run.config import preset
from bridge_algos.run.interval import interval
from bridge_algos.run.plots import STYLES, finish
from bridge_algos.run.summary import Mean, lowest_regret, mean_of, mean_over_seeds, reading, verdict
from bridge_algos.run.world import build_world
from bridge_theory.bound import Bound
from bridge_theory.cli.table import text_table
from bridge_theory.cli.versions import REGRET
from bridge_theory.errors import InputError
from bridge_theory.solve import solve_for
from experiments.cells import Cell, run_cells
from experiments.panels import legend_below
from experiments.seeds import all_seeds, changed, configured, entries, preset_text

PLANNED: dict[str, dict[str, Any]] = {
    "regret_known_stated": {"label": "planned: stated (refuted)", "color": "#999999", "linestyle": "--"},
    "regret_unknown_repaired": {"label": "planned: repaired, unknown P", "color": "#000000", "linestyle": ":"},
    "regret_known_deterministic": {"label": "planned: repaired ball", "color": "#CC79A7", "linestyle": "-."},
    "regret_known_version_space": {"label": "planned: version space", "color": "#000000", "linestyle": "--"},
}


_MEASURES = {
    "greedy_regret": "cumulative regret of the greedy policy",
    "pair_regret": "cumulative regret of the pairs played",
}
_SHARE = 0.05
_PALEST = 1.0


def compute(settings: dict[str, Any], directory: Path, jobs: int) -> xr.Dataset:
    """Regrets (n, seed, algorithm, round) and planned n (bound, round)."""
    config = changed(configured(settings), "rounds", settings["rounds"])
    cells = [
        {"n": n, "configuration": entries(changed(config, "n_demonstrations", n)), "seeds": settings["seeds"]}
        for n in settings["n"]
    ]
    runs = run_cells(regrets, cells, directory, jobs, f"demonstrations, {config.environment}")
    runs = runs.drop_vars(["configuration", "seeds"]).swap_dims(cell="n")
    return runs.merge(planned(settings)).assign_attrs(settings=json.dumps(settings, sort_keys=True))


def regrets(cell: Cell) -> xr.Dataset:
    """Cumulative regrets of the seeds of one n."""
    seeds = all_seeds(cell["configuration"], cell["seeds"])
    together = xr.concat(seeds, dim="seed", combine_attrs="drop_conflicts")
    units = {"units": "reward"}
    return xr.Dataset(
        {
            "greedy_regret": together.suboptimality.cumsum("round").assign_attrs(units),
            "lowest_greedy_regret": ((), lowest_regret(together, "suboptimality"), {"units": "reward a round"}),
            "lowest_pair_regret": ((), lowest_regret(together, "pseudo_regret"), {"units": "reward a round"}),
            "pair_regret": together.pseudo_regret.cumsum("round").assign_attrs(units),
            "comparisons": ((), cell["configuration"]["comparisons"]),
            "expert_return": ((), together.attrs["expert_return"], units),
            "caveats": ((), "; ".join(json.loads(together.attrs["caveats"])) or "every assumption holds"),
        },
        coords={name: together[name] for name in ("seed", "algorithm", "round")},
    )


def planned(settings: dict[str, Any]) -> xr.Dataset:
    r"""What ``bridge-rl plan`` asks for: the smallest n whose regret bound is at most the target, (bound, round).

    The problem is that of the theory preset on the same environment, with features divided by their bound: B = 1, the
    same utilities, :math:`\lambda = 1`. The target, given in reward, becomes utility. NaN where no n meets the target;
    ``why_no_plan`` says why not after the last round.
    """
    options = configured(settings).environment_options
    theory = preset("theory", settings["environment"]).but(environment_options=options)
    world = build_world(theory)
    problem = {
        "S": world.mdp.n_states,
        "A": world.mdp.n_actions,
        "H": world.mdp.horizon,
        "d": world.embedding.dimension,
        "B": 1,
        "W": world.embedding.bound * world.weight_bound,
        "lam": 1,
        "delta": theory.delta,
    }
    target = settings["target_regret"] * world.utility_scale
    rounds = np.arange(1, settings["rounds"] + 1)
    answers = [[_planned_n(bound, problem, target, int(t)) for t in rounds] for bound in REGRET]
    return xr.Dataset(
        {
            "planned_n": (("bound", "round"), [[n for n, _ in row] for row in answers], {"units": "demonstrations"}),
            "why_no_plan": ("bound", [row[-1][1] for row in answers]),
        },
        coords={"bound": [bound.name for bound in REGRET], "round": rounds},
    )


def _planned_n(bound: Bound, problem: dict[str, Any], target: float, rounds: int) -> tuple[float, str]:
    try:
        solution = solve_for("n", bound, target, T=rounds, **problem)
    except InputError as error:  # the statement's own conditions hold at no n
        return np.nan, str(error)
    return (np.nan, solution.reason) if solution.value is None else (float(solution.value), "")


def figures(data: xr.Dataset) -> dict[str, Any]:
    """Heat maps of the regret, and the trade-off between n and T."""
    return {"": _heat_maps(data), "trade-off": _trade_off(data)}


def _heat_maps(data: xr.Dataset) -> Any:
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure

    settings = json.loads(data.attrs["settings"])
    shown = data[settings["measure"]].sel(round=settings["shown_rounds"]).mean("seed")
    algorithms = [str(name) for name in data.algorithm.values]
    picture = Figure(figsize=(4.2, 1.5 * len(algorithms) + 0.9), layout="constrained")
    panels = picture.subplots(len(algorithms), 1, sharex=True, squeeze=False)[:, 0]
    norm = LogNorm(_PALEST, max(10 * _PALEST, float(shown.max())))
    for axes, name in zip(panels, algorithms, strict=True):
        values = shown.sel(algorithm=name).transpose("n", "round").values
        image = axes.imshow(np.maximum(values, _PALEST), norm=norm, cmap="cividis_r", origin="lower", aspect="auto")
        for (row, column), value in np.ndenumerate(values):
            dark = norm(max(value, _PALEST)) > 0.55
            text = f"{value:.0f}" if abs(value) >= 10 else f"{value:.1f}"
            axes.text(column, row, text, ha="center", va="center", fontsize=7, color="white" if dark else "black")
        axes.set_yticks(range(len(values)), [str(n) for n in data.n.values], fontsize=8)
        axes.set_ylabel("demonstrations n", fontsize=8)
        axes.set_title(STYLES[name]["label"], fontsize=9, loc="left")
    panels[-1].set_xticks(range(shown.sizes["round"]), [str(t) for t in settings["shown_rounds"]], fontsize=8)
    panels[-1].set_xlabel("online rounds T", fontsize=8.5)
    bar = picture.colorbar(
        image, ax=list(panels), location="bottom", shrink=0.9, pad=0.02, aspect=35, extend="min", format="{x:g}"
    )
    bar.set_label(f"{_MEASURES[settings['measure']]} (reward)", fontsize=8.5)
    bar.ax.tick_params(labelsize=8)
    return picture


def _trade_off(data: xr.Dataset) -> Any:
    from matplotlib.figure import Figure

    settings = json.loads(data.attrs["settings"])
    rounds = np.asarray(data["round"])
    picture = Figure(figsize=(4.2, 3.9), layout="constrained")
    axes = picture.subplots()
    for i, name in enumerate(str(n) for n in data.algorithm.values):
        above = 2.2 * 1.9**i * float(data.n[-1])  # one level an algorithm, so that none hides another
        low, needed, high = iso_regret(data, name, settings["target_regret"])
        axes.plot(rounds, needed, drawstyle="steps-post", linewidth=1.8, **STYLES[name])
        if np.isfinite(low).any():
            high = np.where(np.isfinite(high), high, above)
            axes.fill_between(rounds, low, high, step="post", color=STYLES[name]["color"], alpha=0.18, linewidth=0)
        beyond = [t for t in settings["shown_rounds"] if np.isnan(needed[t - 1])]
        if beyond:
            axes.plot(beyond, np.full(len(beyond), above), "^", markersize=4, color=STYLES[name]["color"])
    axes.plot([], [], "^", markersize=4, color="#777777", label=f"more than the {int(data.n[-1])} tried")
    for bound in (str(b) for b in data.bound.values):
        curve, style = np.asarray(data.planned_n.sel(bound=bound)), PLANNED[bound]
        none = "" if np.isfinite(curve).any() else ": none"
        axes.plot(rounds, curve, linewidth=1.3, **{**style, "label": style["label"] + none})
    axes.set(xscale="log", yscale="log", xlabel="online rounds T", ylabel="demonstrations n needed")
    axes.set_xticks(settings["shown_rounds"], [str(t) for t in settings["shown_rounds"]], minor=False)
    axes.minorticks_off()
    axes.set_title(f"regret of the pairs played at most {settings['target_regret']:g} (reward)", fontsize=9)
    finish(axes)
    legend_below(picture, 2)
    return picture


def iso_regret(data: xr.Dataset, algorithm: str, target: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The smallest n measured from which on the mean regret after each T is at most the target, (round,).

    Returns three arrays: with the lower end of the 95 % interval in place of the mean, with the mean, and with the
    upper end. NaN where the largest n measured is not enough.
    """
    values = data.pair_regret.sel(algorithm=algorithm).transpose("seed", "n", "round").values
    mean, lower, upper = interval(values, low=data.lowest_pair_regret.min().item() * np.asarray(data["round"]))
    n = np.asarray(data.n, dtype=np.float64)

    def smallest(curve: FloatArray) -> FloatArray:
        enough = np.logical_and.accumulate((curve <= target)[::-1])[::-1]
        return np.where(enough.any(axis=0), n[enough.argmax(axis=0)], np.nan)

    return smallest(lower), smallest(mean), smallest(upper)


def rounds_until(data: xr.Dataset, algorithm: str, share: float) -> FloatArray:
    """The first T from which on the greedy policy's mean suboptimality is at most a share of the expert's return, (n,).

    NaN where the last round is not yet one of them.
    """
    regret = data.greedy_regret.sel(algorithm=algorithm).transpose("seed", "n", "round").values
    gap = np.diff(regret, axis=2, prepend=0).mean(axis=0)
    good = np.logical_and.accumulate((gap <= share * float(data.expert_return[0]))[:, ::-1], axis=1)[:, ::-1]
    return np.where(good.any(axis=1), np.asarray(data["round"])[good.argmax(axis=1)], np.nan)


def words(data: xr.Dataset) -> str:
    """What was found: regrets with intervals, the exchange rate between n and T, and how far the plan is off."""
    settings = json.loads(data.attrs["settings"])
    algorithms = [str(name) for name in data.algorithm.values]
    last = int(data["round"][-1])
    lines = [
        f"{settings['environment']}, {preset_text(settings)}:",
        f"{_MEASURES[settings['measure']]} after T = {last} rounds of {data.comparisons.values[0]} comparisons, in "
        f"reward (the expert returns {float(data.expert_return[0]):.2f} a round); "
        f"{reading(data.sizes['seed'])}",
        text_table(
            ("n", *(STYLES[name]["label"] for name in algorithms)),
            [(str(n), *(str(_last(data, settings["measure"], name, n)) for name in algorithms)) for n in data.n.values],
        ),
        "",
    ]
    few, many = int(data.n[0]), int(data.n[-1])
    for name in algorithms:
        own = data[settings["measure"]].sel(algorithm=name).isel(round=-1)
        answer = _lower(own.sel(n=many), own.sel(n=few), paired=False)
        lines.append(f"{STYLES[name]['label']}: do {many} demonstrations instead of {few} lower it? {answer}")
    for n in data.n.values:
        final = data[settings["measure"]].sel(n=n).isel(round=-1)
        answers = [
            f"below {STYLES[name]['label']}? {_lower(final.sel(algorithm='bridge'), final.sel(algorithm=name))}"
            for name in algorithms
            if name != "bridge"
        ]
        lines.append(f"n = {n}: BRIDGE {'; '.join(answers)}")
    lines += [
        "",
        f"rounds until the greedy policy's mean suboptimality stays within {_SHARE:.0%} of the expert's return",
    ]
    needed = {name: rounds_until(data, name, _SHARE) for name in algorithms}
    rows = [
        (str(n), *(f"{needed[name][i]:.0f}" if np.isfinite(needed[name][i]) else f"> {last}" for name in algorithms))
        for i, n in enumerate(data.n.values)
    ]
    lines += [text_table(("n", *(STYLES[name]["label"] for name in algorithms)), rows), ""]
    return "\n".join([*lines, *_plan_lines(data, settings, algorithms), f"the runs: {data.caveats.values[0]}"])


def _plan_lines(data: xr.Dataset, settings: dict[str, Any], algorithms: list[str]) -> list[str]:
    """Planned against measured n for the target regret, at a few T."""
    target, most = settings["target_regret"], int(data.n[-1])
    lines = [f"demonstrations for a regret of the pairs played of at most {target:g} (reward): planned, and measured"]
    measured = {name: iso_regret(data, name, target)[2] for name in algorithms}
    rows = []
    for t in settings["shown_rounds"]:
        plans = [float(data.planned_n.sel(bound=bound, round=t)) for bound in data.bound.values]
        found = [float(curve[t - 1]) for curve in measured.values()]
        rows.append(
            (
                str(t),
                *(_count(n) if np.isfinite(n) else "none" for n in plans),
                *(f"{n:.0f}" if np.isfinite(n) else f"> {most}" for n in found),
            )
        )
    names = [str(bound) for bound in data.bound.values]
    lines.append(text_table(("T", *names, *(STYLES[name]["label"] for name in algorithms)), rows))
    lines.append(
        "planned: what the bound promises with probability at least 95 % (see bridge-rl plan); regret_known_stated is "
        "refuted, so that nothing stands behind its promise. Measured: the smallest n tried from which on even the "
        f"upper 95 % limit of the mean meets the target; a loss too rare for these seeds would not show{_pbrl(data)}"
    )
    for bound in names:
        plan = data.planned_n.sel(bound=bound).values
        for name, curve in measured.items():
            if name == "pbrl":  # it learns nothing from demonstrations
                continue
            both = np.isfinite(plan) & np.isfinite(curve)
            if both.any():
                t = int(np.flatnonzero(both)[-1])
                lines.append(
                    f"{bound} asks for {_count(plan[t] / curve[t])} times the demonstrations that "
                    f"{STYLES[name]['label']} needed at T = {t + 1} ({_count(plan[t])} against {curve[t]:.0f})"
                )
        if not np.isfinite(plan).any():
            lines.append(f"{bound}: no plan exists; {data.why_no_plan.sel(bound=bound).item()} (in utility)")
    return lines


def _pbrl(data: xr.Dataset) -> str:
    """What demonstrations are to PbRL, to end a sentence: where it cannot search everything, it borrows candidates."""
    if "pbrl" not in data.algorithm:
        return ""
    regret = data.pair_regret.sel(algorithm="pbrl")
    if bool((regret == regret.isel(n=0, drop=True)).all()):
        return ". PbRL uses no demonstrations"
    return ". PbRL learns nothing from demonstrations, but its search space borrows policies from the offline set"


def _last(data: xr.Dataset, measure: str, algorithm: str, n: int) -> Mean:
    lowest = data.sizes["round"] * float(data[f"lowest_{measure}"].min())
    return mean_of(data[measure].sel(algorithm=algorithm, n=n).isel(round=-1), low=lowest)


def _lower(first: xr.DataArray, second: xr.DataArray, paired: bool = True) -> str:
    """Is the first lower, as far as the interval tells? Algorithms share the data of a seed; different n do not."""
    one, two = np.asarray(first), np.asarray(second)
    if (one == two).all():
        return "no, equal in every seed"
    if paired:
        mean, half = mean_over_seeds(one - two)
    else:
        (mean_one, half_one), (mean_two, half_two) = mean_over_seeds(one), mean_over_seeds(two)
        mean, half = mean_one - mean_two, np.hypot(half_one, half_two)
    gap = Mean(float(mean), float(half))
    return f"{verdict(gap)}, by {gap}"


def _count(number: float) -> str:
    return f"{number:,.0f}" if number < 1e6 else f"{number:.2g}"
