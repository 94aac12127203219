"""Conditions hold up to their threshold and not beyond; branches switch where the statement says."""

from __future__ import annotations

from math import log, sqrt
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


def test_the_l1_radius_and_bonus_are_capped_and_no_more() -> None:
    assert at("bonus_radius", N=1) == 2
    assert at("bonus_radius", S=1, A=1, delta_P=0.875, N=1) == pytest.approx(sqrt(2 * (log(2) + log(2 / 0.875))))
    row = at("bonus_radius", N=4000)
    assert at("transition_bonus", occupancy=[0.25], counts=[4000]) == pytest.approx(POINT["eta"] * 0.25 * row)


def test_a_single_state_needs_no_cover_and_two_states_need_one() -> None:
    alone, pair = {"S": 1, "rows": 2, "n": 40}, {"S": 2, "A": 2, "rows": 2, "n": 40}
    confidence = log(1 / POINT["delta"]) / 40
    assert at("transition_error_infimum", **alone) == pytest.approx(6 * (log(2) / 40 + confidence))
    assert at("transition_error_closed_form", **alone) == pytest.approx(2 * confidence)
    assert at("transition_error_repaired", **alone) == pytest.approx(2 * confidence)
    assert at("transition_error_closed_form", **pair) == pytest.approx(4 / 40 * (log(63) + 2) + 2 * confidence)
    scales = [i / 1000 for i in range(1, 9000)]
    infimum = min(6 / 40 * (log(2) + 4 * log(3 / e + 1)) + 6 * confidence + e for e in scales)
    assert at("transition_error_infimum", **pair) == pytest.approx(infimum, rel=1e-6)
    assert at("transition_error_repaired", **pair) > at("transition_error_repaired", **alone) + 0.1


def test_probabilities_are_capped_at_one() -> None:
    assert at("delta_n_known", radius=0.9) == 1
    assert at("delta_n_known_deterministic", radius=0.9) == 1
    assert at("delta_n_unknown", radius=0.9, R2=0.25) == 1
    assert at("delta_n_unknown_deterministic", radius=0.9, R2=0.25) == 1
    assert at("delta_n_version_space", n=1, delta_off=0.125) == 1


def test_degenerate_points_have_their_limits() -> None:
    assert at("potential_factor", L=0, v=2) == 1
    # the floor 1 inside log log: 4 eta^2 H t is 0.36 and 0.72 below it, 1.44 above
    early, later = ({"eta": 0.3, "H": 1, "T": 4, "epsilon": 0.5, "t": t} for t in (2, 4))
    assert at("squared_true_bonus_sum_stated", **early) < at("squared_true_bonus_sum_stated", **later)
    # one uncovered pair: the logarithm divides by one
    few = {"n": 10**6, "uncovered": 1, "log_covering": 2}
    visits = 2 * POINT["T"] * (POINT["H"] - 1)
    size = 32 * POINT["eta"] ** 2
    covered = 2 * size * POINT["S_reach"] * log(1 + 2 * visits / (POINT["S_reach"] * 10**6 * POINT["gamma_min"]))
    uncovered = 2 * size * log(1 + visits) + 16 * POINT["eta"] ** 2 * (POINT["H"] - 1)
    assert at("squared_bonus_sum_repaired", **few) == pytest.approx(covered + uncovered)


def test_the_sharp_ratio_switches_at_its_threshold() -> None:
    # (1 - R)^2 = 0.49: below it the formula, above it 1 / gamma_min
    assert at("concentrability_sharp", R=0.3, gamma_min=0.4) == pytest.approx((0.7 + sqrt(0.51 * 1.5)) ** 2)
    assert at("concentrability_sharp", R=0.3, gamma_min=0.5) == pytest.approx(2)
