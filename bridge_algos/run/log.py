"""Running a seed with its log, for a checker that trusts neither the learner nor the fitted weights."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bridge_algos.online.loop import Learner
from bridge_algos.run.candidates import Candidates, sentence
from bridge_algos.run.config import RunConfig
from bridge_algos.run.log_file import FORMAT, RunLog
from bridge_algos.run.offline import offline_stage
from bridge_algos.run.seed import run_seed
from bridge_algos.run.versions import package_versions
from bridge_algos.run.world import World


def logged_seed(config: RunConfig, world: World, seed: int) -> tuple[xr.Dataset, RunLog]:
    """Run one seed and keep its log; the data set is that of :func:`bridge_algos.run.seed.run_seed`."""
    learners: dict[str, Learner] = {}
    rounds: dict[str, list[dict[str, Any]]] = {}
    search: dict[str, str] = {}

    def keep(learner: Learner, found: Candidates, entry: dict[str, Any]) -> None:
        learners[learner.name] = learner
        search[learner.name] = sentence(found)
        rounds.setdefault(learner.name, []).append(entry)

    dataset = run_seed(config, world, seed, keep)
    demonstrations = offline_stage(config, world, seed).demonstrations
    arrays = {
        "transitions": world.mdp.transitions,
        "initial": world.mdp.initial,
        "demonstrations/states": demonstrations.states,
        "demonstrations/actions": demonstrations.actions,
    }
    for name, learner in learners.items():
        arrays |= {f"{name}/{entry}": array for entry, array in _arrays_of(learner, rounds[name]).items()}
    header = {
        "format": FORMAT,
        "configuration": json.loads(config.to_json()),
        "seed": seed,
        "horizon": world.mdp.horizon,
        "weight_bound": world.weight_bound,
        "algorithms": list(learners),
        "search": search,
        "versions": package_versions(),
    }
    return dataset, RunLog(header, arrays)


def _arrays_of(learner: Learner, rounds: list[dict[str, Any]]) -> dict[str, NDArray[Any]]:
    columns = {name: np.array([entry[name] for entry in rounds]) for name in rounds[0]}
    arrays = {name: columns[name] for name in ("states", "actions", "outcomes", "gamma", "log_det", "uncertainty")}
    return arrays | {
        "policies": learner.policies,
        "pairs": columns["pair"],
        "bonus": columns["bonus"],
        "set_size": columns["kept"].sum(axis=1),
        "w": np.concatenate([columns["w"], columns["w_next"][-1:]]),
        "solver_error": np.concatenate([columns["solver_error"], columns["solver_error_next"][-1:]]),
    }
