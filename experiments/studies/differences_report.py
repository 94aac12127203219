"""The published-differences study in words and one figure."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.mdp import FloatArray
from bridge_algos.run.plots import STYLES, draw_means, finish
from bridge_algos.run.summary import Mean, mean_of, mean_over_seeds, spread_words
from experiments.published import ALGORITHMS, agreeing_rounds, agrees, published_curves

BASE = "as documented"
SMALL = 100_000
QUANTITIES = (("regret", "exact"), ("policy_set_size", "set_size"))
"""Published curve and ours."""


def report(data: xr.Dataset) -> str:
    """Each difference's effect with its interval, what remains, and what the published data cannot decide."""
    return "\n".join([*_table(data), "", *_remaining(data), "", *_units(data), "", *_expert(data), "", *_undecided()])


def total(data: xr.Dataset, variant: str, algorithm: str, reading: str = "exact") -> Mean:
    """Cumulative suboptimality after the last round, over seeds."""
    return mean_of(_values(data, variant, algorithm, reading).sum(axis=1))


def effect(data: xr.Dataset, variant: str, algorithm: str) -> Mean:
    """A variant's total less that of the documented settings, paired by seed."""
    ours = (_values(data, name, algorithm, "exact").sum(axis=1) for name in (variant, BASE))
    return mean_of(next(ours) - next(ours))


def agreeing_rounds_of(data: xr.Dataset, variant: str, algorithm: str) -> tuple[int, int]:
    """In how many rounds regret, and |Pi_t|, agree with the published means."""
    regret, size = (
        agreeing_rounds(_values(data, variant, algorithm, reading), _published()[algorithm][key])
        for key, reading in QUANTITIES
    )
    return regret, size


def _table(data: xr.Dataset) -> list[str]:
    rounds = data.sizes["round"]
    lines = [
        f"Total suboptimality after the last round ({spread_words(data.sizes['seed'])}), its paired difference to the "
        f"documented settings, and in how many of {rounds} rounds regret / |Pi_t| agree with the published curves:",
        "",
        f"{'':<54}{'BRIDGE':>15}{'effect':>17}{'rounds':>9}{'PbRL':>18}{'effect':>17}{'rounds':>9}",
    ]
    row = f"{'published':<54}"
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
            agreeing = "{}/{}".format(*agreeing_rounds_of(data, variant, name))
            change = "" if variant == BASE else str(effect(data, variant, name))
            row += f"{total(data, variant, name)!s:>{width}}{change:>17}{agreeing:>9}"
        lines.append(row)
    lines += ["", "The documented settings read differently:"]
    for reading, label in (
        ("clipped", "estimated from 1000 rollouts, clipped at zero in each round"),
        ("before", "greedy policy measured before the round's answer"),
    ):
        row = f"{label:<62}"
        for name in ALGORITHMS:
            added = _values(data, BASE, name, reading).sum(axis=1) - _values(data, BASE, name, "exact").sum(axis=1)
            mean, half = mean_over_seeds(added)
            row += f"  {STYLES[name]['label']} {total(data, BASE, name, reading)} ({mean:+.2f} ± {half:.2f})"
        lines.append(row)
    return lines


def _remaining(data: xr.Dataset) -> list[str]:
    complete = [
        str(name) for name in data.variant.values if not np.isnan(np.asarray(data.exact.sel(variant=name))).any()
    ]
    agree = [name for name in complete if all(_agrees(total(data, name, a), a) for a in ALGORITHMS)]
    scores = {name: sum(sum(agreeing_rounds_of(data, name, a)) for a in ALGORITHMS) for name in complete}
    best = max(scores, key=lambda name: scores[name])
    everywhere = 4 * data.sizes["round"]
    lines = [
        f"Variants whose totals agree with both published totals: {len(agree)} of {len(complete)}"
        + (f" ({'; '.join(agree)})." if agree else "."),
        f"The most rounds agree, {scores[best]} of {everywhere} over the four curves, with: {best}; the documented "
        f"settings agree in {scores[BASE]}.",
    ]
    first = {name: _values(data, name, "pbrl", "exact")[:, 0].mean() for name in complete}
    theirs = _published()["pbrl"]["regret"]
    alike = [name for name in complete if _first_round_agrees(data, name)]
    lines.append(
        f"PbRL's regret in the first round: published {theirs['mean'][0]:.2f} ± {theirs['ci95_half_width'][0]:.2f}, "
        f"ours {min(first.values()):.1f} to {max(first.values()):.1f}; it agrees with "
        f"{'; '.join(alike) or 'no variant'}."
    )
    if len(agree) > 1:
        lines.append(
            "Several settings give totals that the published intervals cannot tell apart, so that no single cause can "
            "be read off the published figures."
        )
    return lines


