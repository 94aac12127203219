"""Every bound carries its own failure probability; from 1 on nothing that is printed calls its value certified."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from points import ANSWERS

from bridge_theory import Setting, regret_known_apriori, regret_trivial, regret_unknown_covered, solve_for
from bridge_theory.bound import Bound
from bridge_theory.catalog import FORMULAS, all_bounds
from bridge_theory.cli import bounds, plan
from bridge_theory.errors import InputError

_SIZES: dict[str, Any] = {"S": 4, "A": 3, "H": 3, "n": 10, "T": 10**6, "d": 2, "B": 1, "W": 1, "lam": 1}
_GIVEN: dict[str, Any] = {
    "gamma_min": "0.25", "epsilon": "0.1", "eta": 1, "R1": "0.1", "R2": "0.1", "log_covering": 3, "norm_sum": 1,
    "bonus_sum": 1, "bonus_square_sum": 1, "potential": 1, "true_bonus": 1, "occupancy": [1, 1], "counts": [40, 40],
    "visits": [3, 4], "ratio": "0.1", "singletons": 1, "unvisited": 1, "class_size": 9, "chi2": 0, "N": 40,
    "residual": 0, "log_det_ratio": 1, **ANSWERS,
}  # fmt: skip
_SPENDING = [bound for bound in all_bounds() if bound.spends]


def _value_at(bound: Bound, chance: str) -> Any:
    chances = dict.fromkeys((*bound.spends, "delta"), chance)
    return bound.value(Setting(**{**_SIZES, **_GIVEN, **chances}))


@pytest.mark.parametrize("bound", _SPENDING, ids=lambda bound: bound.name)
def test_a_bound_carries_the_union_of_its_own_events(bound: Bound) -> None:
    value = _value_at(bound, "1/1000")
    own = Fraction(len(bound.spends), 1000)
    assert Fraction(value.failure.upper) >= own
    if bound.failure is None:
        assert value.failure.exact == own
    shared = bound.value(Setting(**{**_SIZES, **_GIVEN, "delta": "1/1000"}))
    half = bound.spends in (("delta1",), ("delta2",))
    assert bound.failure is not None or shared.failure.exact == Fraction(1, 2000 if half else 1000)


def test_what_cannot_fail_has_failure_probability_zero() -> None:
    assert regret_trivial.value(**_SIZES).failure.exact == 0
    for bound in all_bounds():
        if not bound.spends and bound.failure is None:
            assert "With probability at least" not in bound.words


def _at_large_chances(bound: Bound) -> Any:
    try:
        return _value_at(bound, "0.9")
    except InputError:  # some are only stated for delta <= 1/e
        return _value_at(bound, "0.36")


_FAILING = [bound for bound in _SPENDING if _at_large_chances(bound).failure.lower >= 1]


def test_some_bounds_can_fail_surely() -> None:
    assert len(_FAILING) > 15
    assert {"regret_known_apriori", "gamma_known", "radius_sum_covered"} <= {bound.name for bound in _FAILING}


@pytest.mark.parametrize("bound", _FAILING, ids=lambda bound: bound.name)
def test_words_and_tables_of_a_value_say_that_nothing_is_certified(bound: Bound) -> None:
    value = _at_large_chances(bound)
    assert not value.certified
    assert "othing is certified, for its events may fail with a total probability of " in value.words
    assert "ith probability at least" not in value.words
    assert "nothing is certified" in value._repr_html_()
    uncovered = "n" in bound.parameters and "S_reach" in bound.parameters  # too few demonstrations to cover the expert
    assert uncovered or _value_at(bound, "1e-9").certified


def _flags(**given: Any) -> list[str]:
    values = {**_SIZES, "gamma_min": "0.25", **given}
    return [part for key, value in values.items() for part in (f"--{key.replace('_', '-')}", str(value))]


_SURE = {"delta_w": "0.6", "delta_F": "0.6"}


def test_the_command_line_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    only = ["--only", "regret_known_apriori", "--only", "regret_trivial"]
    bounds.main([*_flags(**_SURE), *only])
    failing, sure = (line.split() for line in capsys.readouterr().out.splitlines() if line.startswith("  regret_"))
    assert "1.2: not certified" in " ".join(failing)
    assert " 0 " in " ".join(sure)
    bounds.main([*_flags(**_SURE), *only, "--json"])
    record, trivial = json.loads(capsys.readouterr().out)
    assert (record["certified"], record["failure"][0] >= 1) == (False, True)
    assert (trivial["certified"], trivial["failure"]) == (True, [0.0, 0.0])
    bounds.main([*_flags(**_SURE), *only, "--latex"])
    assert r"\text{repaired, not certified}" in capsys.readouterr().out
    bounds.main([*_flags(**_SURE), "--explain", "regret_known_apriori"])
    out = capsys.readouterr().out
    assert "May fail with probability: 1.2: not certified" in out
    assert "Nothing is certified" in out


def test_plans_and_sweeps_say_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    figure = ["--figure", str(tmp_path / "a.png")]
    plan.main(["--target-regret", "100", *_flags(T=1000, delta_off="0.1", **_SURE), *figure])
    out = capsys.readouterr().out
    line = next(line for line in out.splitlines() if line.strip().startswith("regret_known_version_space"))
    assert "nothing is certified: its events may fail with a total probability of 1.3" in line
    bounds.main([*_flags(delta="0.05"), "--sweep", "T=10:1e7:log", "--only", "gamma_known", *figure])
    assert "gamma_known certifies nothing at T = " in capsys.readouterr().out
    solution = solve_for("T", regret_known_apriori, 10**9, setting=Setting(**{**_SIZES, **_SURE}))
    assert "Nothing is certified there: the bound's events may fail with a total probability of 1.2." in solution.words


def test_a_bound_on_coverage_counts_the_uncovered() -> None:
    """Ten demonstrations do not cover the expert's pairs; delta = .05 alone is not what that bound may fail with."""
    value = regret_unknown_covered.value(Setting(**{**_SIZES, "gamma_min": "0.25", "delta": "0.05"}))
    assert value.failure.lower > 1
    assert FORMULAS["regret_unknown_repaired"].value(Setting(**{**_SIZES, "delta": "0.05"})).certified  # type: ignore[attr-defined]
