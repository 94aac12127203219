"""Labelled arrays on disk: netCDF 4, written whole or not at all, readable by anything that reads netCDF."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import xarray as xr

from bridge_algos.files import atomic_path
from bridge_theory.errors import InputError

ENGINE: Final = "h5netcdf"


def save_dataset(path: Path, dataset: xr.Dataset) -> None:
    """Write a data set to ``path``."""
    with atomic_path(path) as temporary:
        dataset.to_netcdf(str(temporary), engine=ENGINE)


def load_dataset(path: Path, remedy: str) -> xr.Dataset:
    """Read a data set into memory.

    Raises:
        InputError: when the file cannot be read; ``remedy`` tells the user what to do about it.
    """
    try:
        with xr.open_dataset(path, engine=ENGINE) as stored:
            return stored.load()
    except Exception as error:  # damaged bytes make HDF5 and its readers raise nearly everything
        raise InputError(f"{path} is not a readable result file ({short_text(error)}); {remedy}.") from None


def short_text(error: Exception) -> str:
    """The first line of an error's message, for a sentence of ours."""
    return str(error).splitlines()[0][:120] if str(error) else type(error).__name__
