"""The authors' published curves, as data, and how ours lie beside them."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from bridge_algos.envs.registry import make_mdp
from bridge_algos.expert.experts import make_expert
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_algos.run.config import RunConfig
from bridge_algos.run.plots import STYLES
from bridge_algos.run.summary import Mean, cumulative, mean_of, mean_over_seeds

ALGORITHMS = ("bridge", "pbrl")


def published_curves(environment: str) -> dict[str, Any] | None:
    """Published means and 95 % half-widths of an environment (``"starmdp"``), or None where none were published."""
    text = files("experiments").joinpath("data/published_curves.json").read_text()
    curves: dict[str, Any] = {name.lower(): value for name, value in json.loads(text).items() if name != "source"}
    return curves.get(environment)


def draw_beside(axes_regret: Any, axes_size: Any, curves: dict[str, Any]) -> None:
    """Add the published curves, dashed, in the colours of ours; bars for their intervals, as bands would cover ours.

    The legend says where their regret has another unit.
    """
    rounds = np.arange(1, curves["rounds"] + 1)
    unit = " (regret in its own unit)" if "stopped" in curves else ""
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
                label=f"{STYLES[name]['label']}, published{unit}",
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
    """Regret and policies left, ours and theirs: after the last round, and in how many rounds; a line each.

    Where their regret has a unit of its own (``"stopped"`` is in the curves) it is shown and not compared.
    """
    lines = []
    for name in ALGORITHMS:
        for label, key, values in (
            ("cumulative regret", "cumulative_regret", cumulative(results, "suboptimality", name)),
            ("|Pi_t|", "policy_set_size", np.asarray(results.set_size.sel(algorithm=name).transpose("seed", "round"))),
        ):
            published = Mean(curves[name][key]["mean"][-1], curves[name][key]["ci95_half_width"][-1])
            ours, head = mean_of(values[:, -1]), f"{STYLES[name]['label']}, last {label}:"
            if "stopped" in curves and key == "cumulative_regret":
                lines.append(f"{head} published {published} in their unit, ours {ours} in reward: not compared.")
                continue
            told = f"{head} {agreement(ours, published)}"
            if len(values) > 1:
                told += f"; agreement in {agreeing_rounds(values, curves[name][key])} of {values.shape[1]} rounds"
            lines.append(f"{told}.")
    return lines


def published_unit(curves: dict[str, Any]) -> str:
    """What the published tabular regret counts, and what it leaves out; from the authors' public per-seed metrics."""
    stopped = "; ".join(
        f"{STYLES[name]['label']} {count['stopped_entries']} of {count['entries']} entries, in "
        f"{count['stopped_seeds']} of {curves['seeds']} seeds"
        for name, count in curves["stopped"].items()
    )
    return (
        "The published regret is in a unit of its own: a return there is the sum over t < H of 0.99^(3t) r(s_t), for "
        "the state left, from 1000 rollouts and not clipped; ours is the exact sum of H rewards on arrival. When a "
        "seed's policy set has shrunk to one policy, their run stops and counts regret zero in every later round "
        f"({stopped}), whether or not that policy is optimal; ours goes on. Counted from the authors' public per-seed "
        "metrics."
    )


def comparison_text(results: xr.Dataset, curves: dict[str, Any]) -> str:
    """Ours and theirs after the last round: what can be compared, and what differs by design."""
    config = RunConfig.from_json(results.attrs["configuration"])
    mdp = make_mdp(config.environment, **config.environment_options)
    expert = make_expert(mdp, config.expert, config.discount, config.solver).policy
    return "\n".join(
        [
            "Beside the published curves, with 95 % intervals:",
            published_unit(curves),
            *agreement_lines(results, curves),
            f"Expert's return: published {curves['expert_return']:.2f}, a mean over "
            f"{curves['expert_return_while_running']:.2f} while a run goes on and 1 after it stopped; exact in their "
            f"unit {published_return(mdp, expert):.2f}, in ours {results.attrs['expert_return']:.2f}.",
            "Ours has exact features where theirs are means of 100 rollouts, counts as transition model, and the "
            "settings that the paper leaves open as documented in RunConfig (lambda = 1, data matrix of expected "
            "differences).",
        ]
    )


def published_return(mdp: TabularMDP, policy: IntArray) -> float:
    r"""The expected return of a deterministic policy in the published unit.

    .. math:: \sum_{t=0}^{H-1} 0.99^{3t}\, E[r(s_t)]

    The reward is that of the state left: the start counts, the last arrival does not.

    >>> from bridge_algos.expert.experts import make_expert
    >>> mdp = make_mdp("starmdp")
    >>> round(published_return(mdp, make_expert(mdp, "discounted-lp").policy), 4)
    34.9577
    """
    law, total = mdp.initial, 0.0
    kernel = mdp.transitions[np.arange(mdp.n_states), policy]
    for step in range(mdp.horizon):
        total += 0.99 ** (3 * step) * float(law @ mdp.reward)
        law = law @ kernel
    return total
