"""Each engine of the ledger decides at the edge of what it claims: one step further it fails, refuses or admits it."""

from __future__ import annotations

from fractions import Fraction
from math import comb, inf

import numpy as np
import pytest
import sympy
import z3
from hypothesis import given
from hypothesis import strategies as st

from bridge_theory import row_error_at_step, row_error_summed
from bridge_theory.arithmetic import flint_balls
from bridge_theory.errors import InputError
from proofs_checks import smt, symbolic
from proofs_checks.balls import prove_positive
from proofs_checks.coverage import FALSE_ALARM, Coverage, cumulative, simulate
from proofs_checks.exact import certify, every, laws, model
from proofs_checks.exact.surd import Surd, at_most_roots, root, surd
from proofs_checks.outcome import Outcome
from proofs_checks.slopes import SLOPES, Slope, lifted, prove_monotone
from proofs_checks.smt import prove, reals

TINY = Fraction(1, 10**40)


def answers(monkeypatch: pytest.MonkeyPatch, *given: object) -> None:
    queue = list(given)
    monkeypatch.setattr(smt, "_solve", lambda formulas, seconds: (queue.pop(0), None))


def test_only_unsat_is_a_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    (x,) = reals("x")
    answers(monkeypatch, z3.sat, z3.unsat)
    assert prove("query", [x > 0], x > 0).details == "query: unsat"
    answers(monkeypatch, z3.sat, z3.unknown)
    assert prove("query", [x > 0], x > 0).failures == ("query: undecided after 10 s",)
    for unsettled in (z3.unknown, z3.unsat):
        answers(monkeypatch, unsettled, z3.unsat)
        assert "so that nothing is proved" in prove("query", [x > 0], x > 0).failures[0]


def test_a_counterexample_of_the_solver_is_shown() -> None:
    x, y = reals("x y")
    assert prove("order", [x == 3, y == 2], x < y).failures == ("order: false at x = 3, y = 2",)


@given(
    st.fractions(0, 9, max_denominator=50), st.fractions(0, 9, max_denominator=50), st.integers(1, 4), st.integers(1, 4)
)
def test_sums_of_two_roots_are_compared_to_the_last_digit(x: Fraction, y: Fraction, c: int, d: int) -> None:
    value = surd(x * c**2) + surd(y * d**2) + root(x * y) * (2 * c * d)  # (c sqrt x + d sqrt y)^2
    assert at_most_roots(value, (c, x), (d, y))
    assert at_most_roots(value - TINY, (c, x), (d, y))
    assert not at_most_roots(value + TINY, (c, x), (d, y))


def test_one_root_is_compared_to_the_last_digit() -> None:
    assert at_most_roots(8, (2, 2))
    assert not at_most_roots(8 + TINY, (2, 2))
    assert at_most_roots(0, (1, 0), (1, 0))
    assert not at_most_roots(TINY, (1, 0), (1, 0))


@given(st.lists(st.tuples(st.integers(1, 60), st.fractions(-3, 3, max_denominator=12)), min_size=1, max_size=4))
def test_surds_have_the_sign_of_their_balls(terms: list[tuple[int, Fraction]]) -> None:
    value = sum((root(k) * c for k, c in terms), surd(0))
    with flint_balls.working_precision(400):
        ball = sum((flint_balls.ball(k).sqrt() * flint_balls.ball(c) for k, c in terms), start=flint_balls.ball(0))
        assert (value.sign() > 0) == bool(ball > 0)
        assert (value.sign() < 0) == bool(ball < 0)
        assert float(value) == pytest.approx(float(ball), abs=1e-12)
        assert abs(value.ball() - ball) < flint_balls.ball(Fraction(1, 10**80))


def test_surds_that_agree_to_many_digits_are_told_apart() -> None:
    near = root(2) * 10**60
    floor = Fraction(int(str(sympy.floor(sympy.sqrt(2) * 10**60))))
    assert near > floor
    assert near < floor + 1
    assert (near - near).sign() == 0
    assert root(Fraction(8, 9)) == root(2) * Fraction(2, 3)
    assert root(0) == 0
    assert (root(12) * root(3)).rational() == 6
    with pytest.raises(InputError, match="irrational"):
        root(2).rational()
    with pytest.raises(InputError, match="not real"):
        root(-1)
    assert 1 - root(4) == -1
    assert hash(root(4)) == hash(surd(2))
    assert root(2) != "2"


