"""A run in numbers and words: means over seeds with 95 % intervals, what was searched, and who was better than whom."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np
import scipy.stats
import xarray as xr
from numpy.typing import ArrayLike

from bridge_algos.mdp import FloatArray
from bridge_algos.run.candidates import search_lines
from bridge_algos.run.interval import SHOWN_SEEDS, interval


@dataclass(frozen=True)
class Mean:
    """A mean over seeds with its 95 % interval.

    Args:
        mean: over the seeds.
        half_width: of Student's interval, infinite for one seed.
        ends: of the interval inside the range of the quantity, where it has one.
        seeds: the numbers themselves, where they are few.

    >>> str(Mean(-1e-12, 0.0)), str(Mean(3.0, 2.0, ends=(1.5, 6.0))), str(Mean(3.0, 2.0, seeds=(2.0, 4.0)))
    ('0.00 ± 0.00', '3.00 [1.50, 6.00]', '3.00 (2.00, 4.00)')
    """

    mean: float
    half_width: float
    ends: tuple[float, float] | None = None
    seeds: tuple[float, ...] = ()

    def __str__(self) -> str:
        mean = f"{self.mean:z.2f}"
        if len(self.seeds) > 1:
            return f"{mean} ({', '.join(f'{value:z.2f}' for value in self.seeds)})"
        if not np.isfinite(self.half_width):
            return mean
        if self.ends is not None:
            return f"{mean} [{self.ends[0]:z.2f}, {self.ends[1]:z.2f}]"
        return f"{mean} ± {self.half_width:.2f}"


def mean_over_seeds(values: FloatArray, level: float = 0.95) -> tuple[FloatArray, FloatArray]:
    """Mean and half-width of its Student interval over the first axis, whose entries are independent seeds."""
    n = len(values)
    mean = values.mean(axis=0)
    if n < 2:
        return mean, np.full_like(mean, np.inf)
    return mean, scipy.stats.t.ppf((1 + level) / 2, n - 1) * values.std(axis=0, ddof=1) / np.sqrt(n)


def mean_of(values: ArrayLike, level: float = 0.95, low: float = -np.inf, high: float = np.inf) -> Mean:
    """The mean of one number a seed, with its interval of another level where asked for.

    Args:
        low, high: the range of the number; see :func:`bridge_algos.run.interval.interval`.

    >>> str(mean_of([1.0, 2.0, 3.0, 0.0, 9.0])), str(mean_of([1.0, 2.0, 3.0, 0.0, 9.0], low=0.0))
    ('3.00 ± 4.39', '3.00 [0.69, 12.96]')
    >>> str(mean_of([1.0, 2.0, 3.0]))
    '2.00 (1.00, 2.00, 3.00)'
    """
    data = np.asarray(values, dtype=np.float64)
    mean, half = mean_over_seeds(data, level)
    ends = None
    if np.isfinite((low, high)).any():
        _, lower, upper = interval(data, low, high, level)
        ends = float(lower), float(upper)
    return Mean(float(mean), float(half), ends, tuple(data.tolist()) if len(data) < SHOWN_SEEDS else ())


def lowest_regret(results: xr.Dataset, variable: str) -> float:
    """What a round's regret cannot fall below: minus what the best stationary policy may return above its yardstick.

    Minus infinity where no run certified that policy, as in continuous control.
    """
    yardstick = {"suboptimality": "expert_return", "pseudo_regret": "optimum_return"}.get(variable, "")
    if not {yardstick, "optimum_upper"} <= set(results.attrs):
        return -np.inf
    return float(results.attrs[yardstick] - results.attrs["optimum_upper"])


def most_policies(results: xr.Dataset, algorithm: str) -> float:
    """How many policies an algorithm can be left with, infinite where that differs from seed to seed."""
    if "searched" not in results:
        return np.inf
    searched = np.unique(results.searched.sel(algorithm=algorithm))
    return float(searched[0]) if len(searched) == 1 else np.inf


def cumulative(results: xr.Dataset, variable: str, algorithm: str) -> FloatArray:
    """Cumulative sum over rounds of a per-round record, (seed, round)."""
    return np.asarray(results[variable].sel(algorithm=algorithm).transpose("seed", "round").cumsum("round"))


def final(results: xr.Dataset, variable: str, algorithm: str) -> Mean:
    """Cumulative record after the last round: mean over seeds with its 95 % interval."""
    values = cumulative(results, variable, algorithm)
    return mean_of(values[:, -1], low=values.shape[1] * lowest_regret(results, variable))


def difference(results: xr.Dataset, variable: str, first: str, second: str) -> Mean:
    """Paired difference first - second of the final cumulative records: both ran on the same seeds."""
    return mean_of(cumulative(results, variable, first)[:, -1] - cumulative(results, variable, second)[:, -1])


def verdict(gap: Mean) -> str:
    """Whether "first is below second" holds, as far as the interval tells."""
    if gap.mean + gap.half_width < 0:
        return "yes"
    return "no" if gap.mean - gap.half_width > 0 else "not decided by these seeds"


def table(results: xr.Dataset) -> str:
    """The run as a text table: one row an algorithm, then the paper's comparisons; times where they are recorded."""
    algorithms = [str(name) for name in results.algorithm.values]
    rounds, seeds = results.sizes["round"], results.sizes["seed"]
    timed, judged = "seconds" in results, "suboptimality_seen" in results  # then pseudo-regret is not judged afresh
    pseudo = [] if judged else ["cum. pseudo-regret"]
    rows = [("algorithm", "cum. suboptimality", *pseudo, "last |Pi_t|", *(["ms/round"] if timed else []))]
    for name in algorithms:
        own = results.sel(algorithm=name)
        size = mean_of(own.set_size[:, -1], low=1, high=most_policies(results, name))
        kinds = ["suboptimality"] if judged else ["suboptimality", "pseudo_regret"]
        regrets = [str(final(results, kind, name)) for kind in kinds]
        rows.append((name, *regrets, str(size), *([_milliseconds(own)] if timed else [])))
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = [f"{results.attrs['title']}, after {rounds} rounds ({reading(seeds)})"]
    lines += [
        "  ".join(
            cell.ljust(width) if i == 0 else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]
    offline = _offline_lines if "radius_stated" in results else continuous_lines
    searched = search_lines(results) if "search_way" in results else []
    lines += ["", *comparisons(results), *searched, *_search_lines(results), *offline(results)]
    lines += [f"no guarantee: {caveat}" for caveat in json.loads(results.attrs["caveats"])]
    # equal in all seeds, unless machines or versions of the solver made them, which choose among optimal policies
    lines.append(results.attrs.get("expert", "the seeds describe their experts differently; run them on one machine"))
    return "\n".join(lines)


def reading(seeds: int) -> str:
    """How the numbers of a table are to be read."""
    if seeds == 1:
        return "one seed"
    if seeds < SHOWN_SEEDS:
        return f"mean over {seeds} seeds, and each seed"
    return f"mean over {seeds} seeds with its 95 % interval"


def spread_words(seeds: int) -> str:
    """What stands behind the means of a text: half-widths, or the seeds where they are few."""
    return "mean ± 95 % half-width over seeds" if seeds >= SHOWN_SEEDS else "mean over seeds, and each seed"


def _milliseconds(own: xr.Dataset) -> str:
    milliseconds = 1e3 * float(own.seconds.median())
    return f"{milliseconds:.2f}" if np.isfinite(milliseconds) else "-"


def comparisons(results: xr.Dataset) -> list[str]:
    """The paper's claim, one sentence a baseline: cumulative suboptimality of BRIDGE below the baseline's."""
    algorithms = [str(name) for name in results.algorithm.values]
    lines = []
    for ours in (name for name in algorithms if name.startswith("bridge")):
        for baseline in (name for name in algorithms if not name.startswith("bridge")):
            gap = difference(results, "suboptimality", ours, baseline)
            lines.append(f"{ours} below {baseline}? {verdict(gap)}: paired difference {gap}")
    return lines


def _search_lines(results: xr.Dataset) -> list[str]:
    algorithms = [str(name) for name in results.algorithm.values if name != "bc"]
    best = ", ".join(f"{name} {float(results.best_candidate.sel(algorithm=name).mean()):.2f}" for name in algorithms)
    looked = "suboptimality_seen" in results
    which = "the policy searched that looked best" if looked else "even the best policy searched, so never regained"
    lines = [f"below the expert per round, {which}: {best}"]
    idle = [name for name in algorithms if bool((results.set_size.sel(algorithm=name).std("round") == 0).all())]
    if idle:
        lines.append(f"ruled out no policy in any round or seed: {', '.join(idle)}")
    return lines


def share(results: xr.Dataset, name: str) -> str:
    """In how many seeds a truth value holds, as a percentage."""
    return f"{100 * float(results[name].mean()):.0f} %"


def _offline_lines(results: xr.Dataset) -> list[str]:
    lines = [
        f"optimal policy in the offline set: {share(results, 'optimum_in_offline_set')} of seeds (radius "
        f"{float(results.radius.mean()):.3g}, {_size(results.offline_set_count.values)})",
    ]
    return lines + [
        f"expert within the {name} radius ({float(results[f'radius_{name}'].mean()):.3g}): "
        f"{share(results, f'expert_in_{name}')}"
        for name in ("stated", "repaired", "zero")
    ]


def _size(counts: FloatArray) -> str:
    """The mean exact size of the offline set, and in how many seeds nobody could count it."""
    known = counts[~np.isnan(counts)]
    uncounted = "too many states to count its policies"
    if not len(known):
        return uncounted
    mean = (
        f"mean exact size {float(known.mean()):.4g} policies"
        if np.isfinite(known).all()
        else "more than 1e308 policies"
    )
    return mean if len(known) == len(counts) else f"{mean} in {len(known)} of {len(counts)} seeds, else {uncounted}"


def continuous_lines(results: xr.Dataset) -> list[str]:
    """What a run in continuous control found about its search space, with Monte-Carlo errors."""

    def average(name: str, digits: int = 2) -> str:
        return f"{float(results[name].mean()):.{digits}f}"

    rounds, algorithms = results.sizes["round"], [str(name) for name in results.algorithm.values]
    held_out = average("held_out_likelihood") if bool(results.held_out_likelihood.notnull().all()) else "nothing"
    against_best, errors = [], []
    for name in algorithms:
        own = results.sel(algorithm=name)
        against_best.append(f"{name} {mean_of(own.suboptimality.sum('round') - rounds * own.best_candidate)}")
        errors.append(f"{name} {float(own.cumulative_error[:, -1].mean()):.2f}")
    return [
        f"cumulative regret against the candidate that looked best to each: {', '.join(against_best)}",
        f"Monte-Carlo standard error of one seed's cumulative suboptimality: {', '.join(errors)}",
        f"return of the expert {average('expert_return')}, of the clone {average('clone_return')} (difference in a "
        f"seed to within a standard error of {average('clone_gap_error')}); log-likelihood of an action under the "
        f"clone {average('likelihood')}, held out {held_out}",
        f"offline set: {average('offline_set_count', 1)} candidates within {average('radius')} of the clone; the "
        f"expert is at {average('expert_distance')}, inside in {share(results, 'expert_in_ball')} of seeds; typical "
        f"error of a feature vector {average('feature_error', 3)}",
        f"largest coordinate of the embedding seen {average('largest_coordinate')}, norm at most "
        f"{average('observed_bound')} over the trajectories seen",
    ]
