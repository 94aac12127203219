"""Figure 2, continuous control: the published preset with and without the expert among the candidates.

The published runs search the expert's own policy beside the clone's noisy copies. A learner who has only
demonstrations cannot do that, so both settings are run, on the same demonstrations, candidates and rollouts. They also
read the regret of the policy chosen off the rollouts that chose it, clipped at zero in each round; that reading is
drawn beside their curves and nowhere else: our regret is judged on fresh initial states.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Literal

import xarray as xr

from bridge_algos.continuous.config import ContinuousConfig
from bridge_algos.run import plots
from bridge_algos.run.runner import run
from bridge_algos.run.summary import final, mean_of, table
from experiments.published import ALGORITHMS, agreement_lines, draw_beside, published_curves

SEARCHES = {"without-expert": False, "with-expert": True}
"""Name of a search space, and whether the expert is in it."""
TITLES = {"without-expert": "the expert is not a candidate", "with-expert": "the expert is a candidate, as published"}


def compute(settings: dict[str, Any], directory: Path, jobs: int) -> xr.Dataset:
    """The runs of ``settings["configuration"]`` on seeds 0 .. ``settings["seeds"]`` - 1; a seed is resumable inside."""
    return both_searches(configured(settings), settings["seeds"], directory, jobs)


def configured(settings: dict[str, Any]) -> ContinuousConfig:
    """The configuration of a study, whatever the search space."""
    return ContinuousConfig.from_json(json.dumps(settings["configuration"]))


def both_searches(base: ContinuousConfig, seeds: int, directory: Path, jobs: int) -> xr.Dataset:
    """A configuration without and with the expert among the candidates, joined along ``search``.

    Measured times stay in the files of the seeds, in which a run resumes.
    """
    parts = []
    for name, included in SEARCHES.items():
        results = run(base.but(include_expert=included), directory / name, seeds, jobs)
        parts.append(results.sel(seed=range(seeds)).drop_vars("seconds"))
    return joined(parts, "search", list(SEARCHES))


COMPARED = [
    "suboptimality",
    "suboptimality_seen",
    "set_size",
    "best_candidate",
    "offline_set_count",
    "expert_in_ball",
    "expert_return",
    "clone_return",
]
"""What studies of many runs keep of each; the rest stays in the files of the seeds."""


def joined(
    parts: list[xr.Dataset], dimension: str, labels: list[str], join: Literal["exact", "outer"] = "exact"
) -> xr.Dataset:
    """Runs side by side along a new dimension; versions that differ between them are said to be various."""
    together = xr.concat(parts, dim=dimension, combine_attrs="drop_conflicts", join=join)
    for variable in together.data_vars.values():
        variable.encoding = {"zlib": True, "complevel": 9}
    various = (
        {"versions": json.dumps("various; see the files of the seeds")} if "versions" not in together.attrs else {}
    )
    return together.assign_coords({dimension: labels}).assign_attrs(various)


def figures(data: xr.Dataset) -> dict[str, Any]:
    """Regret against the expert and policies left in each search space; regret against what looked best of all."""
    curves, pictures = published_curves(_configuration(data).environment), {}
    for name in SEARCHES:
        picture = plots.figure(data.sel(search=name))
        picture.suptitle(f"{_heading(data)}: {TITLES[name]}", fontsize=10)
        pictures[name] = picture
    pictures["against-best"] = _against_best(data)
    if curves is not None and curves["rounds"] == data.sizes["round"]:
        pictures["published"] = _beside_published(data, curves)
    return pictures


def as_published(data: xr.Dataset) -> xr.Dataset:
    """The runs with the expert, their regret as the published runs read it."""
    included = data.sel(search="with-expert")
    return included.assign(suboptimality=included.suboptimality_seen.clip(min=0))


def _beside_published(data: xr.Dataset, curves: dict[str, Any]) -> Any:
    picture = plots.figure(as_published(data).sel(algorithm=list(ALGORITHMS)))
    regret, sizes = picture.axes
    draw_beside(regret, sizes, curves)
    regret.set_title("on the rollouts that chose it, clipped", fontsize=9)
    picture.suptitle(f"{_heading(data)}: beside the published curves (of other questions)", fontsize=10)
    return picture


def _against_best(data: xr.Dataset) -> Any:
    from matplotlib.figure import Figure

    picture = Figure(figsize=(6.6, 3.2), layout="constrained")
    for axes, name in zip(picture.subplots(1, 2, sharey=True), SEARCHES, strict=True):
        own = data.sel(search=name)
        gap = own.suboptimality - own.best_of_all
        plots.draw_cumulative(axes, own.assign(against_best=gap), "against_best", "looked best")
        axes.set_title(TITLES[name], fontsize=9)
    picture.suptitle(f"{_heading(data)}: regret against the candidate that looked best", fontsize=10)
    return picture


def words(data: xr.Dataset) -> str:
    """The table of each search space, what clipping would have made of it, and the published curves."""
    config, lines = _configuration(data), []
    expert = f"expert: {config.expert or f'shipped, {config.environment}'}"
    for name in SEARCHES:
        title = f"{config.environment}, {TITLES[name]}"
        lines += [table(data.sel(search=name).assign_attrs(title=title, expert=expert)), ""]
    included, curves = as_published(data), published_curves(config.environment)
    if curves is None:
        lines.append("No published curves of this environment are at hand to compare with.")
    elif curves["rounds"] != data.sizes["round"]:
        lines.append(f"Not compared with the published curves, which have {curves['rounds']} rounds.")
    else:
        lines.append(
            "Beside the published curves, with 95 % intervals: the expert among the candidates, and regret read as "
            "there, off the rollouts that chose the policy and clipped at zero in every round. The unit is the same, "
            "but the published runs ask other questions and clone other demonstrations (see the differences below), so "
            "that agreement does not show that ours repeat them:"
        )
        lines += agreement_lines(included, curves)
        lines += _log_dets(included, curves["log_det"])
        fresh = data.sel(search="with-expert")
        for name in ALGORITHMS:
            judged, read = final(fresh, "suboptimality", name), final(included, "suboptimality", name)
            lines.append(f"{name}: judged on fresh initial states {judged}, read as published {read}.")
        lines.append(
            f"Return of the expert: published {curves['expert_return']:.2f}, ours {mean_of(included.expert_return)}; "
            f"of the clone: published {curves['bc_return']:.2f}, ours {mean_of(included.clone_return)}."
        )
    lines.append(f"Known differences to the published runs: {'; '.join(departures(config))}.")
    return "\n".join(lines)


def _log_dets(data: xr.Dataset, published: dict[str, Any]) -> list[str]:
    """How far the questions have taken the data matrix: it shows which questions were asked, before any regret."""
    lines = []
    for name in ALGORITHMS:
        after = [t for t in published["after_rounds"] if t < data.sizes["round"]]  # a round records what it starts with
        ours = data.log_det.sel(algorithm=name, round=[t + 1 for t in after]).mean("seed").values
        theirs = published[name][: len(after)]
        lines.append(
            f"{plots.STYLES[name]['label']}, log det of the data matrix after {', '.join(map(str, after))} rounds: "
            f"published {', '.join(f'{x:.1f}' for x in theirs)}, ours {', '.join(f'{x:.1f}' for x in ours)}."
        )
    return lines


DEPARTURES = {
    "reacher": [
        "the expert is another one, trained with the same settings",
        "its demonstrations have mean actions, theirs sampled ones (their call passes 'deterministic' where "
        "Stable-Baselines3 reads 'state')",
        "we compare the widest pair, as their stored parameters say, but their stored data are those of the greedy "
        "policy against a random one, as their appendix says",
    ],
    "ant": [
        "the expert is another one, trained by our PPO on episodes of 100 steps, theirs by TD3; theirs lies inside the "
        "radius in every seed, so that only seeds in which ours does can be compared",
        "features of an episode that ends early are divided by the horizon, as the paper defines, theirs by its steps",
    ],
}
"""What the published preset of an environment does otherwise than the authors' published runs, as far as known."""


def departures(config: ContinuousConfig) -> list[str]:
    """The known differences between a configuration made from a published preset and the published runs."""
    return [
        *DEPARTURES.get(config.environment, []),
        f"expert and clone have features from {config.rollouts} rollouts, as all candidates do, theirs from 1000",
        "an action out of range counts as clipped in rewards and features, theirs whole",
    ]


def _heading(data: xr.Dataset) -> str:
    """Environment, and rollouts and seeds, which decide how much of a figure is luck."""
    config = _configuration(data)
    return f"{config.environment.capitalize()}, {config.rollouts} rollouts a policy, {data.sizes['seed']} seeds"


def _configuration(data: xr.Dataset) -> ContinuousConfig:
    return configured(json.loads(data.attrs["settings"]))
