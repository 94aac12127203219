"""``solve_for`` returns the safe side of its own inequality, for every bound and parameter it accepts, and says so."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from points import draw_point

from bridge_theory import (
    Setting,
    kappa,
    missing_mass_good_turing,
    mle_finite_repaired,
    offline_radius,
    offline_radius_mass,
    offline_radius_repaired,
    regret_known_stated,
    regret_trivial,
    transition_error_rate,
    transition_error_repaired,
    transition_error_stated,
    transition_log_covering_two_states,
)
from bridge_theory.bound import Bound
from bridge_theory.catalog import all_bounds
from bridge_theory.core import Arithmetic, Value, bound, falls, rises
from bridge_theory.errors import InputError
from bridge_theory.parameters import PARAMETERS, Exact
from bridge_theory.solution import Solution
from bridge_theory.solve import solve_for

_PAIRS = [(b, name) for b in all_bounds() for name in b.monotone if not PARAMETERS[name].array]
_STATED = {"S": 5, "A": 4, "H": 8, "delta": "0.05", "gamma_min": "0.1"}


def _confirm(solution: Solution) -> None:
    """Evaluate both sides again, independently of what the solver recorded."""
    if solution.value is not None:
        assert solution.bound.enclosure(**solution.others, **{solution.name: solution.value}).lower <= solution.target
        assert solution.meets is not None
    if solution.status == "found" and solution.fails is not None:
        again = solution.bound.enclosure(**solution.others, **{solution.name: solution.beyond})
        assert again.upper > solution.target
    if solution.status == "never":
        assert solution.value is None
        assert solution.beyond is None


@pytest.mark.parametrize(("b", "name"), _PAIRS, ids=[f"{b.name}-{name}" for b, name in _PAIRS])
@settings(max_examples=2)
@given(data=st.data())
def test_round_trip(b: Bound, name: str, data: st.DataObject) -> None:
    point = draw_point(data, b)
    assume(b.monotone[name].holds(point))
    target = Fraction(b.enclosure(**point).upper)  # met at the point itself
    others = {key: value for key, value in point.items() if key != name}
    solution = solve_for(name, b, target, **others)
    _confirm(solution)
    assert solution.value is not None
    if b.monotone[name].direction == "falls":
        assert solution.value <= Fraction(point[name])
    else:
        assert solution.value >= Fraction(point[name])


def test_neighbours_differ_by_one_integer_or_one_float() -> None:
    integer = solve_for("n", offline_radius, 1, **_STATED)
    assert integer.value - 1 == integer.beyond
    real = solve_for("gamma_min", offline_radius, 1, **{**_STATED, "n": 200_000, "gamma_min": "1"} | {"gamma_min": "1"})
    assert float(real.beyond) < float(real.value) < float(real.beyond) * (1 + 1e-15)


@pytest.mark.parametrize("exponent", [2, 3])
def test_huge_answers(exponent: int) -> None:
    solution = solve_for("n", offline_radius, Fraction(1, 10**exponent), **_STATED)
    assert solution.status == "found"
    assert solution.value > 10**9
    _confirm(solution)
    assert solution.excluded


def test_answers_beyond_a_trillion() -> None:
    solution = solve_for("n", offline_radius, "1e-4", **_STATED)
    assert solution.value > 10**12
    assert solution.meets.upper <= 1e-4 < solution.fails.lower


def test_target_that_no_value_meets() -> None:
    solution = solve_for("n", offline_radius, 0, **_STATED)
    assert (solution.status, solution.value) == ("never", None)
    assert "No n up to 1000000000000000000000000 achieves offline_radius <= 0" in solution.words
    assert "still" in solution.reason


def test_target_that_no_value_meets_from_below() -> None:
    solution = solve_for("B", kappa, 3, W=1)
    assert solution.status == "never"
    assert solution.fails.lower > 3


def test_target_that_cannot_be_told_from_the_bound() -> None:
    solution = solve_for("R", next(b for b in all_bounds() if b.name == "mean_difference_sharp"), 0, B="1e-60")
    assert solution.value == 0
    third = solve_for("mass", offline_radius_mass, Fraction(1, 3))
    _confirm(third)


def test_target_that_every_value_meets() -> None:
    falling = solve_for("n", offline_radius, 10**9, **_STATED)
    assert (falling.status, falling.value) == ("always", 1)
    rising = solve_for("mass", offline_radius_mass, 1)
    assert (rising.status, rising.value) == ("always", 1)
    assert "holds for every mass up to 1: " in str(rising)


def test_answers_at_the_end_of_the_search_claim_nothing_beyond_it() -> None:
    never = solve_for("n", offline_radius_repaired, "1e-13", **_STATED, rows=5)
    assert (never.status, never.beyond) == ("never", 10**24)
    assert "No n up to 1000000000000000000000000 achieves" in never.words
    assert r"\text{ for every } n \le 1000000000000000000000000$" in never._repr_latex_()
    assert offline_radius_repaired.value(n=10**32, **_STATED, rows=5).enclosure.upper < 1e-13
    always = solve_for("T", regret_trivial, 10**30, B=1, W=1)
    assert always.words.startswith("regret_trivial <= 1000000000000000000000000000000 holds for every T up to 10000000")
    assert regret_trivial.value(T=10**30, B=1, W=1).enclosure.lower > 10**30
    assert "for every n from 1 on" in solve_for("n", offline_radius, 10**9, **_STATED).words
    assert "No B from 5e-324 on achieves kappa <= 3" in solve_for("B", kappa, 3, W=1).words
    excluded = solve_for("S", offline_radius, 10**4, A=4, H=8, delta="0.05", gamma_min="0.1", n=100)
    assert "rules out all larger ones up to 1000000000000000000000000)" in excluded.words


def test_search_stays_inside_the_conditions() -> None:
    few = solve_for("n", missing_mass_good_turing, 100, singletons=7, delta="0.05")
    assert (few.status, few.value) == ("always", 7)
    pair = solve_for("class_size", mle_finite_repaired, "0.5", n=10, delta="0.05")
    assert (pair.value, pair.beyond) == (8, 9)
    last = solve_for("singletons", missing_mass_good_turing, 100, n=7, delta="0.05")
    assert (last.status, last.value) == ("always", 7)
    with pytest.raises(InputError, match="applies at no rows"):
        solve_for("rows", transition_log_covering_two_states, 1, S=3, epsilon=1)


def test_exclusion_needs_no_monotonicity_and_is_reported() -> None:
    assert "interval arithmetic rules out all smaller ones" in solve_for("n", offline_radius, 1, **_STATED).words
    by_declaration = solve_for("n", offline_radius_repaired, 1, S=5, H=8, delta="0.05", rows=20)
    assert not by_declaration.excluded
    assert "by monotonicity" in by_declaration.words


def test_setting_supplies_the_other_parameters() -> None:
    setting = Setting(**_STATED, B=1)
    assert solve_for("n", offline_radius, 1, setting=setting).value == 150_158


def test_wrong_declaration_is_refused() -> None:
    @bound(
        title="mutant", symbol="x", source="test", group="offline", status="stated", words="{value}",
        monotone={"n": falls("a planted mistake: it falls and then rises")},
    )  # fmt: skip
    def valley(m: Arithmetic, *, n: Value) -> Value:
        return (n - 1000) ** 2

    with pytest.raises(InputError, match="against its declared direction in n"):
        solve_for("n", valley, 10)


def test_refusals() -> None:
    with pytest.raises(InputError, match="only certified bounds can be inverted"):
        solve_for("n", transition_error_rate, 1)
    with pytest.raises(InputError, match="has no known direction in W; it can be solved for: S, A"):
        solve_for("W", offline_radius, 1, **_STATED)
    with pytest.raises(InputError, match="solving offline_radius for n needs gamma_min"):
        solve_for("n", offline_radius, 1, S=5, A=4, H=8, delta="0.05")
    with pytest.raises(InputError, match="not known to be monotone in n"):
        solve_for("n", transition_error_stated, 1, S=5, A=4, H=1, delta2="0.9")
    with pytest.raises(InputError, match="target = 'soon' is not a finite number"):
        solve_for("n", offline_radius, "soon", **_STATED)


def test_ties_that_no_precision_decides_are_withheld() -> None:
    declared = {"title": "tie", "symbol": "x", "source": "test", "group": "offline", "status": "stated", "words": "x"}

    @bound(**declared, monotone={"n": falls("n divides")})
    def falling(m: Arithmetic, *, n: Value) -> Value:
        return m.sqrt(m.number(2)) ** 2 / n

    @bound(**declared, monotone={"n": rises("n multiplies")})
    def rising(m: Arithmetic, *, n: Value) -> Value:
        return m.sqrt(m.number(2)) ** 2 * n

    tied = solve_for("n", falling, 1)  # equal to 1 at n = 2, which no ball can certify
    assert (tied.status, tied.value, tied.beyond, tied.fails, tied.excluded) == ("undecided", 3, 2, None, False)
    assert "n = 3 achieves falling <= 1 but is not certified to be the smallest" in tied.words
    assert "agree to the highest precision" in tied.words
    tied = solve_for("n", rising, 2)
    assert (tied.status, tied.value, tied.fails) == ("undecided", None, None)
    assert "No n is certified to achieve rising <= 2" in tied.words
    assert "agree to the highest precision" in tied.words
    assert "undecided" in tied._repr_latex_()


def test_wide_enclosures_are_undecided_and_do_not_agree() -> None:
    @bound(
        title="wide", symbol="x", source="test", group="offline", status="stated", words="x",
        monotone={"n": falls("n divides"), "T": rises("it multiplies")},
    )  # fmt: skip
    def wide(m: Arithmetic, *, n: Value, T: Value) -> Value:
        # the sine vanishes for every n, which no ball around a multiple of pi tells from its sign
        return m.if_at_most(0, m.sin(n * m.pi()), lambda: T / n, lambda: 4 * T / n)

    for name, others in (("n", {"T": 4}), ("T", {"n": 4})):
        solution = solve_for(name, wide, 2, **others)
        assert solution.status == "undecided"
        assert "encloses the bound only in [" in solution.words
        assert "agree" not in solution.words


@pytest.mark.parametrize(
    ("b", "name", "target", "others", "at_least"),
    [
        (transition_error_repaired, "H", 1, {"n": 10**18}, 10**24),
        (offline_radius_repaired, "H", 1, {"n": 10**6}, 10**24),
        (offline_radius_repaired, "n", "1e-7", {"H": 8}, 10**17),
    ],
)
def test_minimum_far_from_its_float_start_is_decided(
    b: Bound, name: str, target: Exact | str, others: dict[str, int], at_least: int
) -> None:
    # the float minimiser is off by more than any fixed number of integers
    solution = solve_for(name, b, target, S=5, rows=5, delta="0.05", **others)
    assert solution.value >= at_least
    assert solution.status == ("found" if name == "n" else "always")
    assert solution.meets.narrow
    _confirm(solution)


def test_answers_in_a_gap_of_the_conditions_are_refused() -> None:
    point = {"W": 1, "lam": "0.1", "d": 1, "S": 1, "A": 2, "n": 1000, "T": 100, "delta": "0.05"}
    with pytest.raises(InputError, match=r"crosses the target at B = 1\.22.*where its own conditions fail"):
        solve_for("B", regret_known_stated, 500, **point)
    for target in (10, 10**8):  # crossed on either side of the gap
        solution = solve_for("B", regret_known_stated, target, **point)
        assert solution.status == "found"
        assert regret_known_stated.value(B=solution.value, **point).enclosure.upper <= target
