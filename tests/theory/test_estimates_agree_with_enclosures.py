"""A float64 estimate is right to nine digits on the whole declared domain, corners included, or says that it is not."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from extremes import extreme_points

from bridge_theory import (
    confidence_set_radius_angle,
    feature_difference_repaired,
    policy_error_stated,
    regret_known_stated,
    squared_bonus_sum_stated,
    transition_error_stated,
    xi_bar,
)
from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.arithmetic.tracked import TRACKED, Tracked
from bridge_theory.catalog import FORMULAS
from bridge_theory.enclosure import Enclosure, ball_arguments, enclose
from bridge_theory.errors import InputError
from bridge_theory.formula import Formula
from bridge_theory.parameters import parameter

_POINTS = 30
_SMALLEST_NORMAL = 2.3e-308  # below it float64 has fewer digits


def _enclosed(formula: Formula, point: dict[str, object]) -> Enclosure:
    return enclose(lambda: formula(BALLS, **ball_arguments(formula.exact_arguments(point))))


def _agrees(value: float, truth: Enclosure) -> bool:
    if math.isinf(truth.lower) and math.isinf(truth.upper):
        return not math.isfinite(value)
    if math.isinf(truth.lower) or math.isinf(truth.upper):
        return value == (truth.upper if math.isinf(truth.upper) else truth.lower)
    return abs(value - truth.middle) <= 1e-9 * abs(truth.middle) + _SMALLEST_NORMAL


@pytest.mark.parametrize("name", FORMULAS)
def test_estimates_are_the_enclosed_numbers(name: str) -> None:
    formula = FORMULAS[name]
    for point in extreme_points(formula, _POINTS):
        truth = _enclosed(formula, point)
        assert truth.narrow, f"the enclosure is too wide at {point}"
        value = float(formula.estimate(**point))
        assert _agrees(value, truth), f"{value} is not in {truth} at {point}"


@pytest.mark.parametrize("name", FORMULAS)
def test_arrays_of_corners_are_their_points(name: str) -> None:
    formula = FORMULAS[name]
    points = list(extreme_points(formula, 6))
    tables = {key: value for key, value in points[0].items() if parameter(key).array}
    columns = {key: np.array([float(point[key]) for point in points]) for key in points[0] if key not in tables}
    try:
        together = np.broadcast_to(formula.estimate(**columns, **tables), len(points))
    except InputError:  # the first point's tables do not suit the others
        assert tables
        return
    for index, value in enumerate(together):
        truth = _enclosed(formula, {**tables, **{key: float(column[index]) for key, column in columns.items()}})
        assert _agrees(float(value), truth)


@pytest.mark.parametrize("name", FORMULAS)
def test_floats_know_how_far_off_they_are(name: str) -> None:
    formula = FORMULAS[name]
    for point in extreme_points(formula, _POINTS):
        truth = _enclosed(formula, point)
        arguments = {key: Tracked(np.asarray(value, dtype=np.float64)[()]) for key, value in point.items()}
        with np.errstate(all="ignore"):
            outcome = formula(TRACKED, **arguments)
        if isinstance(outcome, Tracked) and np.isfinite(outcome.at) and np.isfinite(outcome.off):
            distance = max(abs(Fraction(float(outcome.at)) - Fraction(end)) for end in _finite_ends(truth))
            rounding = Fraction(truth.width)  # of the ends themselves
            assert distance <= Fraction(float(outcome.off)) + rounding, f"{outcome.at} +- {outcome.off} at {point}"


def _finite_ends(truth: Enclosure) -> list[float]:
    return [end for end in (truth.lower, truth.upper) if math.isfinite(end)]


def test_the_points_reach_every_formula_and_every_corner() -> None:
    drawn = {name: list(extreme_points(formula, _POINTS)) for name, formula in FORMULAS.items()}
    few = {name: len(points) for name, points in drawn.items() if len(points) < _POINTS}
    assert not few
    values = {key: {v for points in drawn.values() for p in points if not isinstance(v := p.get(key), list)}
              for key in ("delta", "n", "H", "gamma_min", "S", "A")}  # fmt: skip
    assert {1e-300, 1 - 1e-12} <= values["delta"]
    assert {1, 10**18} <= values["n"]
    assert {1, 10**6} <= values["H"]
    assert {1, 1 - 1e-12} <= values["gamma_min"]
    assert {1, 10**9} <= values["S"] & values["A"]


def test_the_known_cases() -> None:
    stated = policy_error_stated.estimate(S=1, A=10**9, n=1, delta1=1e-300)
    assert stated == pytest.approx(4 * (math.log(1e9) - math.log(1e-300)), rel=1e-12)
    large = transition_error_stated.estimate(S=1, A=1, H=10**6, n=10**18, delta2=1e-300)
    assert large == pytest.approx(4e-18 * (24 * math.log(10) + 300 * math.log(10)), rel=1e-12)
    # sin(arccos(1 - x)) is sqrt(x (2 - x)), where 1 - x is 1
    assert confidence_set_radius_angle.estimate(R1=0, R2=1.6e-17) == pytest.approx(math.sqrt(3.2e-17), rel=1e-12)
    assert feature_difference_repaired.estimate(B=1, radius=1e-9) == pytest.approx(4 * math.sqrt(2) * 1e-9, rel=1e-12)
    # 4 eta H / epsilon is 28 exactly, in decimals; float64 makes it 28.000000000000004, whose ceiling is 29
    exact = xi_bar.estimate(S=1, A=1, H=1, eta="0.07", epsilon="0.01", delta="0.5", N=10**6)
    assert exact == pytest.approx(0.28 * math.sqrt((math.log(28) + math.log(12 * math.log(1e6))) / 1e6), rel=1e-12)


def test_exact_numbers_stay_exact_where_digits_cancel() -> None:
    value = policy_error_stated.estimate(S=1, A=1, n=1, delta1=1 - Fraction(1, 10**12))
    assert value == pytest.approx(4e-12, rel=1e-11)  # the float next to delta1 is off by 1e-4 of 1 - delta1


def test_conditions_are_decided_at_the_exact_threshold() -> None:
    setting = {"B": 1, "W": 1, "lam": 1, "d": 1, "S": 1, "A": 2, "n": 9, "T": 9}
    regret_known_stated.estimate(delta=math.nextafter(math.exp(-1), 0), **setting)
    below = Fraction("0.3678794411714423215955237701614608674458")
    regret_known_stated.estimate(delta=below, **setting)
    with pytest.raises(InputError, match="delta <= 1/e"):
        regret_known_stated.estimate(delta=below + Fraction(1, 10**40), **setting)
    # B = lam kappa up to 30 digits, at W = 1: kappa = 2 + 2 cosh(1)
    size = Fraction("5.086161269630487558109711314804")
    regret_known_stated.estimate(**{**setting, "B": 1, "delta": "0.1", "lam": 1 / Fraction("5.08616126963048755")})
    with pytest.raises(InputError, match="lam >= B / kappa"):
        regret_known_stated.estimate(**{**setting, "delta": "0.1", "lam": 1 / (size + Fraction(1, 10**12))})
    # epsilon = 4 eta H in decimals, which three roundings of float64 would put on either side
    rest = {"S": 2, "A": 2, "n": 5, "T": 5, "gamma_min": "0.5", "S_reach": 1, "delta_martingale": "0.1"}
    squared_bonus_sum_stated.estimate(eta="0.1", H=3, epsilon="1.2", **rest)
    with pytest.raises(InputError, match="epsilon <= 4 eta H"):
        squared_bonus_sum_stated.estimate(eta="0.1", H=3, epsilon=Fraction("1.2") + Fraction(1, 10**30), **rest)
