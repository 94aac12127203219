"""One seed of a run: demonstrations, offline stage, every algorithm's online stage, as one labelled data set."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from threadpoolctl import threadpool_limits

from bridge_algos.evaluation import expected_return, expected_returns
from bridge_algos.given import checked
from bridge_algos.hellinger import squared_hellinger
from bridge_algos.offline.policy_set import PolicySet
from bridge_algos.online.loop import Learner, OnlineProblem, run_online
from bridge_algos.run.candidates import Candidates, recorded
from bridge_algos.run.config import RunConfig
from bridge_algos.run.dataset import constant_record, seed_dataset
from bridge_algos.run.learners import make_learner
from bridge_algos.run.offline import offline_stage
from bridge_algos.run.streams import stream
from bridge_algos.run.versions import package_versions
from bridge_algos.run.world import World, build_oracle, caveats

Log = Callable[[Learner, Candidates, dict[str, Any]], None]


@checked
def run_seed(config: RunConfig, world: World, seed: int, log: Log | None = None) -> xr.Dataset:
    """All algorithms of a configuration on one seed.

    Args:
        log: receives each learner and its candidates with its rounds, as
            :func:`bridge_algos.online.loop.run_online` records them.

    Returns:
        A data set with one variable per name in ``RECORDED`` over (algorithm, round), the offline stage's numbers as
        scalars, and configuration, seed and versions as attributes. The numbers depend on configuration and seed only.
    """
    with threadpool_limits(1):
        return _run_seed(config, world, seed, log)


def _run_seed(config: RunConfig, world: World, seed: int, log: Log | None) -> xr.Dataset:
    mdp = world.mdp
    stage = offline_stage(config, world, seed)
    radius, clone = stage.radius, stage.clone
    problem = OnlineProblem(
        mdp, world.embedding, build_oracle(config, world), world.optimum, world.expert.expected_return, world.w_star
    )
    records, best, search = {}, {}, {}
    for name in config.algorithms:
        if name == "bc":
            value = expected_return(mdp, clone)
            gaps = world.expert.expected_return - value, world.expert.best_stationary.value - value
            records[name] = constant_record(config.rounds, *gaps)
            best[name] = records[name]["suboptimality"][0]
            search[name] = Candidates(clone[None], "bc")
            continue
        learner, search[name] = make_learner(name, config, world, stage.offline_set, stage.transitions, seed)
        keep = None if log is None else partial(log, learner, search[name])
        records[name] = run_online(problem, learner, config.rounds, stream(seed, name), keep)
        best[name] = world.expert.expected_return - expected_returns(mdp, learner.policies).max()
    distance = _expert_distance(world, PolicySet(stage.estimate, clone, radius))
    scalars = {
        "clone_return": (expected_return(mdp, clone), "reward per trajectory"),
        "expert_distance": (distance, "Hellinger distance to the clone under the estimate"),
        "optimum_in_offline_set": (float(stage.offline_set.contains(world.optimum)), "1 = yes"),
        "states_visited": (float((stage.pairs.sum(axis=1) > 0).sum()), "states"),
        "radius": (radius, "Hellinger distance"),
        "offline_set_count": (_count(stage.offline_set), "policies"),
    }
    for name, value in world.radii.items():
        if name == "stated-known":  # of the real dynamics, where the distances here are under the estimate
            continue
        scalars[f"radius_{name}"] = (value, "Hellinger distance")
        within = _expert_distance(world, stage.version_space) == 0 if name == "zero" else distance <= value
        scalars[f"expert_in_{name}"] = (float(within), "1 = yes")
    attributes = {
        "versions": json.dumps(package_versions()),
        "caveats": json.dumps(caveats(config, world)),
        "expert": world.expert.describe(),
        "expert_return": world.expert.expected_return,
        "optimum_return": world.expert.best_stationary.value,
        "optimum_upper": world.expert.best_stationary.upper,
        "utility_scale": world.utility_scale,
    }
    return seed_dataset(config, seed, records, scalars, attributes).assign(
        best_candidate=("algorithm", list(best.values()), {"units": "reward per trajectory below the expert"}),
        **recorded(search),
    )


def _expert_distance(world: World, offline: PolicySet) -> float:
    """Hellinger distance of the expert to the clone under the estimate; zero where it may be rounding alone."""
    expert, estimate = world.expert.policy, offline.dynamics
    if expert.ndim == 1:
        return float(offline.distances(expert[None])[0])
    squared = squared_hellinger(estimate, expert, estimate, offline.center)
    return float(np.sqrt(squared)) if squared > 1e-12 else 0.0


def _count(offline: PolicySet) -> float:
    """How many policies the set has: NaN where it cannot be listed, infinity beyond every double."""
    if not offline.is_listed:
        return float("nan")
    try:
        return float(offline.count())
    except OverflowError:
        return float("inf")
