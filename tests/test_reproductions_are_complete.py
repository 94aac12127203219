"""Every named figure and table has a study and a seconds-long version, and leaves data, figures and a text behind."""

from __future__ import annotations

import importlib
import json
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridge_algos.netcdf import load_dataset
from bridge_algos.run.summary import Mean, mean_of
from bridge_theory.errors import InputError
from experiments.published import agreeing_rounds, agreement
from experiments.report.interactive import panels
from experiments.reproduce import configuration, main, names, reproduce

SMALL: dict[str, dict[str, Any]] = {
    "fig2-starmdp": {"seeds": 2},
    "fig2-gridworld": {"seeds": 2},
    "ladder-starmdp": {"demonstrations": [2, 10], "datasets": 5, "counted": 1},
    "certified-answers": {"demonstrations": [2], "asking": ["pool"]},
    "certified-regret": {},
}


def inside(changes: dict[str, Any], settings: dict[str, Any]) -> bool:
    return all(
        name in settings and (not isinstance(value, dict) or inside(value, settings[name]))
        for name, value in changes.items()
    )


@pytest.mark.parametrize("name", names())
def test_a_configuration_is_well_formed(name: str) -> None:
    described = json.loads(files("experiments").joinpath(f"configs/{name}.json").read_text())
    assert set(described) - {"alone"} == {"title", "study", "settings", "quick"}
    study = importlib.import_module(f"experiments.studies.{described['study']}")
    assert all(callable(getattr(study, part)) for part in ("compute", "figures", "words"))
    assert described["quick"], "a quick version changes something"
    assert inside(described["quick"], described["settings"]), "a quick version names settings that there are"


@pytest.mark.parametrize("name", SMALL)
def test_data_figures_and_text_are_left_behind(name: str, tmp_path: Path) -> None:
    described = configuration(name, quick=True)
    described["settings"] |= SMALL[name]
    printed = reproduce(name, described, tmp_path, jobs=1)
    data = load_dataset(tmp_path / "data.nc", "")
    assert json.loads(data.attrs["settings"]) == described["settings"]
    assert (data.attrs["title"], data.attrs["study"]) == (described["title"], described["study"])
    assert "numpy" in json.loads(data.attrs["versions"])
    text = (tmp_path / f"{name}.txt").read_text()
    assert text.startswith(described["title"])
    assert text in printed
    assert (tmp_path / f"{name}.png").stat().st_size > 10_000
    assert (tmp_path / f"{name}.pdf").read_bytes().startswith(b"%PDF")
    study = importlib.import_module(f"experiments.studies.{described['study']}")
    assert study.words(data) in text  # from the file alone
    assert all(panels(picture) for picture in study.figures(data).values())


def test_seeds_can_be_chosen_where_there_are_some(tmp_path: Path) -> None:
    assert configuration("fig2-starmdp", seeds=7)["settings"]["seeds"] == 7
    with pytest.raises(InputError, match="--seeds 7 does not apply to 'ladder-starmdp'"):
        main(["fig2-starmdp", "ladder-starmdp", "--seeds", "7", "--out", str(tmp_path)])
    assert list(tmp_path.iterdir()) == []


def test_agreement_is_judged_by_the_interval_of_the_difference() -> None:
    assert "they agree within the intervals, 5.00 ± 5.00 apart" in agreement(Mean(1, 3), Mean(6, 4))
    assert "they do not agree, ours is lower by 5.10 ± 5.00" in agreement(Mean(0.9, 3), Mean(6, 4))
    assert "ours is higher" in agreement(Mean(12, 3), Mean(6, 4))


def test_one_seed_agrees_with_nothing() -> None:
    """Its half-width is infinite, within which everything would lie."""
    assert agreement(mean_of([1.0]), Mean(6, 4)) == (
        "published 6.00 ± 4.00, ours 1.00: one seed has no interval to compare within"
    )
    curve = {"mean": [1.0, 1.0], "ci95_half_width": [0.5, 0.5]}
    assert agreeing_rounds(np.ones((1, 2)), curve) == 0
    assert agreeing_rounds(np.ones((2, 2)), curve) == 2
