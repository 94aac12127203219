"""What the repository stores of the long continuous runs was made with its configurations, and says what it said."""

import json
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from bridge_algos.netcdf import load_dataset
from experiments.reproduce import configuration

STORED = sorted((Path(__file__).parent.parent / "experiments" / "data").glob("*.nc"))


def test_there_are_results_of_each_kind() -> None:
    varied = {f"ablation-reacher-{name}" for name in ("radius", "demonstrations", "embeddings")}
    assert {path.stem for path in STORED} >= {"fig2-reacher", "fig2-ant-fewer-rollouts", *varied}


@pytest.mark.parametrize("path", STORED, ids=lambda path: path.stem)
def test_stored_results(path: Path) -> None:
    data, described = load_dataset(path, ""), configuration(path.stem)
    settings = json.loads(data.attrs["settings"])
    assert settings["seeds"] == data.sizes["seed"]
    assert settings | {"seeds": 0} == described["settings"] | {"seeds": 0}
    assert data.attrs["title"] == described["title"]
    assert path.stat().st_size < 1_000_000
    study = import_module(f"experiments.studies.{described['study']}")
    assert str(data.sizes["seed"]) in study.words(data)
    if path.stem.startswith("fig2"):
        regret = data.suboptimality.sel(algorithm="bridge")
        seen = data.suboptimality_seen.sel(algorithm="bridge")
        assert float((regret - seen).mean()) > 0, "the rollouts that chose a policy flatter it"
    assert bool(np.isfinite(data.suboptimality.sel(algorithm="bridge")).all())
