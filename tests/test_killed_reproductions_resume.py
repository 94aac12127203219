"""A reproduction that is killed at random moments ends with the very bytes of one that is not."""

from __future__ import annotations

import multiprocessing
import signal
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from experiments.reproduce import configuration, reproduce

KILLS = 20
NAME = "fig2-starmdp"
PROCESSES = multiprocessing.get_context("forkserver")  # imports once, so that kills fall into the work
PROCESSES.set_forkserver_preload(["experiments.reproduce", "experiments.studies.runs", "cvxpy", "matplotlib.figure"])


def work(directory: Path) -> None:
    reproduce(NAME, configuration(NAME, quick=True), directory, jobs=1)


def results(directory: Path) -> dict[str, object]:
    """Every file by name: its bytes, or for a seed, which also records times, its other arrays."""
    found: dict[str, object] = {}
    for path in sorted(directory.rglob("*")):
        if path.name.startswith("seed-"):
            with xr.open_dataset(path, engine="h5netcdf") as stored:
                kept = stored.drop_vars("seconds").load()
            found[path.name] = {name: kept[name].values.tobytes() for name in kept.variables}
        elif path.is_file() and not path.name.startswith("."):  # a killed process can leave a hidden, unfinished file
            found[path.name] = path.read_bytes()
    return found


def test_killed_at_twenty_random_moments(tmp_path: Path) -> None:
    start = time.monotonic()
    work(tmp_path / "whole")
    longest = time.monotonic() - start
    expected = results(tmp_path / "whole")
    assert {"data.nc", f"{NAME}.txt", f"{NAME}.png", "seed-00002.nc"} <= set(expected)
    rng = np.random.default_rng(0)
    kills, endings = 0, 0
    while kills < KILLS or not endings:
        directory = tmp_path / f"killed-{endings}"
        process = PROCESSES.Process(target=work, args=(directory,))
        process.start()
        process.join(rng.uniform(0, longest) if kills < KILLS else None)
        process.kill()
        process.join()
        if process.exitcode == -signal.SIGKILL:
            kills += 1
            continue
        assert process.exitcode == 0
        assert results(directory) == expected
        endings += 1
    assert endings >= 1
