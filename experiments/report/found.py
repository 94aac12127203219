"""What a directory holds that can be reported: runs and reproductions, itself or up to two levels below."""

from __future__ import annotations

import importlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import xarray as xr

from bridge_algos.netcdf import load_dataset, short_text
from bridge_algos.run import plots
from bridge_algos.run.config import RunConfig
from bridge_algos.run.configuration import read_configuration
from bridge_algos.run.store import load_run, seed_files
from bridge_algos.run.summary import table
from bridge_theory.errors import InputError

DATA = "data.nc"
_DEPTH = 2


@dataclass(frozen=True, eq=False)
class Item:
    """One run or reproduction.

    Args:
        name: its path below the reported directory.
        directory: where it lies.
        data: the results.
        title: of the figure or run.
        settings: what was asked for, JSON values by name.
        versions: of the packages that made it, as JSON text.
        configuration: of the tabular run behind it, where there is one.
        words: what was found.
        figures: matplotlib figures by suffix.
    """

    name: str
    directory: Path
    data: xr.Dataset
    title: str
    settings: dict[str, Any]
    versions: str
    configuration: RunConfig | None
    words: str
    figures: dict[str, Any]


def find_items(directory: Path) -> list[Item]:
    """Everything in a directory that can be reported, in the order of the paths.

    Raises:
        InputError: when there is nothing, or something that cannot be read or drawn.
    """
    if not directory.is_dir():
        raise InputError(f"{directory} is not a directory; give the --out of a 'bridge-rl run' or 'reproduce'.")
    found = [_item(place, directory) for place in sorted(_places(directory, _DEPTH))]
    if not found:
        raise InputError(
            f"{directory} holds neither a run (seed-*.nc) nor a reproduction ({DATA}); make one with 'bridge-rl run' "
            "or 'bridge-rl reproduce'."
        )
    return found


def _places(directory: Path, depth: int) -> Iterator[Path]:
    if (directory / DATA).is_file() or seed_files(directory):
        yield directory
    elif depth:
        for child in directory.iterdir():
            if child.is_dir() and not child.is_symlink() and not child.name.startswith("."):
                yield from _places(child, depth - 1)


def _item(place: Path, root: Path) -> Item:
    name = place.resolve().name if place == root else str(place.relative_to(root))  # "." has no name
    path = place / DATA
    if not path.is_file():
        return _run(name, place)
    data = load_dataset(path, "reproduce it again")
    study = _study(path, str(data.attrs.get("study")))
    settings = _json(path, data, "settings")
    try:
        described = settings.get("configuration")
        return Item(
            name,
            place,
            data,
            str(data.attrs["title"]),
            settings,
            str(data.attrs["versions"]),
            None if described is None else _tabular(json.dumps(described)),
            study.words(data),
            study.figures(data),
        )
    except (LookupError, ValueError, TypeError, AttributeError) as error:
        raise InputError(f"{path} cannot be drawn ({short_text(error)}); reproduce it again.") from None


def _run(name: str, place: Path) -> Item:
    data = load_run(place)
    configuration = read_configuration(data.attrs["configuration"])
    settings = {"seeds": data.sizes["seed"], "configuration": json.loads(data.attrs["configuration"])}
    versions = str(data.attrs.get("versions", "various versions"))
    title = f"Run on {configuration.environment}"
    pictures = {"": plots.figure(data)}
    tabular = _tabular(data.attrs["configuration"])
    return Item(name, place, data, title, settings, versions, tabular, table(data), pictures)


def _tabular(text: str) -> RunConfig | None:
    """The configuration of a tabular run; the theory here is about no other."""
    configuration = read_configuration(text)
    return configuration if isinstance(configuration, RunConfig) else None


def _study(path: Path, name: str) -> Any:
    known = {file.name.removesuffix(".py") for file in files("experiments").joinpath("studies").iterdir()}
    if name not in known or name.startswith("_"):
        raise InputError(f"{path} belongs to a study {name!r} that is not known here; reproduce it again.")
    return importlib.import_module(f"experiments.studies.{name}")


def _json(path: Path, data: xr.Dataset, name: str) -> dict[str, Any]:
    try:
        value = json.loads(data.attrs[name])
    except (KeyError, ValueError, TypeError):
        value = None
    if not isinstance(value, dict):
        raise InputError(f"{path} does not say its {name}; reproduce it again.")
    return value
