"""Where the online part of the paper has no value, the error says so and names a formula that has one there."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bridge_theory.catalog import FORMULAS
from bridge_theory.errors import InputError, UndefinedInPaperError

_XI = {"S": 5, "A": 4, "H": 8, "eta": 1, "delta": "0.05"}
_SUMS = {"S": 5, "A": 4, "H": 1, "T": 1, "n": 10, "gamma_min": "0.1", "S_reach": 5, "epsilon": "0.1"}

UNDEFINED: list[tuple[str, dict[str, Any], str]] = [
    ("xi", {**_XI, "N": 0}, "bonus_radius"),
    ("xi", {**_XI, "N": 1}, "bonus_radius"),
    ("xi_bar", {**_XI, "epsilon": "0.1", "N": 0}, "bonus_radius"),
    ("xi_bar", {**_XI, "epsilon": "0.1", "N": 1}, "bonus_radius"),
    ("empirical_bonus", {**_XI, "occupancy": [1, 2], "counts": [5, 0]}, "transition_bonus"),
    ("expected_bonus", {**_XI, "epsilon": "0.1", "occupancy": [1, 2], "counts": [1, 9]}, "transition_bonus"),
    ("offline_bonus_log_term", {**_XI, "epsilon": "0.1", "t": 1}, "bonus_radius"),
    ("squared_bonus_sum_stated", {**_SUMS, "eta": 1, "delta_martingale": "0.05"}, "squared_bonus_sum_repaired"),
    (
        "squared_true_bonus_sum_stated",
        {**_SUMS, "eta": 1, "t": 1, "delta": "0.05", "delta_martingale": "0.05"},
        "squared_true_bonus_sum_repaired",
    ),
    ("bonus_sum_stated", {**_SUMS, "B": 1, "W": 1, "delta": "0.05"}, "bonus_sum_repaired"),
    ("played_bonus_sum_stated", {**_SUMS, "B": 1, "W": 1, "delta": "0.05"}, "bonus_sum_repaired"),
]

REPAIRED_THERE: dict[str, dict[str, Any]] = {
    "bonus_radius": {"S": 5, "A": 4, "delta_P": "0.05", "N": 0},
    "transition_bonus": {"S": 5, "A": 4, "eta": 1, "delta_P": "0.05", "occupancy": [1, 2], "counts": [1, 0]},
    "squared_bonus_sum_repaired": {
        "H": 1, "T": 1, "n": 10, "eta": 1, "gamma_min": "0.1", "S_reach": 5, "log_covering": 9, "uncovered": 0,
    },
    "squared_true_bonus_sum_repaired": {
        "H": 1, "T": 1, "n": 10, "eta": 1, "gamma_min": "0.1", "log_covering": 9, "Delta_n": 0,
    },
    "bonus_sum_repaired": {
        "H": 1, "T": 1, "n": 10, "eta": 1, "gamma_min": "0.1", "S_reach": 5, "log_covering": 9, "uncovered": 0,
    },
}  # fmt: skip


@pytest.mark.parametrize(("name", "point", "repaired"), UNDEFINED)
def test_the_stated_formula_refuses_and_names_the_repair(name: str, point: dict[str, Any], repaired: str) -> None:
    for evaluate in (FORMULAS[name].estimate, FORMULAS[name].expression, FORMULAS[name].enclosure):
        with pytest.raises(UndefinedInPaperError, match=rf"{name} at .*no value there.*; use {repaired} instead"):
            evaluate(**point)


def test_one_undefined_entry_of_an_array_is_enough() -> None:
    with pytest.raises(UndefinedInPaperError, match="use bonus_radius instead"):
        FORMULAS["xi"].estimate(**{**_XI, "N": np.array([100, 1])})


def test_every_named_repair_has_a_value_at_such_points() -> None:
    assert {repaired for _, _, repaired in UNDEFINED} == set(REPAIRED_THERE)
    for name, point in REPAIRED_THERE.items():
        assert FORMULAS[name].status in ("repaired", "sharp")
        assert math.isfinite(FORMULAS[name].enclosure(**point).upper)


def test_the_repaired_xi_says_nothing_below_two_counts() -> None:
    values = FORMULAS["xi_repaired"].estimate(**{**_XI, "N": np.array([0, 1, 10**6])})
    assert list(values[:2]) == [2.0, 2.0]
    assert values[2] < 0.05


def test_the_known_model_theorem_keeps_its_hypotheses() -> None:
    theorem = FORMULAS["regret_known_stated"]
    point = {"B": 1, "W": 1, "lam": 1, "d": 1, "S": 5, "A": 4, "n": 10, "T": 10, "delta": "0.05"}
    assert math.isfinite(theorem.enclosure(**point).upper)
    with pytest.raises(InputError, match="requires delta <= 1/e"):
        theorem.enclosure(**{**point, "delta": "0.37"})
    # B / kappa = 0.1966 at B = W = 1
    with pytest.raises(InputError, match="requires lam >= B / kappa"):
        theorem.enclosure(**{**point, "lam": "0.19"})
    assert math.isfinite(theorem.enclosure(**{**point, "lam": Fraction(1967, 10_000)}).upper)
    # cosh(BW) overflows a float here; the condition must not
    assert theorem.conditions[1].holds(lam=1, B=1e3, W=1e3)


def test_tables_of_different_sizes_are_refused() -> None:
    with pytest.raises(InputError, match="one count for each cell"):
        FORMULAS["transition_bonus"].estimate(S=5, A=4, eta=1, delta_P=0.05, occupancy=[1, 2, 3], counts=[1, 2])


def test_a_cover_coarser_than_the_range_is_refused() -> None:
    with pytest.raises(InputError, match="epsilon <= 4 eta H"):
        FORMULAS["offline_bonus_log_term"].estimate(**{**_XI, "epsilon": 33, "t": 9})
    with pytest.raises(InputError, match="epsilon <= 32 H"):
        FORMULAS["bonus_sum_stated"].estimate(**{**_SUMS, "H": 2, "B": 1, "W": 1, "delta": 0.05, "epsilon": 129})
