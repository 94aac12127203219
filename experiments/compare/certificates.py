"""The certified data-dependent bound of a run: what the independent checker finds in its logs."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import xarray as xr
from joblib import Parallel, delayed
from tqdm import tqdm

from bridge_algos.mdp import FloatArray
from bridge_algos.run.config import RunConfig
from bridge_algos.run.log_file import RunLog, load_log, log_files, log_path
from bridge_theory.errors import InputError
from proofs_checks.verify import Certificate, verify

SOURCES = {"best": "audit R4", "likelihood": "companion G6"}
"""Where the certified bounds that are drawn come from, by their names in a certificate."""

CHECKER = "proofs_checks.verify"


def certificates(
    directory: Path, config: RunConfig, results: xr.Dataset, jobs: int = 1
) -> dict[tuple[str, int], Certificate] | str:
    """What the checker finds in a run's logs, by algorithm and seed; or the reason why it checks none."""
    paths = log_files(directory)
    parallel = Parallel(n_jobs=jobs, return_as="generator", batch_size=1)
    bar = tqdm(total=len(paths), unit="log", desc="verify", disable=not (sys.stderr.isatty() and paths))
    found: dict[tuple[str, int], Certificate] = {}
    with bar:
        try:
            for items in parallel(delayed(verified)(path, config, results) for path in paths):
                found |= {(item.algorithm, item.seed): item for item in items}
                bar.update()
        except InputError as error:
            return str(error)
    return found


def certified(
    found: dict[tuple[str, int], Certificate] | str, algorithm: str, seeds: list[int], bound: str = "best"
) -> tuple[FloatArray, float]:
    """A certified bound, (seeds, T) in units of utility, and its failure probability for one seed.

    Args:
        bound: a name of ``SOURCES``: ``"best"``, the least of the bounds of R4, or ``"likelihood"``.

    Raises:
        InputError: when a seed has no log, its log is not certified, or does not give the bound.
    """
    if isinstance(found, str):
        raise InputError(f"the checker does not take the logs: {found}")
    missing = [seed for seed in seeds if (algorithm, seed) not in found]
    if missing:
        raise InputError(
            f"{len(missing)} of {len(seeds)} seeds have no log; store logs with 'bridge-rl run ... --log'."
        )
    own = [found[algorithm, seed] for seed in seeds]
    refused = next((item for item in own if not item.certified), None)
    if refused is not None:
        raise InputError(f"the log of seed {refused.seed} is not certified: {refused.reasons[0]}")
    values = np.array([item.bounds[bound] for item in own])
    if not np.isfinite(values).all():
        raise InputError(f"the checker certifies no {bound} bound of this run: {'; '.join(own[0].notes)}")
    return values, max(item.failures[bound] for item in own)


def verified(path: Path, config: RunConfig, results: xr.Dataset) -> tuple[Certificate, ...]:
    """What the checker finds in the log of a stored run.

    Args:
        path: of the log, named after its seed.
        config, results: of the run: the log has to be of the same configuration, and of the same rounds wherever the
            results hold its seed.

    Raises:
        InputError: also for the log of another run.
    """
    log = load_log(path)
    if RunConfig.from_json(json.dumps(log.header.get("configuration"))) != config:
        raise InputError(f"{path} is the log of another configuration; move it away.")
    found = verify(log)
    for item in found:
        if path != log_path(path.parent, item.seed):
            raise InputError(f"{path} is the log of seed {item.seed}; give it that seed's name, or remove it.")
        if not _same_rounds(log, item, results):
            raise InputError(f"{path} is not the log of the stored run of seed {item.seed}: its rounds are others.")
    return found


def _same_rounds(log: RunLog, item: Certificate, results: xr.Dataset) -> bool:
    """Whether the results hold the pairs and claims of the log, as far as they hold its seed and algorithm."""
    if item.algorithm not in results.algorithm or item.seed not in results.seed:
        return True
    own = results.sel(algorithm=item.algorithm, seed=item.seed)
    pairs = np.stack([own["first"], own["second"]], axis=-1)
    if not np.array_equal(pairs, log.arrays[f"{item.algorithm}/pairs"]):
        return False
    claims = ("gamma", "log_det", "uncertainty")
    return all(np.allclose(own[name], log.arrays[f"{item.algorithm}/{name}"], rtol=1e-6) for name in claims)
