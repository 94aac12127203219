"""A reproduction's cells are computed once, found again only for the same settings, and never trusted blindly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from bridge_theory.errors import InputError
from experiments.cells import Cell, run_cells, source_digest

CELLS = [{"seed": seed, "n": n, "rule": rule} for seed in (0, 1) for n, rule in ((10, "zero"), (20.5, None))]


def draw(cell: Cell) -> xr.Dataset:
    rng = np.random.default_rng(cell["seed"])
    values = rng.normal(size=3) * cell["n"]
    return xr.Dataset({"x": ("round", values, {"units": "reward"})}, {"round": [1, 2, 3]}, {"note": "dropped"})


def refuse(cell: Cell) -> xr.Dataset:
    raise AssertionError(f"{cell} was computed again")


refuse.__qualname__ = draw.__qualname__


def test_cells_are_joined_in_order_with_their_entries(tmp_path: Path) -> None:
    joined = run_cells(draw, CELLS, tmp_path, 1, "draw")
    assert dict(joined.sizes) == {"cell": 4, "round": 3}
    assert joined.seed.values.tolist() == [0, 0, 1, 1]
    assert joined.n.values.tolist() == [10, 20.5, 10, 20.5]
    assert joined.rule.values.tolist() == ['"zero"', "null"] * 2
    assert joined.x.attrs == {"units": "reward"}
    assert set(joined.attrs) == {"versions"}
    for i, cell in enumerate(CELLS):
        np.testing.assert_array_equal(joined.x[i], draw(cell).x)


def test_numbers_depend_neither_on_jobs_nor_on_order(tmp_path: Path) -> None:
    one = run_cells(draw, CELLS, tmp_path / "one", 1, "draw")
    two = run_cells(draw, CELLS[::-1], tmp_path / "two", 2, "draw").isel(cell=slice(None, None, -1))
    assert one.identical(two)


def test_finished_cells_are_not_computed_again_and_others_are(tmp_path: Path) -> None:
    first = run_cells(draw, CELLS[:3], tmp_path, 1, "draw")
    assert run_cells(refuse, CELLS[:3], tmp_path, 1, "draw").identical(first)
    for changed in ({**CELLS[0], "n": 11}, {**CELLS[0], "seed": 2}, {**CELLS[0], "extra": 0}):
        with pytest.raises(AssertionError, match="computed again"):
            run_cells(refuse, [changed], tmp_path, 1, "draw")


def test_another_version_of_a_package_is_another_cell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_cells(draw, CELLS[:1], tmp_path, 1, "draw")
    monkeypatch.setattr("experiments.cells.package_versions", lambda: {"numpy": "3.0"})
    with pytest.raises(AssertionError, match="computed again"):
        run_cells(refuse, CELLS[:1], tmp_path, 1, "draw")


def test_other_code_is_another_cell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As after a pull that changes what is computed, where the version of the package stays."""
    run_cells(draw, CELLS[:1], tmp_path, 1, "draw")
    monkeypatch.setattr("experiments.cells.source_digest", lambda house: "other")
    with pytest.raises(AssertionError, match="computed again"):
        run_cells(refuse, CELLS[:1], tmp_path, 1, "draw")


def test_the_digest_of_the_source_sees_code_and_environments(tmp_path: Path) -> None:
    seen = set()
    for number, name in enumerate(("bridge_algos/a.py", "experiments/a.py", "bridge_algos/envs/a.json")):
        for text in ("1", "2"):
            house = tmp_path / f"{number}{text}"
            (house / name).parent.mkdir(parents=True)
            (house / name).write_text(text)
            seen.add(source_digest(house))
    assert len(seen) == 6


def test_damaged_and_foreign_cells_are_named_and_kept(tmp_path: Path) -> None:
    run_cells(draw, CELLS[:2], tmp_path, 1, "draw")
    one, two = sorted((tmp_path / "cells").iterdir())
    whole = one.read_bytes()
    for damaged, message in ((whole[:500], "is not a readable result file"), (two.read_bytes(), "does not hold the")):
        one.write_bytes(damaged)
        with pytest.raises(InputError, match=f"{one.name} {message}.*; move it away and run again"):
            run_cells(draw, CELLS[:2], tmp_path, 1, "draw")
        assert one.read_bytes() == damaged
    one.unlink()
    run_cells(draw, CELLS[:2], tmp_path, 1, "draw")
    assert one.read_bytes() == whole
