"""The numbers published with the issue, reproduced with certificates at S=5, A=4, H=8, delta=0.05."""

from __future__ import annotations

import math

import pytest

from bridge_theory import (
    concentrability_sharp,
    concentrability_stated,
    offline_radius,
    offline_radius_appendix,
    offline_radius_corollaries,
    offline_radius_repaired,
    offline_radius_repaired_angle,
    policy_error_repaired,
    policy_error_stated,
    transition_error_repaired,
    transition_error_stated,
)
from bridge_theory.bound import Bound
from bridge_theory.solve import solve_for

_TABULAR = {"S": 5, "A": 4, "H": 8, "delta": "0.05"}


@pytest.mark.parametrize(
    ("bound", "gamma_min", "n"),
    [
        (offline_radius, "0.1", 150_158),
        (offline_radius, "0.01", 364_775),
        (offline_radius_appendix, "0.1", 150_158),
        (offline_radius_corollaries, "0.1", 229_910),
        (offline_radius_corollaries, "0.01", 556_379),
    ],
)
def test_stated_radius_first_below_one(bound: Bound, gamma_min: str, n: int) -> None:
    solution = solve_for("n", bound, 1, gamma_min=gamma_min, **_TABULAR)
    assert solution.value == n
    assert solution.meets.upper < 1 < solution.fails.lower
    assert solution.excluded  # every smaller n, without appeal to monotonicity


def test_errors_first_below_one() -> None:
    policy = solve_for("n", policy_error_stated, 1, S=5, A=4, delta1="0.025")
    transition = solve_for("n", transition_error_stated, 1, S=5, A=4, H=8, delta2="0.025")
    assert (policy.value, transition.value) == (102, 5772)
    assert policy.excluded
    assert transition.excluded


def test_stated_radius_at_two_demonstrations() -> None:
    enclosure = offline_radius.enclosure(n=2, gamma_min="0.1", **_TABULAR)
    assert 1260.95 < enclosure.lower <= enclosure.upper < 1261.05


@pytest.mark.parametrize(("rows", "n"), [(5, 735), (20, 2565)])
def test_repaired_radius_first_below_one(rows: int, n: int) -> None:
    # the infimum over epsilon is exact here; the audit's grid gave 736 and 2,565
    solution = solve_for("n", offline_radius_repaired, 1, S=5, H=8, delta="0.05", rows=rows)
    assert solution.value == n
    assert solution.meets.upper < 1 < solution.fails.lower


@pytest.mark.parametrize("rows", [5, 20])
def test_angle_form_is_earlier_still(rows: int) -> None:
    linear = solve_for("n", offline_radius_repaired, "0.999999999", S=5, H=8, delta="0.05", rows=rows)
    angle = solve_for("n", offline_radius_repaired_angle, "0.999999999", S=5, H=8, delta="0.05", rows=rows)
    assert angle.value < linear.value / 2


@pytest.mark.parametrize(("rows", "n"), [(5, 735), (20, 2565)])
def test_repaired_radius_by_an_independent_search(rows: int, n: int) -> None:
    """Plain floats and every denominator, instead of balls and two neighbours."""

    def radius(trajectories: int) -> float:
        def cover(k: int) -> float:
            cells = math.lgamma(k + 9) - math.lgamma(5) - math.lgamma(k + 5)
            return 2 * rows * cells / trajectories + 16 * math.log1p(4 / k)

        confidence = math.log(40)
        policy = (5 * math.log(2) + confidence) / trajectories
        transition = min(map(cover, range(1, 20_000))) + 2 * confidence / trajectories
        return math.sqrt(policy) + math.sqrt(2 * transition)

    assert radius(n) < 1 < radius(n - 1)
    assert offline_radius_repaired.estimate(S=5, H=8, n=n, delta=0.05, rows=rows) == pytest.approx(radius(n), rel=1e-12)


def test_infimum_over_real_epsilon_is_the_minimum_over_denominators() -> None:
    """The certified minimum is below the covering bound at every scale of a fine grid, and is nearly attained."""
    best = transition_error_repaired.enclosure(S=5, H=8, n=736, delta="0.025", rows=5)
    values = []
    for step in range(1, 4000):
        epsilon = step / 10_000
        denominator = math.ceil(4 / math.expm1(epsilon / 8))
        log_cover = 5 * math.log(math.comb(denominator + 8, 4))
        values.append(2 * (log_cover + math.log(40)) / 736 + 2 * epsilon)
    assert best.upper <= min(values) <= best.upper * 1.001


def test_infimum_over_a_sharper_policy_error() -> None:
    errors = {"S": 5, "n": 736, "delta": "0.025"}
    assert policy_error_repaired.enclosure(**errors).upper < 0.01


def test_sharp_concentrability() -> None:
    point = {"R": "0.01", "gamma_min": "0.01"}
    assert round(concentrability_sharp.enclosure(**point).middle, 2) == 5.73
    assert 21 in concentrability_stated.enclosure(**point)
