"""A bound that is exactly 1 prints 1, and meets a target of 1: no digit is rounded off a number that is known."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

import pytest

from bridge_theory import solve_for
from bridge_theory.arithmetic import flint_balls
from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.bound import Bound
from bridge_theory.catalog import FORMULAS, all_bounds
from bridge_theory.cli import bounds as command
from bridge_theory.parameters import parameter, to_exact
from bridge_theory.verdict import decide

ATTAINED: list[tuple[str, dict[str, Any], Any]] = [
    ("confidence_set_radius_angle", {"R1": 0, "R2": 1}, 1),
    ("confidence_set_radius_angle", {"R1": "0.25", "R2": "0.5"}, 1),
    ("confidence_set_radius_repaired", {"R1": "0.25", "R2": "0.0625"}, 1),
    ("confidence_set_radius_deterministic", {"R1": "0.25", "R2": "0.125"}, 1),
    ("confidence_set_radius", {"R1": 0, "R2": "0.25", "H": 1, "gamma_min": 1}, 1),
    ("offline_radius_mass", {"mass": 1}, 1),
    ("hellinger_from_kl", {"kl": 0}, 0),
    ("hellinger_from_kl_with_exits", {"kl": 0, "exit_mass": 0}, 0),
    ("mean_difference_sharp", {"B": "0.5", "R": 1}, 1),
    ("feature_difference_repaired", {"B": "0.5", "radius": 1}, 1),
    ("feature_difference_repaired", {"B": 1, "radius": 0}, 0),
    ("missing_mass_expected", {"S": 4, "n": 1}, 1),
    ("elliptical_potential", {"L": 1, "v": 1, "d": 1, "square_sum": 1}, 1),
    ("elliptical_potential_capped", {"v": 1, "d": 1, "square_sum": 1}, 1),
    ("elliptical_norm_sum", {"L": 1, "v": 1, "d": 1, "T": 1, "square_sum": 1}, 1),
    ("exact_recovery_failure", {"S_reach": 2, "n": 1, "gamma_min": "0.5"}, 1),
    ("delta_n_known", {"radius": 1}, 1),
    ("delta_n_unknown", {"radius": 1, "R2": "0.3"}, 1),
    ("delta_n_version_space", {"S": 1, "A": 2, "n": 1, "delta_off": "0.1"}, 1),
    ("transition_log_covering_two_states", {"S": 2, "rows": 3, "epsilon": 1}, 0),
    ("mle_finite_repaired", {"n": 1, "class_size": 2, "delta": "0.999"}, None),
]


@pytest.mark.parametrize(("name", "point", "value"), ATTAINED)
def test_an_attained_value_is_printed_as_it_is_and_meets_its_target(
    name: str, point: dict[str, Any], value: Any
) -> None:
    bound = FORMULAS[name]
    assert isinstance(bound, Bound)
    enclosure = bound.enclosure(**point)
    if value is None:  # a logarithm of no power of e is no decimal
        assert enclosure.exact is None
        return
    assert (enclosure.exact, enclosure.at_most, enclosure.at_least) == (value, str(value), str(value))
    exact = bound.exact_arguments(point)
    assert decide(bound, exact, value).verdict == "meets"
    assert decide(bound, exact, value - Fraction(1, 10**50)).verdict == "fails"
    assert decide(bound, exact, value + Fraction(1, 10**50)).verdict == "meets"


def test_the_solver_decides_at_a_target_that_is_attained() -> None:
    solution = solve_for("square_sum", FORMULAS["elliptical_potential_capped"], 1, v=1, d=1)  # type: ignore[arg-type]
    assert (solution.status, solution.value) == ("found", 1)
    solution = solve_for("R1", FORMULAS["confidence_set_radius_angle"], 1, R2=1)  # type: ignore[arg-type]
    assert solution.status == "always"
    solution = solve_for("mass", FORMULAS["offline_radius_mass"], 1)  # type: ignore[arg-type]
    assert solution.status == "always"


@pytest.mark.parametrize("bound", all_bounds(), ids=lambda bound: bound.name)
def test_no_trivial_value_is_undecided_at_its_own_number(bound: Bound) -> None:
    # at round numbers a bound either keeps away from its trivial value or is exactly it: never beyond deciding
    for scale in (0, 1, "0.5", "0.25", 4):
        point = {name: _near(name, scale) for name in bound.parameters}
        if bound.trivial is None or any(value is None for value in point.values()):
            continue
        try:
            value = bound.value(**point)
        except ValueError:
            continue
        assert value.vacuous is not None
        if value.trivial is not None and value.trivial.exact is not None:
            assert decide(bound, value.parameters, value.trivial.exact).verdict != "undecided"


def _near(name: str, scale: Any) -> Any:
    row = parameter(name)
    number = to_exact(name, scale)
    if row.domain.integer:
        number = max(1, round(number))
    if not row.domain.contains(number):
        return None
    return [number] if row.array else number


def test_operations_keep_what_is_known() -> None:
    quarter = flint_balls.rational(Fraction(1, 4))
    known = {
        Fraction(1, 2): BALLS.sqrt(quarter),
        Fraction(1, 16): BALLS.power(quarter, flint_balls.rational(2)),
        Fraction(0): BALLS.log(flint_balls.rational(1)),
        Fraction(1): BALLS.min(flint_balls.rational(1), BALLS.pi()),
        Fraction(4): BALLS.max(BALLS.pi(), flint_balls.rational(4)),
    }
    for number, value in known.items():
        assert flint_balls.as_fraction(value) == number
    assert flint_balls.as_fraction(BALLS.sqrt(flint_balls.rational(2))) is None
    assert flint_balls.as_fraction(BALLS.log1p_ratio(quarter, quarter)) == 1
    assert flint_balls.as_fraction(BALLS.log1p_ratio(quarter, flint_balls.rational(3))) is None
    assert flint_balls.as_fraction(BALLS.min(BALLS.pi(), flint_balls.rational(4))) is None


_FROM_BELOW: dict[str, dict[str, Any]] = {
    "curvature_factor": {"reach": 1},
    "elliptical_floor": {"W": 1, "d": 3, "T": 10, "gamma": 1, "diameter": 1},
    "fewest_answers": {"information": "0.15", "delta": "0.05"},
    "log_sigmoid_lower": {"margin": -2, "tangent": 1},
    "share_gained": {"shortfall": 2},
}
"""Points at which the bounds from below have more than six digits."""


@pytest.mark.parametrize("name", _FROM_BELOW)
def test_a_bound_from_below_is_rounded_down_wherever_it_is_printed(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    point, bound = _FROM_BELOW[name], FORMULAS[name]
    assert isinstance(bound, Bound)
    value = bound.value(**point)
    assert value.enclosure.at_least == value.shown != value.enclosure.at_most
    flags = [f"--{key.replace('_', '-')}={number}" for key, number in point.items()]
    for form, printed in (([], value.shown), (["--latex"], rf"\geq {value.shown}")):
        out = _printed(capsys, [*flags, "--only", name, *form])
        assert printed in out
        assert value.enclosure.at_most not in re.findall(r"-?\d+\.?\d*", out)
    assert value.shown in value.words
    assert value.enclosure.at_most not in value.words


def test_no_bound_from_below_is_left_out() -> None:
    assert [bound.name for bound in all_bounds() if bound.from_below] == sorted(_FROM_BELOW)


def _printed(capsys: pytest.CaptureFixture[str], arguments: list[str]) -> str:
    assert command.main(arguments) == 0
    return capsys.readouterr().out
