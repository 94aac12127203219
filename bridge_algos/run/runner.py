"""Many seeds at once, resumable: joblib's current backend does the work, each seed is stored as soon as it is done."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path

import xarray as xr

from bridge_algos.continuous.config import ContinuousConfig
from bridge_algos.given import checked
from bridge_algos.run.config import RunConfig
from bridge_algos.run.configuration import Configuration
from bridge_algos.run.log import logged_seed
from bridge_algos.run.log_file import log_path, save_log
from bridge_algos.run.parallel import check_jobs, for_each
from bridge_algos.run.seed import run_seed
from bridge_algos.run.store import load_run, open_run, save_seed
from bridge_algos.run.world import World, build_oracle, build_world, return_oracle, with_digests
from bridge_theory.errors import InputError


@checked
def run(
    config: Configuration,
    directory: Path,
    seeds: int,
    jobs: int = 1,
    progress: bool | None = None,
    log: bool = False,
) -> xr.Dataset:
    """Run seeds 0..seeds-1 of a configuration, skipping those that the directory already holds.

    Args:
        config: tabular, or of continuous control.
        directory: where results go; see :mod:`bridge_algos.run.store`.
        seeds: at least 1.
        jobs, progress: see :func:`bridge_algos.run.parallel.for_each`. The numbers do not depend on them.
        log: keep each seed's log for ``bridge-rl verify`` too; a finished seed without one is run again for it.

    Returns:
        These seeds as one data set, whatever others the directory holds; see
        :func:`bridge_algos.run.store.load_run`.
    """
    check_jobs(jobs)
    if isinstance(config, ContinuousConfig):
        from bridge_algos.continuous.offline import resolved

        config = resolved(config)
    elif isinstance(config, RunConfig):
        config = with_digests(config)
    work = _work(config, directory, log, _threads(seeds, jobs))
    finished = open_run(directory, config)
    if log:
        finished &= {seed for seed in finished if log_path(directory, seed).exists()}
    missing = [seed for seed in range(seeds) if seed not in finished]
    for_each(work, [(seed,) for seed in missing], jobs, config.environment, "seed", seeds - len(missing), progress)
    return load_run(directory, range(seeds))


def _work(config: Configuration, directory: Path, log: bool, threads: int) -> Callable[[int], None]:
    """What computes and stores a seed; a mistake in the configuration shows here, before anything is written."""
    if isinstance(config, RunConfig):
        world = build_world(config)
        build_oracle(config, world)
        return partial(_one, config, world, directory, log)
    if log:
        raise InputError(
            f"logs are there to certify regret, which nothing does for {config.environment}; leave out --log."
        )
    assert isinstance(config, ContinuousConfig)
    return_oracle(config.oracle_options)
    return partial(_one_continuous, config, directory, threads)


def _threads(seeds: int, jobs: int) -> int:
    """Threads for the rollouts of one seed: the cores that processes leave over."""
    cores = os.cpu_count() or 1
    processes = jobs if jobs > 0 else cores
    return max(1, cores // min(processes, seeds))


def _one_continuous(config: ContinuousConfig, directory: Path, threads: int, seed: int) -> None:
    from bridge_algos.continuous.features import cache_directory
    from bridge_algos.continuous.seed import run_seed as run_continuous_seed

    save_seed(directory, run_continuous_seed(config, seed, cache=cache_directory(), threads=threads))


def _one(config: RunConfig, world: World, directory: Path, log: bool, seed: int) -> None:
    if log:
        dataset, written = logged_seed(config, world, seed)
        save_log(log_path(directory, seed), written)
    else:
        dataset = run_seed(config, world, seed)
    save_seed(directory, dataset)