def test_certified_comparisons_take_equality_and_nothing_beyond() -> None:
    half = Fraction(1, 2)
    assert certify.at_most(half, half)
    assert certify.at_most(half - TINY, half)
    assert not certify.at_most(half + TINY, half)
    assert certify.within(Fraction(3, 4), row_error_at_step, R=half)
    assert not certify.within(Fraction(3, 4) + TINY, row_error_at_step, R=half)
    assert certify.attained(Fraction(3, 4), row_error_at_step, R=half)
    for wrong in (Fraction(3, 4) + TINY, Fraction(3, 4) - TINY):
        assert not certify.attained(wrong, row_error_at_step, R=half)
    twice = certify.scaled(Fraction(2), row_error_at_step, R=half)
    assert twice == flint_balls.ball(Fraction(3, 2))
    # equal irrational numbers: undecided at every precision, equal to 360 digits
    assert certify.at_most(lambda: flint_balls.ball(2).sqrt() ** 2, 2)
    assert not certify.at_most(lambda: flint_balls.ball(2).sqrt() ** 2 + flint_balls.ball(Fraction(1, 10**350)), 2)


def test_a_predicate_is_tried_on_enough_instances() -> None:
    assert every.on_every("few", st.just(0), lambda _: True, 60).failures[0].startswith("few: only")
    ten = every.on_every("ten", st.integers(0, 10**6), lambda _: True, 10)
    assert ten.holds
    assert ten.decisions == 10
    failing = every.on_every("odd", st.integers(0, 10**6), lambda k: k < 1000, 200)
    assert failing.failures == ("odd: fails for 1000",)


def test_boxes_are_settled_only_by_their_sign() -> None:
    third = flint_balls.ball(Fraction(1, 3))
    assert prove_positive("line", lambda x: x, {"x": (TINY, 1)}, geometric=("x",)).holds
    assert not prove_positive("line", lambda x: x, {"x": (0, 1)}, most=50).holds
    assert prove_positive("zero", lambda x: 0 * x, {"x": (0, 1)}, weakly=True).holds
    assert "at least 0" in prove_positive("line", lambda x: x - third, {"x": (0, 1)}, weakly=True).failures[0]
    touching = prove_positive("touch", lambda x: (x - third) ** 2, {"x": (0, 1)}, most=7)
    assert "undecided after" in touching.failures[0]
    assert touching.decisions in (7, 8, 9)  # boxes without a violation before the limit are not counted against it
    tiny = Fraction(1, 10**60)
    point = prove_positive("point", lambda x: (1 + x) - 1 - flint_balls.ball(tiny / 2), {"x": (tiny, tiny)})
    assert point.failures == ("point: undecided after 1 boxes, for example x = 1e-60",)
    nowhere = prove_positive("nan", lambda x: flint_balls.ball(-1).sqrt() * x, {"x": (1, 2)}, most=20)
    assert not nowhere.holds
    zero = prove_positive("zero", lambda x: 0 * x, {"x": (1, 1)}, most=5)
    assert zero.failures == ("zero: not positive for x = 1",)
    assert prove_positive("point", lambda x: -x, {"x": (2, 2)}).failures == ("point: not positive for x = 2",)
    assert prove_positive("product", lambda x, y: x * y - 1, {"x": ("11/10", 50), "y": (1, 2)}).decisions < 30


def test_a_violation_in_the_middle_of_a_wide_box_is_found() -> None:
    def dip(x: flint_balls.Ball) -> flint_balls.Ball:
        return (x - 1) * (x - 1) - flint_balls.ball(Fraction(1, 10**6))

    assert "not positive" in prove_positive("dip", dip, {"x": ("1/1000", 1000)}, geometric=("x",)).failures[0]
    assert "not positive" in prove_positive("dip", dip, {"x": (0, 2)}).failures[0]
    assert prove_positive("beside", dip, {"x": (0, "99/100")}).holds


@pytest.mark.parametrize("bits", [53, 96, 300])
def test_precision_is_what_was_asked_for(bits: int) -> None:
    seen = []

    def root_of_two(x: flint_balls.Ball) -> flint_balls.Ball:
        seen.append((x + 1).sqrt().rel_accuracy_bits())
        return x

    assert prove_positive("root", root_of_two, {"x": (1, 1)}, bits=bits).holds
    assert bits - 3 < seen[0] < bits + 3


