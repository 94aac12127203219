r"""The paper's offline ablation table, counted exactly, under every rule for the radius that a reader would try.

The table ("Empirical validation of confidence set scaling", Gridworld) reports which share of policies the Hellinger
ball keeps for some numbers of demonstrations and levels of noise, but not the radius. Here the share is exact, out of
all A^S deterministic stationary policies, with the offline stage of the published preset (deterministic clone, count
estimate), and the coverage of the expert stands beside it. The shares around stochastic clones, for which counting by
cubes has no exact form, are estimated from uniform random policies.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import xarray as xr

import bridge_theory as theory
from bridge_algos.envs.registry import make_mdp
from bridge_algos.mdp import FloatArray
from bridge_algos.offline.data_radius import data_dependent_radius, leaving_radius
from bridge_algos.offline.step_counts import step_counts
from bridge_algos.offline.transitions import EmptyRow, estimate_transitions
from bridge_algos.policies import random_policies
from bridge_algos.run.config import RunConfig, preset
from bridge_algos.run.offline import OfflineStage, offline_stage
from bridge_algos.run.streams import stream
from bridge_algos.run.world import World, build_world
from experiments.cells import Cell, run_cells
from experiments.studies.ablation_report import figure, report
from experiments.studies.radius_rules import formulas
from experiments.studies.soft_clones import SOFT_CLONES, overlaps

ENVIRONMENT = "gridworld"
HAND = 0.96
"""The radius of the published Gridworld runs."""

FIRST = 10
"""Demonstrations at which a rescaled radius is what its name says."""

RULES = {
    "hand": "0.96, as in the published runs",
    "below_one": "the largest below 1",
    "hand_scaled": "0.96 sqrt(10/n)",
    "one_scaled": "sqrt(10/n)",
    "policy_term": "alpha/sqrt(n), first term of the theorem",
    "no_bracket": "(alpha + beta)/sqrt(n), without the bracket",
    "stated": "stated theorem",
    "stated_scaled": "stated, scaled to 1 at n = 10",
    "known": "stated lemma for known dynamics",
    "repaired": "repaired (T9)",
    "sharp": "repaired, angle form (T9)",
    "data": "from data (T9, T10)",
    "leaving": "from data (T8B)",
    "zero": "zero (T8A)",
}
"""Rules for the radius around the deterministic clone, with their descriptions."""

BELOW_ONE = 1 - 1e-9
ROWS = get_args(EmptyRow)
THRESHOLDS = -np.arange(181) / 10
"""log10 of the smallest overlap 1 - r^2 that a ball around a stochastic clone keeps."""


def compute(settings: dict[str, Any], directory: Path, jobs: int) -> xr.Dataset:
    """Shares and coverage over (cell, rule, seed), one cell for each pair of n and noise."""
    shared = {name: settings[name] for name in ("seeds", "sampled_policies")}
    cells = [
        {**shared, "demonstrations": n, "noise": noise}
        for noise in settings["noise"]
        for n in settings["demonstrations"]
    ]
    results = run_cells(measure, cells, directory, jobs, "ablation").drop_vars(list(shared))
    mdp = make_mdp(ENVIRONMENT)
    return results.assign_attrs(
        environment=mdp.name,
        actions=mdp.n_actions,
        one_start=int((mdp.initial > 0).sum() == 1),
        rules=json.dumps(RULES),
        soft_clones=json.dumps({key: text for key, (text, _) in SOFT_CLONES.items()}),
        **shared,
    )


def measure(cell: Cell) -> xr.Dataset:
    """All seeds of one number of demonstrations and one level of noise."""
    config = preset("published", ENVIRONMENT).but(
        n_demonstrations=cell["demonstrations"], noise=cell["noise"], radius=HAND
    )
    world = build_world(config)
    fixed = fixed_radii(config, world)
    seeds = range(cell["seeds"])
    stages = [offline_stage(config, world, seed) for seed in seeds]
    counted = [_counted(config, world, stage, fixed) for stage in stages]
    soft = [_sampled(cell, world, stage, seed) for stage, seed in zip(stages, seeds, strict=True)]
    radius, share, covered = (np.stack(part, axis=1) for part in zip(*counted, strict=True))
    soft_share, soft_expert = (np.stack(part, axis=-1) for part in zip(*soft, strict=True))
    everything = "share of all deterministic stationary policies"
    return xr.Dataset(
        {
            "radius": (("rule", "seed"), radius, {"units": "Hellinger distance"}),
            "share": (("rule", "seed"), share, {"units": everything}),
            "covered": (("rule", "seed"), covered, {"units": "1 = the expert is inside"}),
            "soft_share": (("clone", "rows", "threshold", "seed"), soft_share, {"units": everything}),
            "soft_expert": (("clone", "rows", "seed"), soft_expert, {"units": "log10 of the expert's overlap"}),
        },
        coords={
            "rule": list(RULES),
            "clone": list(SOFT_CLONES),
            "rows": list(ROWS),
            "threshold": THRESHOLDS,
            "seed": list(seeds),
        },
    )


def figures(data: xr.Dataset) -> dict[str, Any]:
    """Shares kept beside the published ones, and the coverage of the expert."""
    return {"": figure(data)}


def words(data: xr.Dataset) -> str:
    """The table under every rule, which one agrees, and what cannot have produced it."""
    return report(data)


def fixed_radii(config: RunConfig, world: World) -> dict[str, float]:
    """The rules that need no data; radii are certified upper ends where they come from a theorem."""
    n, mdp = config.n_demonstrations, world.mdp
    rules = formulas(mdp.dynamics, world.expert.policy, config.delta)
    size = {"S": mdp.n_states, "A": mdp.n_actions, "delta": config.delta}
    alpha = theory.alpha_offline.enclosure(**size).upper / np.sqrt(n)
    beta = theory.beta_offline.enclosure(**size, H=mdp.horizon, n=n).upper / np.sqrt(n)
    return {
        "hand": HAND,
        "below_one": BELOW_ONE,
        "hand_scaled": HAND * np.sqrt(FIRST / n),
        "one_scaled": np.sqrt(FIRST / n),
        "policy_term": alpha,
        "no_bracket": alpha + beta,
        "stated_scaled": rules["stated"].radius(n) / rules["stated"].radius(FIRST),
        "known": theory.offline_radius_known.enclosure(**size, n=n).upper,
        "zero": 0.0,
        **{name: rules[name].radius(n) for name in ("stated", "repaired", "sharp")},
    }


def _counted(
    config: RunConfig, world: World, stage: OfflineStage, fixed: dict[str, float]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    mdp, expert, ball = world.mdp, world.expert.policy, stage.offline_set
    counts = step_counts(stage.demonstrations, mdp.n_states, mdp.n_actions)
    radii = fixed | {
        "data": data_dependent_radius(counts, stage.estimate, stage.clone, config.delta),
        "leaving": leaving_radius(counts, stage.estimate, stage.clone),
    }
    sets = {name: replace(ball, radius=radius) for name, radius in radii.items()}
    sets["zero"] = stage.version_space
    everything = mdp.n_actions**mdp.n_states
    return (
        np.array([radii[name] for name in RULES]),
        np.array([sets[name].count() / everything for name in RULES]),
        np.array([float(sets[name].contains(expert)) for name in RULES]),
    )


def _sampled(cell: Cell, world: World, stage: OfflineStage, seed: int) -> tuple[FloatArray, FloatArray]:
    """Shares kept at each threshold, and the expert's log10 overlap, for each clone and each kind of empty rows."""
    mdp = world.mdp
    policies = random_policies(cell["sampled_policies"], mdp.n_states, mdp.n_actions, stream(seed, "candidates"))
    batch = np.concatenate([world.expert.policy[None], policies])
    share = np.empty((len(SOFT_CLONES), len(ROWS), len(THRESHOLDS)))
    expert = np.empty(share.shape[:2])
    for i, (_, make_clone) in enumerate(SOFT_CLONES.values()):
        clone = make_clone(stage.pairs)
        for j, empty_row in enumerate(ROWS):
            estimate = mdp.dynamics.under(estimate_transitions(stage.transitions, empty_row))
            with np.errstate(divide="ignore"):
                log_overlap = np.log10(overlaps(estimate, clone, batch))
            expert[i, j] = log_overlap[0]
            share[i, j] = (log_overlap[1:, None] >= THRESHOLDS).mean(axis=0)
    return share, expert
