"""What is filled in for a user is in one table, is legitimate for the bound, and stands in all that is printed."""

from __future__ import annotations

import inspect
import json
import math
from pathlib import Path
from typing import Any

import pytest
from points import ANSWERS

from bridge_theory import Setting, elliptical_floor, regret_known_version_space, solve_for
from bridge_theory.bound import Bound, Rate
from bridge_theory.catalog import FORMULAS, all_bounds, all_rates
from bridge_theory.cli import bounds, plan
from bridge_theory.defaults import completed, default_of, missing
from bridge_theory.errors import InputError
from bridge_theory.offline.assumptions import DETERMINISTIC

POINT: dict[str, Any] = {
    "S": 4, "A": 3, "H": 3, "n": 500, "T": 20, "d": 2, "B": 1, "W": 1, "lam": 1, "delta": "0.06", "N": 40,
    "gamma_min": "0.25", "epsilon": "0.1", "eta": 1, "R": "0.1", "R1": "0.1", "R2": "0.1", "C": 2, "chi2": 0,
    "class_size": 9, "log_covering": 3, "norm_sum": 1, "bonus_sum": 1, "bonus_square_sum": 1, "potential": 1,
    "true_bonus": 1, "occupancy": [1, 1], "occupancy_hat": [1, 1], "row_errors": [0, 1], "counts": [40, 40],
    "visits": [3, 4], "ratio": "0.1", "kl": 1, "exit_mass": "0.1", "mass": "0.1", "radius": "0.1", "singletons": 1,
    "unvisited": 1, "gamma": 9, "L": 1, "v": 1, "square_sum": 1, "width_sum": 1, "optimism": 1, "norm": 1,
    "residual": 0, "log_det_ratio": 1, "uncovered": 1,
}  # fmt: skip
"""Everything that a user can be expected to give; what is filled in is left out."""

PAIRS = [bound for bound in all_bounds() if {"rows", "S_reach"} & set(bound.parameters)]


_OWN_POINT: dict[str, dict[str, Any]] = {
    "transition_log_covering_two_states": {"S": 2},
    "elliptical_floor": {"diameter": 1},
    "look_delta": {"delta_phi": "0.06"},
    "containment_failure_known": {"delta_off": "0.1", "delta_w": "0.1"},
    "containment_failure_unknown": {"delta_off": "0.1", "delta_w": "0.1", "delta_P": "0.1"},
}


def _point(bound: Bound) -> dict[str, Any]:
    return POINT | ANSWERS | _OWN_POINT.get(bound.name, {})


def test_no_formula_has_a_default_of_its_own() -> None:
    for formula in FORMULAS.values():
        taken = list(inspect.signature(formula.function).parameters.values())[1:]
        assert all(p.default is p.empty and p.kind is p.KEYWORD_ONLY for p in taken), formula.name


@pytest.mark.parametrize("bound", all_bounds(), ids=lambda bound: bound.name)
def test_words_name_every_value_that_was_filled_in(bound: Bound) -> None:
    point = _point(bound)
    value = bound.value(**point)
    assert set(value.parameters) == set(bound.parameters)
    assert {item.name for item in value.filled} == set(bound.parameters) - set(point)
    for item in value.filled:
        assert item.value == value.parameters[item.name]
        assert f"{item.name} = " in value.words
        assert item.assumes in value.words
        assert str(item) in value.words
    assert ("Filled in" in value.words) == bool(value.filled)
    given = bound.value(**{name: value.parameters[name] for name in bound.parameters})
    assert (given.filled, given.enclosure.upper) == ((), value.enclosure.upper)
    assert "Filled in" not in given.words


@pytest.mark.parametrize("bound", PAIRS, ids=lambda bound: bound.name)
def test_pairs_are_those_of_a_deterministic_expert_only_where_the_bound_assumes_one(bound: Bound) -> None:
    point = _point(bound)
    about_one = any("deterministic" in text for text in bound.assumptions)
    assert (DETERMINISTIC in bound.assumptions) == about_one
    known, filled = completed(bound, Setting(**point))
    name = "rows" if "rows" in bound.parameters else "S_reach"
    assert known[name] == (point["S"] if about_one else point["S"] * point["A"])
    (words,) = [str(item) for item in filled if item.name == name]
    assert ("a deterministic stationary expert" in words) == about_one
    assert ("A" in missing(bound, {})) == (not about_one or "A" in bound.parameters)


@pytest.mark.parametrize("bound", all_bounds(), ids=lambda bound: bound.name)
def test_what_is_filled_in_from_above_never_strengthens_a_bound(bound: Bound) -> None:
    """A value that may be larger than the true one is only taken where a larger one weakens the statement."""
    from_above = [name for name in bound.parameters if (d := default_of(name, bound)) is not None and d.upper]
    assert not (from_above and "{at_least}" in bound.words)
    for name in from_above:
        filled = bound.value(**_point(bound))
        assert name in filled.parameters
        for share in (1, 2, 4):
            largest = filled.parameters[name]
            less = largest // 4 * share if name in ("rows", "S_reach") else largest / (4 / share)  # type: ignore[operator]
            truth = bound.value(**{**_point(bound), name: max(less, 1 if name in ("rows", "S_reach") else 0)})
            assert truth.enclosure.lower <= filled.enclosure.upper
            assert truth.failure.lower <= filled.failure.upper


