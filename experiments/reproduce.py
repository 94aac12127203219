"""``bridge-rl reproduce``: a named figure or table from its configuration file, beside the published figures.

A configuration, ``experiments/configs/NAME.json``, has a ``title``, a ``study``, its ``settings``, and in ``quick`` the
settings that a seconds-long version changes. The study is a module of :mod:`experiments.studies` with three functions:

    compute(settings, directory, jobs) -> Dataset    resumable; a function of the settings alone
    figures(data) -> {suffix: Figure}                ``""`` is the suffix of an only figure
    words(data) -> str                               what was found: published figures, ours, and whether they agree
"""

from __future__ import annotations

import importlib
import json
from importlib.resources import files
from pathlib import Path
from typing import Any

import xarray as xr

from bridge_algos.files import atomic_write_text
from bridge_algos.netcdf import save_dataset
from bridge_algos.run import plots
from bridge_algos.run.parallel import check_jobs
from bridge_algos.run.versions import package_versions
from bridge_theory.cli.options import Parser
from bridge_theory.errors import InputError

DATA = "data.nc"


def names() -> list[str]:
    """What can be reproduced: the names of the configuration files."""
    return sorted(path.name.removesuffix(".json") for path in files("experiments").joinpath("configs").iterdir())


def in_all() -> list[str]:
    """What ``all`` stands for: everything but the configurations with ``"alone": true``, which take hours or MuJoCo."""
    return [name for name in names() if not _described(name).get("alone", False)]


def main(argv: list[str]) -> int:
    """Reproduce figures and tables; finished parts are kept, so that a killed reproduction continues."""
    p = Parser(prog="bridge-rl reproduce", description="Reproduce figures and tables, beside the published ones.")
    p.add_argument("names", nargs="+", metavar="NAME", help=f"some of {', '.join(names())}, or all that take minutes")
    p.add_argument("--out", type=Path, default=Path("out"), help="directory for results and figures (default out)")
    p.add_argument("--seeds", type=int, help="number of seeds (default: the configuration's)")
    p.add_argument("--jobs", type=int, default=-1, help="processes (default: all cores); does not change the numbers")
    p.add_argument("--quick", action="store_true", help="a small version, in its own directory: to see that it works")
    options = p.parse_args(argv)
    check_jobs(options.jobs)
    chosen = [name for given in options.names for name in (in_all() if given == "all" else [given])]
    configurations = {name: configuration(name, options.quick, options.seeds) for name in chosen}
    for name, described in configurations.items():
        directory = options.out / (f"{name}-quick" if options.quick else name)
        print(reproduce(name, described, directory, options.jobs) + "\n")
    return 0


def configuration(name: str, quick: bool = False, seeds: int | None = None) -> dict[str, Any]:
    """A configuration with its final settings.

    Raises:
        InputError: for an unknown name, or where ``seeds`` is given and is below 1, or the study has no seeds.
    """
    if name not in names():
        raise InputError(f"there is nothing to reproduce named {name!r}; expected all or some of {', '.join(names())}.")
    described = _described(name)
    settings = _merged(described["settings"], described["quick"] if quick else {})
    if seeds is not None:
        if seeds < 1:
            raise InputError(f"seeds is {seeds}, expected at least 1.")
        if "seeds" not in settings:
            raise InputError(f"--seeds {seeds} does not apply to {name!r}, which has no seeds; leave it out there.")
        settings["seeds"] = seeds
    return {**described, "settings": settings}


def reproduce(name: str, described: dict[str, Any], directory: Path, jobs: int) -> str:
    """Compute, then write ``data.nc``, the figures and ``NAME.txt`` into ``directory``; returns the text."""
    study = importlib.import_module(f"experiments.studies.{described['study']}")
    settings, title = described["settings"], described["title"]
    data = study.compute(settings, directory, jobs)
    data.attrs = {
        "versions": json.dumps(package_versions()),
        **data.attrs,
        "title": title,
        "study": described["study"],
        "settings": json.dumps(settings, sort_keys=True),
    }
    save_dataset(directory / DATA, data)
    text = told(data)
    atomic_write_text(directory / f"{name}.txt", text)
    paths = []
    for suffix, picture in study.figures(data).items():
        paths += plots.save(picture, directory / (f"{name}-{suffix}" if suffix else name))
    return f"{text}\nfigures: {', '.join(str(path) for path in paths)}"


def told(data: xr.Dataset) -> str:
    """The text of a result, with its title."""
    study = importlib.import_module(f"experiments.studies.{data.attrs['study']}")
    return f"{data.attrs['title']}\n\n{study.words(data)}\n"


def _described(name: str) -> dict[str, Any]:
    return dict(json.loads(files("experiments").joinpath(f"configs/{name}.json").read_text()))


def _merged(settings: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    """``settings`` with ``changes``, which may reach into nested entries."""
    return settings | {
        key: _merged(settings[key], value) if isinstance(value, dict) else value for key, value in changes.items()
    }
