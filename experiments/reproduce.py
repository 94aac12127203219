"""``bridge-rl reproduce``: a named figure of the paper from its configuration file, beside the published figures."""

from __future__ import annotations

import argparse
import json
from importlib.resources import files
from pathlib import Path
from typing import Any

import xarray as xr

from bridge_algos.files import atomic_write_text
from bridge_algos.run import plots
from bridge_algos.run.config import RunConfig
from bridge_algos.run.runner import run
from bridge_algos.run.summary import table
from bridge_theory.cli.options import Parser
from bridge_theory.errors import InputError
from experiments.published import comparison_text, draw_beside, published_curves


def names() -> list[str]:
    """What can be reproduced: the names of the configuration files."""
    return sorted(path.name.removesuffix(".json") for path in files("experiments").joinpath("configs").iterdir())


def main(argv: list[str]) -> int:
    """Reproduce figures; finished seeds are kept, so that a killed run continues."""
    p = Parser(prog="bridge-rl reproduce", description="Reproduce the paper's figures, beside the published ones.")
    p.add_argument("names", nargs="+", metavar="NAME", help=f"all, or some of {', '.join(names())}")
    p.add_argument("--out", type=Path, default=Path("out"), help="directory for results and figures (default out)")
    p.add_argument("--seeds", type=int, help="number of seeds (default: the configuration's)")
    p.add_argument("--jobs", type=int, default=-1, help="processes (default: all cores); does not change the numbers")
    p.add_argument("--quick", action="store_true", help="three seeds, in its own directory: to see that it works")
    options = p.parse_args(argv)
    for name in names() if options.names == ["all"] else options.names:
        reproduce(name, options)
    return 0


def reproduce(name: str, options: argparse.Namespace) -> None:
    """Run one configuration; write its results, figure and text, and print the text."""
    if name not in names():
        raise InputError(f"there is nothing to reproduce named {name!r}; expected all or some of {', '.join(names())}.")
    described = json.loads(files("experiments").joinpath(f"configs/{name}.json").read_text())
    config = RunConfig.from_json(json.dumps(described["configuration"]))
    seeds = 3 if options.quick else options.seeds if options.seeds is not None else described["seeds"]
    directory = options.out / (f"{name}-quick" if options.quick else name)
    results = run(config, directory, seeds, options.jobs)
    curves = published_curves(config.environment)
    text = f"{described['title']}\n\n{table(results)}\n"
    if curves is not None:
        text += f"\n{comparison_text(results, curves)}\n"
    atomic_write_text(directory / f"{name}.txt", text)
    print(text)
    paths = plots.save(_figure(results, curves), directory / name)
    print("figures: " + ", ".join(str(path) for path in paths) + "\n")


def _figure(results: xr.Dataset, curves: dict[str, Any] | None) -> Any:
    picture = plots.figure(results)
    if curves is not None:
        regret, size = picture.axes
        draw_beside(regret, size, curves)
    return picture
