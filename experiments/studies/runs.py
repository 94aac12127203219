"""Regret curves of one run over many seeds, beside the published ones where there are any."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import xarray as xr

from bridge_algos.run import plots
from bridge_algos.run.config import RunConfig
from bridge_algos.run.runner import run
from bridge_algos.run.summary import table
from experiments.published import comparison_text, draw_beside, published_curves


def compute(settings: dict[str, Any], directory: Path, jobs: int) -> xr.Dataset:
    """The run of ``settings["configuration"]`` on seeds 0 .. ``settings["seeds"]`` - 1; a seed is the resumable unit.

    Measured times stay in the seeds' files: what is returned depends on the settings alone.
    """
    config = RunConfig.from_json(json.dumps(settings["configuration"]))
    results = run(config, directory, settings["seeds"], jobs)
    various = {"versions": "various; see the files of the seeds"} if "versions" not in results.attrs else {}
    return results.drop_vars("seconds").assign_attrs(various)


def figures(data: xr.Dataset) -> dict[str, Any]:
    """Cumulative regret and policies left, published curves dashed."""
    picture = plots.figure(data)
    curves = published_curves(_environment(data))
    if curves is not None:
        regret, size = picture.axes
        draw_beside(regret, size, curves)
    return {"": picture}


def words(data: xr.Dataset) -> str:
    """The run's table, and the comparison with the published curves."""
    environment = _environment(data)
    text = table(data.assign_attrs(title=environment))
    curves = published_curves(environment)
    return text if curves is None else f"{text}\n\n{comparison_text(data, curves)}"


def _environment(data: xr.Dataset) -> str:
    return RunConfig.from_json(data.attrs["configuration"]).environment