@given(st.integers(2, 60), st.integers(0, 60), st.sampled_from([Fraction(1, 20), Fraction(1, 4), Fraction(1, 2)]))
def test_coverage_is_judged_at_its_threshold(trials: int, failures: int, claimed: Fraction) -> None:
    seen = Coverage(claimed, trials, min(failures, trials))
    above = 1 - cumulative(trials, seen.threshold, claimed)
    assert above < FALSE_ALARM <= 1 - cumulative(trials, seen.threshold - 1, claimed)
    assert seen.false_alarm == above
    assert seen.passes == (seen.failures <= seen.threshold)
    assert seen.covered == (seen.upper <= claimed)
    if seen.failures < trials:
        assert cumulative(trials, seen.failures, seen.upper - Fraction(1, 2**14)) > FALSE_ALARM
    if seen.failures:
        assert 1 - cumulative(trials, seen.failures - 1, seen.lower + Fraction(1, 2**14)) > FALSE_ALARM
    assert cumulative(trials, trials, claimed) == 1
    assert cumulative(trials, 0, claimed) == (1 - claimed) ** trials
    assert cumulative(trials, 1, claimed) == (1 - claimed) ** trials + comb(trials, 1) * claimed * (1 - claimed) ** (
        trials - 1
    )


def test_simulations_count_their_failures() -> None:
    outcome = simulate("coin", lambda rng: rng.random() < 0.3, Fraction(1, 2), 80, 3)
    expected = sum(rng.random() < 0.3 for rng in np.random.default_rng(3).spawn(80))
    assert outcome.details.startswith("coin: ")
    assert f"{expected} failures in 80 runs" in outcome.details
    assert Coverage(Fraction(1, 10), 200, 0).outcome("never").details.startswith("never: covered")
    assert Coverage(Fraction(1, 10), 40, 3).outcome("few").details.startswith("few: not contradicted")
    assert "fails too often" in Coverage(Fraction(1, 10), 40, 39).outcome("always").failures[0]


