"""A reproduction that is killed at random moments ends with the very bytes of one that is not."""

from __future__ import annotations

import multiprocessing
import signal
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from experiments.reproduce import configuration, reproduce

KILLS = 10  # of each
SMALL: dict[str, dict[str, Any]] = {
    "fig2-starmdp": {"seeds": 3},  # its parts are the files of a run's seeds
    "ladder-starmdp": {"demonstrations": [1, 2, 5, 10], "datasets": 10, "counted": 2},  # its parts are cells
}
PROCESSES = multiprocessing.get_context("forkserver")  # imports once, so that kills fall into the work
PROCESSES.set_forkserver_preload(
    ["experiments.reproduce", *(f"experiments.studies.{name}" for name in ("runs", "ladder")), "matplotlib.figure"]
)


def work(name: str, directory: Path) -> None:
    described = configuration(name)
    reproduce(name, {**described, "settings": described["settings"] | SMALL[name]}, directory, jobs=1)


def end(process: Any, after: float | None) -> float:
    """Wait for a process, or kill it after some seconds; returns how long it lived."""
    start = time.monotonic()
    process.start()
    process.join(after)
    process.kill()
    process.join()
    return time.monotonic() - start


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


@pytest.mark.parametrize("name", SMALL)
def test_killed_at_random_moments(name: str, tmp_path: Path) -> None:
    whole, again = (PROCESSES.Process(target=work, args=(name, tmp_path / "whole")) for _ in range(2))
    end(whole, None)
    shortest = end(again, None)  # nothing is left to compute, but all is written again
    assert (whole.exitcode, again.exitcode) == (0, 0)
    expected = results(tmp_path / "whole")
    assert {"data.nc", f"{name}.txt", f"{name}.png", f"{name}.pdf"} < set(expected)
    rng = np.random.default_rng(0)
    kills, endings = 0, 0
    while kills < KILLS or not endings:
        process = PROCESSES.Process(target=work, args=(name, tmp_path / f"killed-{endings}"))
        end(process, rng.uniform(0, shortest) if kills < KILLS else None)
        if process.exitcode == -signal.SIGKILL:
            kills += 1
            continue
        assert process.exitcode == 0
        assert results(tmp_path / f"killed-{endings}") == expected
        endings += 1
