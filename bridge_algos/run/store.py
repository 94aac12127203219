"""Results on disk: one netCDF file a seed, written whole or not at all, readable by anything that reads netCDF."""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path

import xarray as xr

from bridge_algos.files import atomic_write_text
from bridge_algos.netcdf import load_dataset, save_dataset, short_text
from bridge_algos.run.configuration import Configuration, read_configuration
from bridge_algos.run.dataset import FORMAT
from bridge_algos.run.log_file import log_files
from bridge_theory.errors import InputError

_REMEDY = "move it away and run again to redo that seed"


def open_run(directory: Path, config: Configuration) -> set[int]:
    """Prepare a directory for a configuration and return the seeds that it already holds.

    Raises:
        InputError: when the directory holds a run of another configuration, or a file that cannot be read; nothing is
            deleted or overwritten.
    """
    described = directory / "configuration.json"
    kept = seed_files(directory) or log_files(directory)  # a log alone would pass for that of the new run
    if described.exists() and kept and read_configuration(_text(described)) != config:
        raise InputError(
            f"{directory} holds a run with another configuration; choose another --out or move the old run away."
        )
    try:
        atomic_write_text(described, config.to_json() + "\n")
    except OSError as error:
        raise InputError(f"{directory} cannot be written to ({short_text(error)}); choose another --out.") from None
    for path in seed_files(directory):
        _load(path, config)
    return {_seed_of(path) for path in seed_files(directory)}


def seed_files(directory: Path) -> list[Path]:
    """The result files of a directory, in order of seed."""
    return sorted(directory.glob("seed-*.nc"), key=_seed_of)


def save_seed(directory: Path, dataset: xr.Dataset) -> None:
    """Write the data set of one seed."""
    save_dataset(directory / _file_name(int(dataset.seed)), dataset)


def load_run(directory: Path, seeds: Collection[int] | None = None) -> xr.Dataset:
    """The seeds of a run as one data set over (seed, algorithm, round), with the run's configuration as attributes.

    Args:
        seeds: which of the stored seeds; all by default.

    Raises:
        InputError: when there is no result, or one cannot be read or belongs to another configuration.
    """
    paths = [path for path in seed_files(directory) if seeds is None or _seed_of(path) in seeds]
    if not paths:
        raise InputError(
            f"{directory} holds no results (seed-*.nc); make some with 'bridge-rl run ... --out {directory}'."
        )
    config = read_configuration(_text(directory / "configuration.json"))
    parts = [_load(path, config) for path in paths]
    combined = xr.concat(parts, dim="seed", combine_attrs="drop_conflicts")
    return combined.assign_attrs(title=f"BRIDGE companion: {config.environment}, {len(parts)} seeds")


def _load(path: Path, config: Configuration) -> xr.Dataset:
    dataset = load_dataset(path, _REMEDY)
    try:
        same = read_configuration(dataset.attrs["configuration"]) == config
        seed = int(dataset["seed"])
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path} is not a readable result file ({short_text(error)}); {_REMEDY}.") from None
    if dataset.attrs.get("format") != FORMAT:
        raise InputError(f"{path} was written by a version of this package that defines numbers otherwise; {_REMEDY}.")
    if not same:
        raise InputError(f"{path} belongs to another configuration; move it away and run again.")
    if path.name != _file_name(seed):  # else a copy would count as another seed
        raise InputError(f"{path} holds seed {seed}; give it the name {_file_name(seed)}, or remove it.")
    return dataset


def _file_name(seed: int) -> str:
    return f"seed-{seed:05d}.nc"


def _text(path: Path) -> str:
    try:
        return path.read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"{path} cannot be read ({short_text(error)}); it should hold the run's configuration."
        ) from None


def _seed_of(path: Path) -> int:
    match = re.fullmatch(r"seed-(\d+)\.nc", path.name)
    if match is None:
        raise InputError(f"{path} is not named seed-NUMBER.nc; move it out of the results directory.")
    return int(match[1])