def test_a_bound_from_below_has_nothing_filled_in_from_above() -> None:
    point = {name: POINT[name] for name in ("W", "d", "T", "gamma", "B")}
    with pytest.raises(InputError, match="elliptical_floor needs diameter"):
        elliptical_floor.value(**point)


@pytest.mark.parametrize(("S", "A"), [(2, 1000), (3, 4), (6, 3)])
@pytest.mark.parametrize("epsilon", ["0.1", "0.001"])
def test_covering_numbers_are_those_of_the_whole_kernel(S: int, A: int, epsilon: str) -> None:
    """No cover has fewer elements than the volume of its pieces allows; with S rows filled in, the printed ones had."""
    least = S * A * (S - 1) * -math.log(math.expm1(float(epsilon)))
    for kind in ("repaired", "closed_form", *(["two_states"] if S == 2 else [])):
        value = FORMULAS[f"transition_log_covering_{kind}"].value(S=S, A=A, epsilon=epsilon)  # type: ignore[attr-defined]
        assert value.enclosure.upper >= least
        few = FORMULAS[f"transition_log_covering_{kind}"].value(S=S, A=A, epsilon=epsilon, rows=S)  # type: ignore[attr-defined]
        assert few.enclosure.upper < least


_FLAGS = ["--S", "4", "--A", "3", "--H", "3", "--n", "500", "--delta", "0.06", "--gamma-min", "0.25"]
_ONLINE = ["--d", "2", "--B", "1", "--W", "1", "--lam", "1", "--T", "20"]
_ROWS = "rows = 12 (S A: every state-action pair)"
_OWN = "rows = 4 (S: a deterministic stationary expert uses one action in each state)"


def test_the_table_lists_what_was_filled_in_and_for_which_bounds(capsys: pytest.CaptureFixture[str]) -> None:
    bounds.main([*_FLAGS, *_ONLINE])
    out = capsys.readouterr().out
    assert f"{_ROWS} in transition_error_closed_form, transition_error_repaired" in out
    assert f"{_OWN} in offline_radius_repaired, offline_radius_repaired_angle" in out
    for line in (
        "K = 1 (one comparison is made in each round)",
        "t = 20 (the last round)",
        "Delta_n = 1 (always true)",
        "diameter = 2 (2 B: no two policies are farther apart)",
        "equal parts of delta in each bound",
    ):
        assert line in out


@pytest.mark.parametrize("rate", all_rates(), ids=lambda rate: rate.name)
def test_rates_say_what_was_filled_in_too(rate: Rate, capsys: pytest.CaptureFixture[str]) -> None:
    flags = [*_FLAGS, *_ONLINE, "--eta", "1", "--epsilon", "0.1", "--C", "2", "--only", rate.name]
    bounds.main([*flags, "--json"])
    (record,) = json.loads(capsys.readouterr().out)
    assert set(record["filled_in"]) == {name for name in rate.parameters if default_of(name, rate)}
    bounds.main(flags)
    out = capsys.readouterr().out
    assert all(f"{name} = " in out for name in record["filled_in"])


def test_one_rate_does_have_something_filled_in() -> None:
    assert [rate.name for rate in all_rates() if completed(rate, Setting(**POINT))[1]] == ["feature_drift_rate"]


def test_json_explanations_plans_and_sweeps_say_what_was_filled_in(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bounds.main([*_FLAGS, "--only", "transition_error_repaired", "--json"])
    (record,) = json.loads(capsys.readouterr().out)
    assert record["filled_in"] == {"rows": "S A: every state-action pair"}
    assert _ROWS in record["words"]
    bounds.main([*_FLAGS, "--only", "transition_error_repaired", "--latex"])
    assert f"% transition_error_repaired Filled in, as it was not given: {_ROWS}." in capsys.readouterr().out
    bounds.main([*_FLAGS, "--explain", "transition_error_repaired"])
    assert _ROWS in " ".join(capsys.readouterr().out.split())
    plan.main(["--target-radius", "0.9", *_FLAGS])
    assert f"filled in: {_OWN}" in capsys.readouterr().out
    plan.main(["--target-radius", "0.9", *_FLAGS, "--json"])
    records = {item["bound"]: item for item in json.loads(capsys.readouterr().out)}
    assert list(records["offline_radius_repaired"]["filled_in"]) == ["rows"]
    figure = ["--figure", str(tmp_path / "a.png")]
    bounds.main([*_FLAGS, "--sweep", "n=10:1000:log", "--only", "transition_error_repaired", *figure])
    assert f"filled in: {_ROWS}" in capsys.readouterr().out
    bounds.main([*_FLAGS[2:], "--sweep", "S=2:9", "--only", "transition_error_repaired", *figure])
    assert "filled in: rows = 6 (at S = 2; S A: every state-action pair)" in capsys.readouterr().out


def test_solutions_fill_in_nothing_from_what_they_solve_for() -> None:
    known = {"A": 4, "H": 3, "n": 10**6, "delta": "0.05"}
    with pytest.raises(InputError, match="solving transition_error_repaired for S needs rows"):
        solve_for("S", FORMULAS["transition_error_repaired"], 1, setting=Setting(S=3, **known))  # type: ignore[arg-type]
    solution = solve_for("n", regret_known_version_space, 5, setting=Setting(**POINT))
    assert {item.name for item in solution.filled} == {"K", "delta_off", "delta_w", "delta_F"}
    assert all(str(item) in solution.words for item in solution.filled)
