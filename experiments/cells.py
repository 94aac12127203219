"""Many independent cells of a study, resumable: each is computed once, from its own entries, and kept in its own file.

A cell's file is named by a digest of all that decides its numbers: the function, the cell's entries, our own source and
the versions of the packages. A changed setting or line of code therefore never meets an old result; it makes new files,
and the old ones stay. A file that cannot be read, or that does not say that it is this very cell, is refused by name,
never overwritten.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from threadpoolctl import threadpool_limits

from bridge_algos.netcdf import load_dataset, save_dataset
from bridge_algos.run.parallel import check_jobs, for_each
from bridge_algos.run.versions import package_versions
from bridge_theory.errors import InputError

Cell = dict[str, Any]
_REMEDY = "move it away and run again to redo that cell"
_HOUSE = Path(__file__).parent.parent


def run_cells(
    work: Callable[[Cell], xr.Dataset], cells: Sequence[Cell], directory: Path, jobs: int, label: str
) -> xr.Dataset:
    """Compute ``work(cell)`` for every cell that ``directory / "cells"`` does not hold yet, and join all results.

    Args:
        work: a function at the top level of a module, deterministic in the cell: its settings and its seed are entries
            of the cell. It runs with one thread, possibly in another process.
        cells: JSON values by name, the same names in each cell.
        jobs: processes, -1 for all cores; the numbers do not depend on it.
        label: of the progress bar.

    Returns:
        The results in the order of ``cells``, joined along the dimension ``"cell"``; each entry of the cells is a
        coordinate along it, as JSON text unless its values are all numbers, all texts or all truth values. Their shapes
        and coordinates must agree. The attribute ``versions`` names the packages.

    Raises:
        InputError: when a cell's file cannot be read or holds something else; nothing is overwritten.
    """
    check_jobs(jobs)
    identities = [_identity(work, cell) for cell in cells]
    paths = [directory / "cells" / f"{_digest(identity)}.nc" for identity in identities]
    found = {path: _load(path, identity) for path, identity in zip(paths, identities, strict=True) if path.exists()}
    todo = {
        path: (work, cell, identity, path)
        for path, cell, identity in zip(paths, cells, identities, strict=True)
        if path not in found
    }
    (directory / "cells").mkdir(parents=True, exist_ok=True)  # a place that cannot be written to shows at once
    for_each(_one, list(todo.values()), jobs, label, "cell", len(found))
    found |= {path: _load(path, identity) for _, _, identity, path in todo.values()}
    parts = [found[path].drop_attrs(deep=False) for path in paths]
    joined = xr.concat(parts, dim="cell", data_vars="all", join="exact", combine_attrs="drop_conflicts")
    coordinates = {name: ("cell", _column([cell[name] for cell in cells])) for name in cells[0]}
    return joined.assign_coords(coordinates).assign_attrs(versions=json.dumps(package_versions()))


def _one(work: Callable[[Cell], xr.Dataset], cell: Cell, identity: str, path: Path) -> None:
    with threadpool_limits(1):
        result = work(cell)
    save_dataset(path, result.assign_attrs(identity=identity))


def _identity(work: Callable[[Cell], xr.Dataset], cell: Cell) -> str:
    name = f"{work.__module__}.{work.__qualname__}"
    described = {"work": name, "cell": cell, "source": source_digest(_HOUSE), "versions": package_versions()}
    return json.dumps(described, sort_keys=True, allow_nan=False)


@cache
def source_digest(house: Path) -> str:
    """SHA-256 over the code and the environments' data of the packages in ``house`` that compute cells.

    Between two releases the version of this package says nothing about them.
    """
    total = hashlib.sha256()
    for package in ("bridge_theory", "bridge_algos", "experiments"):
        for path in sorted([*(house / package).rglob("*.py"), *(house / package).rglob("envs/*.json")]):
            total.update(f"{path.relative_to(house)}\n".encode() + path.read_bytes())
    return total.hexdigest()


def _digest(identity: str) -> str:
    return hashlib.sha256(identity.encode()).hexdigest()[:24]


def _load(path: Path, identity: str) -> xr.Dataset:
    dataset = load_dataset(path, _REMEDY)
    if dataset.attrs.get("identity") != identity:
        raise InputError(f"{path} does not hold the cell that it is named after; {_REMEDY}.")
    return dataset


def _column(values: list[Any]) -> np.ndarray:
    kinds = {type(value) for value in values}
    if kinds in ({bool}, {str}) or kinds <= {int, float}:
        return np.array(values)
    return np.array([json.dumps(value, sort_keys=True) for value in values])
