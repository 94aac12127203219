"""Results on disk: one netCDF file a seed, written whole or not at all, readable by anything that reads netCDF."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

import xarray as xr

from bridge_algos.files import atomic_path, atomic_write_text
from bridge_algos.run.config import RunConfig
from bridge_theory.errors import InputError

ENGINE: Final = "h5netcdf"


def open_run(directory: Path, config: RunConfig) -> set[int]:
    """Prepare a directory for a configuration and return the seeds that it already holds.

    Raises:
        InputError: when the directory holds a run of another configuration, or a file that cannot be read; nothing is
            deleted or overwritten.
    """
    described = directory / "configuration.json"
    if described.exists() and seed_files(directory) and RunConfig.from_json(_text(described)) != config:
        raise InputError(
            f"{directory} holds a run with another configuration; choose another --out or move the old run away."
        )
    try:
        atomic_write_text(described, config.to_json() + "\n")
    except OSError as error:
        raise InputError(f"{directory} cannot be written to ({_short(error)}); choose another --out.") from None
    for path in seed_files(directory):
        _load(path, config)
    return {_seed_of(path) for path in seed_files(directory)}


def seed_files(directory: Path) -> list[Path]:
    """The result files of a directory, in order of seed."""
    return sorted(directory.glob("seed-*.nc"), key=_seed_of)


def save_seed(directory: Path, dataset: xr.Dataset) -> None:
    """Write the data set of one seed."""
    with atomic_path(directory / f"seed-{int(dataset.seed):05d}.nc") as temporary:
        dataset.to_netcdf(str(temporary), engine=ENGINE)


def load_run(directory: Path) -> xr.Dataset:
    """All seeds of a run as one data set over (seed, algorithm, round), with the run's configuration as attributes.

    Raises:
        InputError: when there is no result, or one cannot be read or belongs to another configuration.
    """
    paths = seed_files(directory)
    if not paths:
        raise InputError(
            f"{directory} holds no results (seed-*.nc); make some with 'bridge-rl run ... --out {directory}'."
        )
    config = RunConfig.from_json(_text(directory / "configuration.json"))
    parts = [_load(path, config) for path in paths]
    combined = xr.concat(parts, dim="seed", combine_attrs="drop_conflicts")
    return combined.assign_attrs(title=f"BRIDGE companion: {config.environment}, {len(parts)} seeds")


def _load(path: Path, config: RunConfig) -> xr.Dataset:
    try:
        with xr.open_dataset(path, engine=ENGINE) as stored:
            dataset = stored.load()
        same = RunConfig.from_json(dataset.attrs["configuration"]) == config
    except (OSError, KeyError, ValueError) as error:
        raise InputError(
            f"{path} is not a readable result file ({_short(error)}); move it away and run again to redo that seed."
        ) from None
    if not same:
        raise InputError(f"{path} belongs to another configuration; move it away and run again.")
    return dataset


def _text(path: Path) -> str:
    try:
        return path.read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read ({_short(error)}); it should hold the run's configuration.") from None


def _seed_of(path: Path) -> int:
    match = re.fullmatch(r"seed-(\d+)\.nc", path.name)
    if match is None:
        raise InputError(f"{path} is not named seed-NUMBER.nc; move it out of the results directory.")
    return int(match[1])


def _short(error: Exception) -> str:
    return str(error).splitlines()[0][:120] if str(error) else type(error).__name__
