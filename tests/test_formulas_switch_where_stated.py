"""Conditions hold up to their threshold and not beyond; branches switch where the statement says."""

from __future__ import annotations

from typing import Any

import pytest

from bridge_theory.catalog import FORMULAS
from bridge_theory.errors import InputError

POINT: dict[str, Any] = {
    "B": 2, "W": 0.5, "S": 4, "A": 3, "H": 3, "eta": 1.25, "epsilon": 0.5, "n": 32, "T": 50, "t": 7, "gamma_min": 0.25,
    "S_reach": 5, "delta": 0.0625, "delta_martingale": 0.125, "delta1": 0.25, "log_covering": 9.5, "uncovered": 2,
    "N": 40, "occupancy": [2.5, 0.25], "counts": [40, 7], "lam": 2, "d": 3, "class_size": 9, "singletons": 3,
    "unvisited": 2, "delta_w": 0.125, "delta_P": 0.125, "rows": 4, "kl": 0.5, "visits": [3, 4],
}  # fmt: skip


def at(name: str, **changes: Any) -> float:
    formula = FORMULAS[name]
    point = POINT | changes
    return float(formula.estimate(**{key: point[key] for key in formula.parameters}))


@pytest.mark.parametrize(
    ("name", "inside", "outside"),
    [
        ("squared_bonus_sum_stated", {"epsilon": 15}, {"epsilon": 15.25}),
        ("bonus_sum_stated", {"epsilon": 288}, {"epsilon": 290}),
        ("played_bonus_sum_stated", {"epsilon": 288}, {"epsilon": 290}),
        ("xi", {"N": 2}, {"N": 1}),
        ("xi_bar", {"N": 2}, {"N": 1}),
        ("empirical_bonus", {"counts": [2, 2]}, {"counts": [2, 1]}),
        ("expected_bonus", {"counts": [2, 2]}, {"counts": [1, 2]}),
        ("empirical_bonus", {"counts": [9, 9]}, {"counts": [9, 9, 9]}),
        ("term_3_rate", {"T": 2}, {"T": 1}),
        ("squared_bonus_rate", {"T": 2}, {"T": 1}),
        ("offline_bonus_log_term", {"t": 2}, {"t": 1}),
        ("mle_finite_sharp", {"class_size": 2}, {"class_size": 1}),
        ("missing_mass_observed", {"unvisited": 4}, {"unvisited": 5}),
        ("missing_mass_good_turing", {"singletons": 32}, {"singletons": 33}),
        ("transition_log_covering_two_states", {"S": 2}, {"S": 3}),
        ("regret_known_stated", {"delta": 0.36}, {"delta": 0.37}),
        ("regret_known_stated", {"lam": 0.394}, {"lam": 0.392}),
    ],
)
def test_a_condition_holds_up_to_its_threshold(name: str, inside: dict[str, Any], outside: dict[str, Any]) -> None:
    assert at(name, **inside) == at(name, **inside)  # a number
    with pytest.raises(InputError):
        at(name, **outside)


@pytest.mark.parametrize("name", ["squared_bonus_sum_repaired", "bonus_sum_repaired"])
def test_first_visits_cost_only_where_a_batch_exceeds_the_counts(name: str) -> None:
    # 4 (H - 1) = 8 = n gamma_min at n = 32: one demonstration fewer, and first visits are paid for
    steady = at(name, n=33) / at(name, n=32)
    jump = at(name, n=31) / at(name, n=32)
    assert 0.98 < steady <= 1
    assert jump > 1.03


def test_the_printed_bonus_is_repaired_exactly_where_it_has_no_value() -> None:
    assert at("xi_repaired", N=0) == at("xi_repaired", N=1) == 2 * POINT["eta"]
    assert at("xi_repaired", N=4000) == at("xi", N=4000) < 2 * POINT["eta"]
    assert at("bonus_radius", N=0) == 2
    assert at("bonus_radius", N=1000) < 2


def test_the_offline_covers_need_two_states() -> None:
    cover_free = {"S": 1, "rows": 1, "delta": 0.25, "n": 40}
    for name in ("transition_error_infimum", "transition_error_closed_form", "transition_error_repaired"):
        assert at(name, **cover_free) < at(name, **{**cover_free, "S": 2})
