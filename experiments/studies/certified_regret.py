r"""Certified regret: what runs lose, beside what their logs certify by the earlier bound and by the answers alone.

Each seed is run twice with known dynamics and answers of a teacher of a declared range: once with the sets of audit R1,
whose width contains kappa, and once with the likelihood set. The checker certifies both logs by audit R4 and by
companion G6.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.asking.utility import simulated_utility
from bridge_algos.run.config import RunConfig, preset
from bridge_algos.run.log import logged_seed
from bridge_algos.run.world import build_world
from bridge_theory.errors import ComputationError
from experiments.cells import Cell, run_cells
from experiments.studies.certified_regret_report import figure, report
from proofs_checks.verify import verify

SETS = ("repaired", "likelihood")
CERTIFIED = ("trivial", "best", "likelihood")
"""Names of bounds in a certificate: the trivial one, the least of audit R4, companion G6."""


def compute(settings: dict[str, Any], directory: Path, jobs: int) -> xr.Dataset:
    """Regret, bounds and policies left over (run, round), in nats; runs have a confidence set and a seed."""
    config = _configuration(settings)
    cells = [
        {"configuration": asdict(config), "confidence": name, "seed": seed}
        for name in SETS
        for seed in range(settings["seeds"])
    ]
    data = run_cells(measure, cells, directory, jobs, "runs").rename(cell="run").drop_vars("configuration")
    return data.assign_attrs(weight_bound=config.weight_bound)


def measure(cell: Cell) -> xr.Dataset:
    """One run, with what the checker certifies of its log."""
    config = RunConfig.from_json(json.dumps(cell["configuration"])).but(confidence=cell["confidence"])
    world = build_world(config)
    results, log = logged_seed(config, world, cell["seed"])
    (certificate,) = verify(log)
    if not certificate.certified:
        raise ComputationError(f"the log of seed {cell['seed']} is not certified: {certificate.reasons[0]}")
    own = results.isel(algorithm=0)
    columns = {
        "regret": world.utility_scale * np.cumsum(own.pseudo_regret.values),
        "left": own.set_size.values,
        **{f"bound_{name}": certificate.bounds[name] for name in CERTIFIED},
    }
    return xr.Dataset({name: ("round", values) for name, values in columns.items()})


def figures(data: xr.Dataset) -> dict[str, Any]:
    """Regret and its bounds over the rounds."""
    return {"": figure(data)}


def words(data: xr.Dataset) -> str:
    """What was lost and what was certified."""
    return report(data)


def _configuration(settings: dict[str, Any]) -> RunConfig:
    """The theory preset with W at the declared range of utilities, in nats."""
    config = preset("theory", settings["environment"]).but(
        n_demonstrations=settings["demonstrations"],
        rounds=settings["rounds"],
        comparisons=settings["comparisons"],
        delta=settings["delta"],
        pair_rule=settings["pair_rule"],
        algorithms=("bridge-known",),
    )
    unit = simulated_utility(build_world(config).mdp, config.embedding, weight_norm=1.0)
    return config.but(weight_bound=settings["range"] / unit.utility_range)
