"""Certified answers as a figure and in words."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.mdp import FloatArray
from bridge_algos.run.plots import finish
from bridge_theory.cli.table import text_table
from experiments.asked import asked, count_text, draw_axes, draw_medians, interval_text
from experiments.intervals import clopper_pearson

STYLES: dict[str, dict[str, Any]] = {
    "pool": {"label": "best question of the pool", "color": "#0072B2"},
    "information": {"label": "most information", "color": "#009E73"},
    "challenger": {"label": "recommended against challenger", "color": "#E69F00"},
    "random": {"label": "random pair", "color": "#888888"},
    "paper": {"label": "the paper's pair rule", "color": "#D55E00"},
}
"""Okabe-Ito colours."""

CERTIFIED, TRUE = "#0072B2", "#000000"

WORTH_DIVIDING = 5.0
"""Questions from which on the least possible number says something when others are divided by it."""


def questions_figure(data: xr.Dataset) -> Any:
    """Questions against demonstrations: medians and most sessions for each way of asking, and what R1 needs."""
    from matplotlib.figure import Figure

    settings = json.loads(data.attrs["settings"])
    counts, most, names = settings["demonstrations"], settings["max_questions"], settings["asking"]
    picture = Figure(figsize=(4.4, 4.3), layout="constrained")
    axes = picture.subplots()
    draw_axes(axes, counts, most, settings["until"])
    for position, name in enumerate(names):
        own = _of(data, name)
        shift = 0.13 * (position - (len(names) - 1) / 2)
        places = [counts.index(int(n)) + shift for n in own.n.values]
        draw_medians(axes, places, [asked(row) for row in own.questions.values], most, STYLES[name])
    places = [counts.index(int(n)) for n in data.limit_n.values]
    style: dict[str, Any] = {"color": "#000000", "linestyle": (0, (1, 1.2)), "label": "least possible (estimate)"}
    axes.plot(places, data.yardstick.median("limit_seed"), **style)
    axes.annotate("R1 needs", (-0.48, 1.16 * most), fontsize=8, ha="left", annotation_clip=False)
    for place, old in zip(places, data.old.median("limit_seed").values, strict=True):
        text = _old_text(old).replace("10^", "$10^{") + ("}$" if 1e4 <= old < np.inf else "")
        axes.annotate(text, (place, 1.16 * most), fontsize=8, ha="center", annotation_clip=False)
    axes.set_title(f"{_place(settings)}, {data.sizes['seed']} seeds: median, and 10-90 %\n", fontsize=9)
    finish(axes)
    picture.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=8, frameon=False)
    return picture


def gaps_figure(data: xr.Dataset) -> Any:
    """The certified and the true gap over the questions of a session: one of them, and the middle of all."""
    from matplotlib.figure import Figure

    settings, looks = json.loads(data.attrs["settings"]), data.look.values
    picture = Figure(figsize=(4.4, 3.9), layout="constrained")
    axes = picture.subplots()
    for name, colour, label in (("gap_certified", CERTIFIED, "certified"), ("gap_true", TRUE, "true")):
        rows = data[name].transpose("session", "look").values
        low, middle, high = np.quantile(rows, (0.1, 0.5, 0.9), axis=0)
        axes.fill_between(looks, low, high, color=colour, alpha=0.15, linewidth=0)
        axes.plot(looks, middle, color=colour, linewidth=1.6, label=f"{label} gap, median")
        axes.plot(looks, rows[0], color=colour, linewidth=0.9, linestyle=(0, (4, 2)), label=f"{label} gap, seed 0")
    axes.axhline(
        data.attrs["goal_nats"], color="#D55E00", linewidth=0.9, label=f"goal: {data.attrs['goal_nats']:g} nats"
    )
    n = settings["session"]["demonstrations"]
    axes.set(xlabel="questions answered", ylabel="gap of the recommended policy (nats)", ylim=(-0.1, None))
    axes.set(xlim=(0, looks[-1]))
    given = f"{n} demonstration{'' if n == 1 else 's'}"
    title = f"{_place(settings)}, {given}\n{data.sizes['session']} seeds (bands: 10-90 %), best question of the pool"
    axes.set_title(title, fontsize=9)
    finish(axes)
    picture.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=8, frameon=False)
    return picture


def _place(settings: dict[str, Any]) -> str:
    name = {"starmdp": "StarMDP", "gridworld": "Gridworld", "frozenlake": "FrozenLake"}
    return f"{name.get(settings['environment'], settings['environment'])}, range {settings['range']} nats"


def report(data: xr.Dataset) -> str:
    """The whole text."""
    return "\n\n".join((_setting(data), _questions(data), _limits(data), _gaps(data), _coverage(data)))


def _setting(data: xr.Dataset) -> str:
    settings = json.loads(data.attrs["settings"])
    return (
        f"{settings['environment']}, embedding {settings['embedding']}; a simulated Bradley-Terry teacher of range "
        f"{settings['range']} nats (best minus worst utility over all policies), W = 2 ||w*|| = "
        f"{data.attrs['weight_bound']:.4g}, an assumption that is true here; delta = {settings['delta']:g} for each "
        f"session. Demonstrations are of the best stationary policy for the teacher's utility; the candidates are all "
        f"policies that agree with them, with equal features merged, and each has its own bound. Questions show two of "
        f"{settings['pool']} trajectories simulated from random candidates. A session stops when the certified gap is "
        f"at most {settings['until']} of the range ({data.attrs['goal_nats']:g} nats), looked at after every answer, "
        f"or counts as more than {settings['max_questions']} questions. {data.sizes['seed']} seeds."
    )


def _questions(data: xr.Dataset) -> str:
    settings = json.loads(data.attrs["settings"])
    most = settings["max_questions"]
    header = ("demonstrations", "asking", "median", "95 % interval", "90 % need at most", "certified", "nothing to ask")
    rows = []
    for i in np.lexsort([[settings["asking"].index(name) for name in data.asking.values], data.n.values]):
        way = data.isel(way=int(i))
        one = asked(way.questions.values)
        rows.append(
            (
                f"{int(way.n)}",
                str(way.asking.item()),
                count_text(one.median, most),
                interval_text(one, most),
                count_text(one.ninetieth, most),
                f"{one.certified} of {one.sessions}",
                f"{int((way.candidates == 1).sum())}",
            )
        )
    return (
        "Questions until the gap is certified (intervals of the median: order statistics; 'nothing to ask': the "
        f"demonstrations leave one candidate):\n{text_table(header, rows)}"
    )


def _limits(data: xr.Dataset) -> str:
    settings = json.loads(data.attrs["settings"])
    rows = []
    for i in range(data.sizes["given"]):
        own = data.isel(given=i)
        yardstick, old = own.yardstick.values, float(own.old.median())
        way = _of(data, "pool")
        way = way.isel(way=int(np.flatnonzero(way.n.values == int(own.limit_n))[0]))
        same = way.questions.values[: len(yardstick)]
        large = yardstick >= WORTH_DIVIDING
        ratio = _ratio(same[large] / yardstick[large])
        spread = f"{np.median(yardstick):.1f} [{yardstick.min():.1f}, {yardstick.max():.1f}]"
        rows.append((f"{int(own.limit_n)}", spread, ratio, _old_text(old)))
    header = ("demonstrations", "least possible: median [range]", "pool's questions / it", "R1, in its favour")
    return (
        f"The first {settings['limit_seeds']} seeds. 'Least possible' estimates kl(1 - delta, delta)/D over the same "
        "pool (companion G9): an average, in the limit of small delta where several answers are correct, from floats; "
        f"questions are divided by it, and the median taken, where it is at least {WORTH_DIVIDING:g}. "
        "'R1' is the number of answers from which the earlier certificate, whose width contains kappa = 2 + 2cosh(2BW) "
        f"(here B = {data.attrs['embedding_bound']:g}), certifies the same gap with the paper's pair rule: an estimate "
        f"in its favour, with its centre exactly at the true weights.\n{text_table(header, rows)}"
    )


def _gaps(data: xr.Dataset) -> str:
    settings = json.loads(data.attrs["settings"])
    rows = []
    for look in data.look.values:
        own = data.sel(look=look)
        cells = [_three(own[name].values) for name in ("gap_certified", "gap_true")]
        rows.append((str(look), *cells))
    n = settings["session"]["demonstrations"]
    below = float((data.gap_true <= data.gap_certified + 1e-9).mean())
    return (
        f"Gaps in nats over the questions, {n} demonstration{'' if n == 1 else 's'}, rule 'pool', median [10 %, 90 %] "
        f"over {data.sizes['session']} sessions that go on until {settings['session']['until']} of the range (a "
        "session's last gap stays); every candidate's bound is computed to 0.02 of that goal:\n"
        f"{text_table(('questions', 'certified gap', 'true gap'), rows)}\n"
        f"The true gap is at most the certified one in {below:.1%} of these looks."
    )


def _coverage(data: xr.Dataset) -> str:
    delta = json.loads(data.attrs["settings"])["delta"]
    finished = np.isfinite(data.questions.values)
    wrong = finished & (data.true_gap.values > data.attrs["goal_nats"])
    outside = data.covered.values == 0
    return (
        f"The true weights left the likelihood set in {_share(outside)} of the sessions and {_share(wrong)} issued a "
        f"wrong certificate; {delta:.0%} may, each. Sessions of one seed share demonstrations and pool across the ways "
        "of asking, so that the intervals (Clopper-Pearson) are a guide."
    )


def _of(data: xr.Dataset, asking: str) -> xr.Dataset:
    own = data.isel(way=np.flatnonzero(data.asking.values == asking))
    return own.isel(way=np.argsort(own.n.values))


def _ratio(ratios: FloatArray) -> str:
    """The median, as long as most of them are finite, and of how many."""
    middle = float(np.quantile(ratios, 0.5, method="higher")) if len(ratios) else np.inf
    return f"{middle:.1f} ({len(ratios)} seeds)" if np.isfinite(middle) else "-"


def _old_text(old: float) -> str:
    """A number of answers that is usually astronomical."""
    if not np.isfinite(old):
        return "never"
    return f"{old:.0f}" if old < 1e4 else f"10^{np.log10(old):.0f}"


def _three(values: FloatArray) -> str:
    low, middle, high = np.quantile(values, (0.1, 0.5, 0.9))
    return f"{middle:.2f} [{low:.2f}, {high:.2f}]"


def _share(happened: np.ndarray) -> str:
    low, high = clopper_pearson(int(happened.sum()), happened.size)
    return f"{int(happened.sum())} of {happened.size} [{100 * float(low):.2g} %, {100 * float(high):.2g} %]"