def _first_round_agrees(data: xr.Dataset, variant: str) -> bool:
    theirs = _published()["pbrl"]["regret"]
    ours = mean_of(_values(data, variant, "pbrl", "exact")[:, 0])
    return bool(agrees(ours.mean, ours.half_width, theirs["mean"][0], theirs["ci95_half_width"][0]))


def _units(data: xr.Dataset) -> list[str]:
    """If the published regret had another unit, one factor would take ours to theirs in every round."""
    factors = {}
    for name in ALGORITHMS:
        ours, theirs = (
            _values(data, BASE, name, "exact").mean(axis=0),
            np.array(_published()[name]["regret"]["mean"]),
        )
        third = len(ours) // 3
        factors[name] = [float(ours[part].sum() / theirs[part].sum()) for part in (slice(third), slice(-third, None))]
    early = ", ".join(f"{STYLES[name]['label']} {early:.2f} and {late:.2f}" for name, (early, late) in factors.items())
    return [
        f"Units: our regret over the published one in the first and the last third of the rounds is, for {early}; "
        "one unit would make all four equal."
    ]


def _expert(data: xr.Dataset) -> list[str]:
    published = _published()["expert_return"]
    values = {str(name): float(v) for name, v in zip(data.convention.values, data.expert_return.values, strict=True)}
    near = sorted(values, key=lambda name: abs(values[name] - published))
    noise = 1.96 * data.attrs["evaluation_noise"] / np.sqrt(2)
    within = [name for name in near if abs(values[name] - published) <= noise]
    small = Fraction(published).limit_denominator(SMALL)
    whole = " " if abs(float(small) - published) < 1e-12 else " not "
    lines = [
        f"Expert's return: published {published:.3f}. Exact values under {len(values)} conventions, nearest first:"
    ]
    lines += [f"  {values[name]:10.3f}  {name}" for name in near]
    return [
        *lines,
        f"Within the noise of 1000 rollouts (± {noise:.2f}): {'; '.join(within) or 'none'}. Nothing published says "
        f"that this is what is meant. The published number is{whole}a fraction with a denominator up to {SMALL:,}, as "
        "an undiscounted mean return of at most so many trajectories would be with these whole rewards.",
    ]


def _undecided() -> list[str]:
    return [
        "Not stated, and not decided by what is published: lambda (of the likelihood and of the data matrix), whether "
        "differences enter the data matrix as expected or observed and how often, whether the ten comparisons are "
        "summed or averaged, what a row without data does, ties, and what the expert's return averages. The published "
        "numbers are means over seeds: without the runs' seeds no single run can be compared."
    ]


def _values(data: xr.Dataset, variant: str, algorithm: str, reading: str) -> FloatArray:
    return np.asarray(data[reading].sel(variant=variant, algorithm=algorithm).transpose("seed", "round"))


def _agrees(ours: Mean, algorithm: str) -> bool:
    curve = _published()[algorithm]["cumulative_regret"]
    return bool(agrees(ours.mean, ours.half_width, curve["mean"][-1], curve["ci95_half_width"][-1]))


def _published() -> dict[str, Any]:
    curves = published_curves("starmdp")
    assert curves is not None  # StarMDP's are part of the package
    return curves


def figure(data: xr.Dataset) -> Any:
    """Totals of every variant with 95 % intervals, over the published intervals as bands."""
    from matplotlib.figure import Figure

    variants = [str(name) for name in data.variant.values]
    rows = np.arange(len(variants))[::-1]
    picture = Figure(figsize=(7.0, 0.22 * len(variants) + 1.3), layout="constrained")
    panels = picture.subplots(1, 2, sharey=True)
    for axes, name in zip(panels, ALGORITHMS, strict=True):
        color, curve = STYLES[name]["color"], _published()[name]["cumulative_regret"]
        mean, half = curve["mean"][-1], curve["ci95_half_width"][-1]
        axes.axvspan(mean - half, mean + half, color=color, alpha=0.18, linewidth=0, label="published, 95 %")
        means = [total(data, variant, name) for variant in variants]
        draw_means(axes, means, rows, fmt="o", color=color, markersize=3.5, linewidth=1, label="ours, 95 %")
        base = means[variants.index(BASE)].mean
        axes.axvline(base, color="#444444", linestyle=":", linewidth=0.8, label="our mean as documented")
        axes.set(xlabel="total regret (reward)", yticks=rows, xlim=(0, None), ylim=(-0.7, len(variants) - 0.3))
        axes.set_title(STYLES[name]["label"], fontsize=9)
        finish(axes)
    panels[0].set_yticklabels(variants, fontsize=7)
    return picture
