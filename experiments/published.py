"""The authors' published curves, as data, and how ours lie beside them."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.stats import norm

from bridge_algos.envs.registry import make_mdp
from bridge_algos.mdp import FloatArray, TabularMDP
from bridge_algos.policies import random_policies
from bridge_algos.run.config import RunConfig
from bridge_algos.run.plots import STYLES
from bridge_algos.run.summary import Mean, cumulative, mean_of, mean_over_seeds
from bridge_algos.trajectories import sample_trajectories

ALGORITHMS = ("bridge", "pbrl")


def published_curves(environment: str) -> dict[str, Any] | None:
    """Published means and 95 % half-widths of an environment (``"starmdp"``), or None where none were published."""
    text = files("experiments").joinpath("data/published_curves.json").read_text()
    curves: dict[str, Any] = {name.lower(): value for name, value in json.loads(text).items() if name != "source"}
    return curves.get(environment)


def draw_beside(axes_regret: Any, axes_size: Any, curves: dict[str, Any]) -> None:
    """Add the published curves, dashed, in the colours of ours; bars for their intervals, as bands would cover ours."""
    rounds = np.arange(1, curves["rounds"] + 1)
    for axes, key, floor in ((axes_regret, "cumulative_regret", -np.inf), (axes_size, "policy_set_size", 1.0)):
        for offset, name in enumerate(ALGORITHMS):
            mean, half = (np.array(curves[name][key][entry]) for entry in ("mean", "ci95_half_width"))
            axes.errorbar(
                rounds,
                mean,
                yerr=[mean - np.maximum(mean - half, floor), half],
                errorevery=(2 + 2 * offset, max(1, curves["rounds"] // 6)),
                color=STYLES[name]["color"],
                linestyle="--",
                linewidth=1.2,
                elinewidth=0.9,
                capsize=2,
                label=f"{STYLES[name]['label']}, published",
            )


def agrees(mean: ArrayLike, half: ArrayLike, theirs: ArrayLike, their_half: ArrayLike) -> NDArray[np.bool_]:
    """Whether the 95 % interval of the difference of two independent means, both taken as normal, contains zero.

    Elementwise; False where ours has no interval, as the mean of one seed: nothing shows that it agrees.
    """
    gap = np.abs(np.asarray(mean) - np.asarray(theirs))
    return np.asarray(np.isfinite(half) & (gap <= np.hypot(half, their_half) + 1e-9))


def agreement(ours: Mean, published: Mean) -> str:
    """Whether two means agree, in words; see :func:`agrees`.

    >>> agreement(Mean(10.0, 3.0), Mean(16.0, 4.0))
    'published 16.00 ± 4.00, ours 10.00 ± 3.00: they do not agree, ours is lower by 6.00 ± 5.00'
    """
    beside = f"published {published}, ours {ours}"
    if not np.isfinite(ours.half_width):
        return f"{beside}: one seed has no interval to compare within"
    distance = Mean(abs(ours.mean - published.mean), float(np.hypot(ours.half_width, published.half_width)))
    if agrees(ours.mean, ours.half_width, published.mean, published.half_width):
        return f"{beside}: they agree within the intervals, {distance} apart"
    side = "higher" if ours.mean > published.mean else "lower"
    return f"{beside}: they do not agree, ours is {side} by {distance}"


def agreeing_rounds(values: FloatArray, curve: dict[str, Any]) -> int:
    """In how many rounds ours, (seeds, rounds), agree with a published curve."""
    return int(agrees(*mean_over_seeds(values), curve["mean"], curve["ci95_half_width"]).sum())


def agreement_lines(results: xr.Dataset, curves: dict[str, Any]) -> list[str]:
    """Regret and policies left, ours and theirs: after the last round, and in how many rounds; a line each."""
    lines = []
    for name in ALGORITHMS:
        for label, key, values in (
            ("cumulative regret", "cumulative_regret", cumulative(results, "suboptimality", name)),
            ("|Pi_t|", "policy_set_size", np.asarray(results.set_size.sel(algorithm=name).transpose("seed", "round"))),
        ):
            published = Mean(curves[name][key]["mean"][-1], curves[name][key]["ci95_half_width"][-1])
            told = f"{STYLES[name]['label']}, last {label}: {agreement(mean_of(values[:, -1]), published)}"
            if len(values) > 1:
                told += f"; agreement in {agreeing_rounds(values, curves[name][key])} of {values.shape[1]} rounds"
            lines.append(f"{told}.")
    return lines


def comparison_text(results: xr.Dataset, curves: dict[str, Any]) -> str:
    """Ours against theirs after the last round: do they agree within the intervals, and what differs by design?"""
    lines = ["Beside the published curves, with 95 % intervals:", *agreement_lines(results, curves)]
    lines.append(
        f"Expert's return: published {curves['expert_return']:.2f} (simulated), "
        f"ours {results.attrs['expert_return']:.2f} (exact)."
    )
    config = RunConfig.from_json(results.attrs["configuration"])
    mdp = make_mdp(config.environment, **config.environment_options)
    noise = evaluation_noise(mdp)
    for name in ALGORITHMS:
        regret = np.asarray(results.suboptimality.sel(algorithm=name))
        lines.append(
            f"{STYLES[name]['label']}: estimated from 1000 rollouts and clipped at zero in every round, as published, "
            f"our cumulative regret would read {clipped_mean(regret, noise).sum(axis=1).mean():.2f} instead of "
            f"{regret.sum(axis=1).mean():.2f}."
        )
    lines.append(
        "Ours has exact features where theirs are means of 100 rollouts, counts as transition model, and the settings "
        "that the paper leaves open as documented in RunConfig (lambda = 1, data matrix of expected differences)."
    )
    return "\n".join(lines)


def evaluation_noise(mdp: TabularMDP, rollouts: int = 1000) -> float:
    """Standard deviation of a difference of two mean returns, each over ``rollouts`` trajectories of random policies.

    The paper evaluates the greedy policy and the expert this way in every round; the deviation of a single return is
    itself estimated, from 100 trajectories of each of 100 random policies.
    """
    rng = np.random.default_rng(0)
    policies = random_policies(100, mdp.n_states, mdp.n_actions, rng)
    returns = [sample_trajectories(mdp, policy, 100, rng).rewards for policy in policies]
    variance = np.mean([np.var(np.sum(rewards, axis=1), ddof=1) for rewards in returns if rewards is not None])
    return float(np.sqrt(2 * variance / rollouts))


def clipped_mean(values: FloatArray, noise: float) -> FloatArray:
    """E max(0, value + N(0, noise^2)), elementwise: what clipping makes of a noisy estimate."""
    scaled = values / noise
    return np.asarray(values * norm.cdf(scaled) + noise * norm.pdf(scaled))