FUNCTIONS = {
    "sqrt": (lambda x: SLOPES.sqrt(x), lambda x: 1 / (2 * x.sqrt())),
    "log": (lambda x: SLOPES.log(x), lambda x: 1 / x),
    "log1p": (lambda x: SLOPES.log1p(x), lambda x: 1 / (1 + x)),
    "exp": (lambda x: SLOPES.exp(x), lambda x: x.exp()),
    "expm1": (lambda x: SLOPES.expm1(x), lambda x: x.exp()),
    "cosh": (lambda x: SLOPES.cosh(x), lambda x: x.sinh()),
    "square": (lambda x: x**2, lambda x: 2 * x),
    "cube": (lambda x: x**3, lambda x: 3 * x * x),
    "power": (lambda x: SLOPES.power(x, lifted(Fraction(5, 2))), lambda x: x * x.sqrt() * 5 / 2),
    "tower": (lambda x: 2**x, lambda x: (x * flint_balls.ball(2).log()).exp() * flint_balls.ball(2).log()),
    "sum": (lambda x: 1 + x + 2, lambda x: flint_balls.ball(1)),
    "difference": (lambda x: 5 - x - 1, lambda x: flint_balls.ball(-1)),
    "product": (lambda x: 3 * x * x, lambda x: 6 * x),
    "quotient": (lambda x: 4 / x, lambda x: -4 / x / x),
    "ratio": (lambda x: x / (x + 1), lambda x: 1 / (1 + x) / (1 + x)),
    "negative": (lambda x: -x, lambda x: flint_balls.ball(-1)),
    "minimum": (lambda x: SLOPES.min(x, x + 1, 7), lambda x: flint_balls.ball(1)),
    "maximum": (lambda x: SLOPES.max(3 * x, x, 1), lambda x: flint_balls.ball(3)),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_slopes_are_derivatives(name: str) -> None:
    function, derivative = FUNCTIONS[name]
    x = flint_balls.ball(Fraction(7, 3))
    found = function(Slope(x, (flint_balls.ball(1),)))
    assert len(found.slopes) == 1
    assert abs(found.slopes[0] - derivative(x)) < flint_balls.ball(Fraction(1, 10**12))


def test_what_is_undecided_keeps_every_slope() -> None:
    wide = Slope(flint_balls.box(Fraction(0), Fraction(2)), (flint_balls.ball(1),))
    other = Slope(flint_balls.ball(1), (flint_balls.ball(-5),))
    for chosen in (SLOPES.min(wide, other), SLOPES.max(wide, other)):
        assert sorted(float(slope) for slope in chosen.slopes) == [-5, 1]
    jump = SLOPES.if_at_most(wide, 1, lambda: 2, lambda: 3)
    assert not jump.slopes[0].is_finite()
    assert jump.value.contains(2)
    assert jump.value.contains(3)
    assert float(SLOPES.if_at_most(1, 1, lambda: 2, lambda: 3).value) == 2
    assert float(SLOPES.if_at_most(2, 1, lambda: 2, lambda: 3).value) == 3
    assert not SLOPES.ceil(wide).slopes[0].is_finite()
    assert [float(slope) for slope in SLOPES.ceil(Fraction(5, 2)).slopes] == [0]
    assert float(SLOPES.ceil(Fraction(5, 2)).value) == 3
    many = Slope(flint_balls.ball(1), [flint_balls.ball(k) for k in range(9)])
    assert len(many.slopes) == 1
    assert many.slopes[0].contains(0)
    assert many.slopes[0].contains(8)
    assert len(Slope(flint_balls.ball(1), [flint_balls.ball(k) for k in range(8)]).slopes) == 8


def test_a_direction_is_proved_only_where_it_holds() -> None:
    box = {"R": ("1/10", "9/10"), "H": (1, 20)}
    assert prove_monotone(row_error_summed, "R", {"R": ("1/10", "1/2"), "H": (1, 20)}, "rises").holds
    assert prove_monotone(row_error_summed, "H", box, "rises").holds
    assert not prove_monotone(row_error_summed, "H", box, "falls").holds
    assert not prove_monotone(row_error_at_step, "R", {"R": ("1/2", "3/2")}, "rises", most=200).holds


def test_identities_are_not_believed_at_points_alone() -> None:
    x = sympy.Symbol("x", positive=True)
    points = sympy.prod([x - point for point in symbolic._POINTS])
    assert "cannot reduce" in symbolic.identity("zero at all points tried", points, 0).failures[0]
    assert "differ by" in symbolic.identity("sum", x + sympy.Rational(1, 10**20), x).failures[0]
    assert symbolic.identity("hyperbolic", sympy.cosh(2 * x), 2 * sympy.cosh(x) ** 2 - 1).holds
    assert symbolic.identity("constants", sympy.Integer(2), 2).holds
    assert "differ by" in symbolic.identity("complex", sympy.log(x - 9), sympy.log(x - 9) + sympy.I).failures[0]
    assert not symbolic.identity("constants", sympy.Integer(2), 3).holds


def test_laws_and_distances_by_hand() -> None:
    half, third = Fraction(1, 2), Fraction(1, 3)
    kernel = ((((1 - third), third),), ((0, 1),))
    chain = model.Model((Fraction(1), Fraction(0)), model.kernel_of(kernel), 2)
    law = chain.law((0, 0))
    assert law == {(0, 0, 0, 0): 1 - third, (0, 0, 1, 0): third}
    assert sum(chain.law((0, 0), arrival=True).values()) == 1
    assert laws.occupancies(law, 2) == [{(0, 0): 1}, {(0, 0): 1 - third, (1, 0): third}]
    assert laws.probability_of_hitting(law, [1], 2) == third
    assert laws.probability_of_hitting(law, [1], 1) == 0
    p, q = {"a": half, "b": half}, {"a": third, "b": 1 - third}
    assert laws.total_variation(p, q) == Fraction(1, 6)
    assert laws.squared_hellinger(p, q) == 1 - root(Fraction(1, 6)) - root(Fraction(1, 3))
    assert laws.squared_hellinger(p, {"c": Fraction(1)}) == 1
    expected = half * sympy.log(sympy.Rational(3, 2)) + half * sympy.log(sympy.Rational(3, 4))
    assert float(laws.kl_divergence(p, q)) == pytest.approx(float(expected))
    assert list(laws.deterministic_policies(2, 3))[-1] == (2, 2)
    for wrong in (["1/2", "1/3"], ["3/2", "-1/2"]):
        with pytest.raises(InputError, match="no probability vector"):
            model.probability_row(wrong)


def test_outcomes_of_engines_hold_only_with_a_decision() -> None:
    assert not Outcome(0).holds
    assert not prove("vacuous", [reals("x")[0] ** 2 < 0], z3.BoolVal(True)).holds
    assert not isinstance(inf, Surd)
