"""A run in numbers and words: means over seeds with 95 % intervals, and who was better than whom."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np
import scipy.stats
import xarray as xr
from numpy.typing import ArrayLike

from bridge_algos.mdp import FloatArray


@dataclass(frozen=True)
class Mean:
    """A mean over seeds with the half-width of its 95 % Student interval (infinite for one seed).

    >>> str(Mean(-1e-12, 0.0))
    '0.00 ± 0.00'
    """

    mean: float
    half_width: float

    def __str__(self) -> str:
        return f"{self.mean:z.2f} ± {self.half_width:.2f}" if np.isfinite(self.half_width) else f"{self.mean:z.2f}"


def mean_over_seeds(values: FloatArray, level: float = 0.95) -> tuple[FloatArray, FloatArray]:
    """Mean and half-width of its Student interval over the first axis, whose entries are independent seeds."""
    n = len(values)
    mean = values.mean(axis=0)
    if n < 2:
        return mean, np.full_like(mean, np.inf)
    return mean, scipy.stats.t.ppf((1 + level) / 2, n - 1) * values.std(axis=0, ddof=1) / np.sqrt(n)


def mean_of(values: ArrayLike, level: float = 0.95) -> Mean:
    """The mean of one number a seed, with its interval of another level where asked for.

    >>> str(mean_of([1.0, 2.0, 3.0]))
    '2.00 ± 2.48'
    """
    mean, half = mean_over_seeds(np.asarray(values), level)
    return Mean(float(mean), float(half))


def cumulative(results: xr.Dataset, variable: str, algorithm: str) -> FloatArray:
    """Cumulative sum over rounds of a per-round record, (seed, round)."""
    return np.asarray(results[variable].sel(algorithm=algorithm).transpose("seed", "round").cumsum("round"))


def final(results: xr.Dataset, variable: str, algorithm: str) -> Mean:
    """Cumulative record after the last round, mean and 95 % half-width over seeds."""
    return mean_of(cumulative(results, variable, algorithm)[:, -1])


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
        size = mean_of(own.set_size[:, -1])
        kinds = ["suboptimality"] if judged else ["suboptimality", "pseudo_regret"]
        regrets = [str(final(results, kind, name)) for kind in kinds]
        rows.append((name, *regrets, str(size), *([_milliseconds(own)] if timed else [])))
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    many = f"{seeds} seeds" if seeds > 1 else "one seed"
    lines = [f"{results.attrs['title']}, after {rounds} rounds (mean ± 95 % half-width over {many})"]
    lines += [
        "  ".join(
            cell.ljust(width) if i == 0 else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]
    offline = _offline_lines if "radius_stated" in results else continuous_lines
    lines += ["", *comparisons(results), *_search_lines(results), *offline(results)]
    lines += [f"no guarantee: {caveat}" for caveat in json.loads(results.attrs["caveats"])]
    # equal in all seeds, unless machines or versions of the solver made them, which choose among optimal policies
    lines.append(results.attrs.get("expert", "the seeds describe their experts differently; run them on one machine"))
    return "\n".join(lines)


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
        f"{float(results.radius.mean()):.3g}, mean exact size {float(results.offline_set_count.mean()):.4g} policies)",
    ]
    return lines + [
        f"expert within the {name} radius ({float(results[f'radius_{name}'].mean()):.3g}): "
        f"{share(results, f'expert_in_{name}')}"
        for name in ("stated", "repaired", "zero")
    ]


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
