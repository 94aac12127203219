"""Many seeds at once, resumable: joblib's current backend does the work, each seed is stored as soon as it is done."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

from bridge_algos.run.config import RunConfig
from bridge_algos.run.log import logged_seed
from bridge_algos.run.log_file import log_path, save_log
from bridge_algos.run.parallel import check_jobs, for_each
from bridge_algos.run.seed import run_seed
from bridge_algos.run.store import load_run, open_run, save_seed
from bridge_algos.run.world import World, build_oracle, build_world
from bridge_theory.errors import InputError


def run(
    config: RunConfig,
    directory: Path,
    seeds: int,
    jobs: int = 1,
    progress: bool | None = None,
    log: bool = False,
) -> xr.Dataset:
    """Run seeds 0..seeds-1 of a configuration, skipping those that the directory already holds.

    Args:
        directory: where results go; see :mod:`bridge_algos.run.store`.
        seeds: at least 1.
        jobs, progress: see :func:`bridge_algos.run.parallel.for_each`. The numbers do not depend on them.
        log: keep each seed's log for ``bridge-rl verify`` too; a finished seed without one is run again for it.

    Returns:
        These seeds as one data set, whatever others the directory holds; see
        :func:`bridge_algos.run.store.load_run`.
    """
    if seeds < 1:
        raise InputError(f"seeds is {seeds}, expected at least 1.")
    check_jobs(jobs)
    world = build_world(config)
    build_oracle(config, world)  # a mistake in its options shows before anything is written
    finished = open_run(directory, config)
    if log:
        finished &= {seed for seed in finished if log_path(directory, seed).exists()}
    missing = [seed for seed in range(seeds) if seed not in finished]
    work = [(config, world, seed, directory, log) for seed in missing]
    for_each(_one, work, jobs, config.environment, "seed", seeds - len(missing), progress)
    return load_run(directory, range(seeds))


def _one(config: RunConfig, world: World, seed: int, directory: Path, log: bool) -> None:
    if log:
        dataset, written = logged_seed(config, world, seed)
        save_log(log_path(directory, seed), written)
    else:
        dataset = run_seed(config, world, seed)
    save_seed(directory, dataset)
