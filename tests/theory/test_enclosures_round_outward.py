"""An enclosure never lies: ends are rounded outward, undecided branches are enclosed, precision rises by itself."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

from bridge_theory import (
    concentrability_sharp,
    kappa,
    policy_error_stated,
    squared_true_bonus_sum_stated,
    transition_error_repaired,
    xi_bar,
)
from bridge_theory.arithmetic import flint_balls
from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.arithmetic.flint_balls import as_ball, ball, box, ends, working_precision
from bridge_theory.arithmetic.special import log_binomial
from bridge_theory.enclosure import LAST_BITS, Enclosure, enclose
from bridge_theory.rounding import rounded_down, rounded_up

_RATIONALS = st.fractions(min_value=-(10**30), max_value=10**30, max_denominator=10**30)


@given(_RATIONALS)
def test_ends_of_a_rational(value: Fraction) -> None:
    low, high = ends(ball(value))
    assert Fraction(low) <= value <= Fraction(high)
    assert high - low <= 4 * math.ulp(float(value))


@pytest.mark.parametrize("value", [0, 1, -3, Fraction(1, 2), 2**80])
def test_ends_of_a_float_are_that_float(value: int | Fraction) -> None:
    assert ends(ball(value)) == (float(value), float(value))
    assert math.copysign(1, ends(ball(0))[1]) == 1


@pytest.mark.parametrize("sign", [1, -1])
def test_ends_beyond_float64(sign: int) -> None:
    for huge in (ball(10) ** 400 * sign, ball(2) ** 1024 * sign):
        low, high = ends(huge)
        assert (low, high) == ((np.finfo(float).max, math.inf) if sign > 0 else (-math.inf, np.finfo(float).min))
    tiny = ends(ball(10) ** -400 * sign)
    assert tiny == ((0.0, 5e-324) if sign > 0 else (-5e-324, 0.0))


def test_ends_of_nothing_known() -> None:
    assert ends(flint_balls.everything()) == (-math.inf, math.inf)
    assert ends(arb(-1).sqrt()) == (-math.inf, math.inf)


def test_decimal_strings_are_not_binary_floats() -> None:
    as_text = policy_error_stated.enclosure(S=5, A=4, n=1, delta1="0.05")
    as_float = policy_error_stated.enclosure(S=5, A=4, n=1, delta1=0.05)
    with working_precision(200):
        exact = 20 * (ball(4) / ball(Fraction(1, 20))).log()
        assert ball(Fraction(as_text.lower)) <= exact <= ball(Fraction(as_text.upper))
    assert Fraction(0.05) != Fraction(1, 20)
    assert as_float.lower <= as_text.upper


@given(st.integers(1, 10**6), st.integers(1, 10**6))
def test_undecided_branches_enclose_both(p: int, q: int) -> None:
    low, high = sorted((Fraction(p, 7), Fraction(q, 7)))
    wide = box(low, high)
    assert as_ball(BALLS.min(wide, 3)).contains(as_ball(BALLS.min(ball(low), 3)))
    assert as_ball(BALLS.max(wide, 3)).contains(as_ball(BALLS.max(ball(high), 3)))
    assert as_ball(BALLS.ceil(wide)).contains(ball(math.ceil(low)))
    assert as_ball(BALLS.ceil(wide)).contains(ball(math.ceil(high)))
    middle = ball((low + high) / 2)
    chosen = BALLS.if_at_most(wide, middle, lambda: ball(-1), lambda: ball(1))
    assert chosen.contains(-1)
    assert low == high or chosen.contains(1)


def test_decided_branches_do_not_evaluate_the_other() -> None:
    assert BALLS.if_at_most(ball(1), ball(2), lambda: "then", lambda: 1 / 0) == "then"
    assert BALLS.if_at_most(ball(3), ball(2), lambda: 1 / 0, lambda: "otherwise") == "otherwise"


def test_branch_of_the_concentrability_bound_is_continuous() -> None:
    at_the_seam = concentrability_sharp.enclosure(R=Fraction(1, 2), gamma_min=Fraction(1, 4))
    assert 4 in at_the_seam
    assert at_the_seam.narrow


def test_precision_rises_until_the_ends_are_neighbours() -> None:
    # cosh(BW) - 1 of a tiny BW cancels 400 bits
    def cancelling() -> arb:
        return ball(Fraction(1, 2**200)).cosh() - 1

    result = enclose(cancelling)
    assert result.narrow
    assert result.bits > 96
    assert result.lower <= 2.0**-401 <= result.upper
    assert kappa.enclosure(B=1, W=1).bits == 96


def test_precision_says_when_it_cannot() -> None:
    result = enclose(lambda: ball(2).sqrt() ** 2 - 2)
    assert not result.narrow
    assert result.bits == LAST_BITS
    assert 0 in result
    assert "still wide" in str(result)


def test_enclosure_arithmetic() -> None:
    enclosure = Enclosure(1.0, 1.5, bits=96, narrow=True)
    assert enclosure.width >= 0.5
    assert enclosure.middle == 1.25
    assert Enclosure(2.0, 2.0, bits=96, narrow=True).width == 0
    assert math.isnan(Enclosure(-math.inf, math.inf, bits=96, narrow=False).middle)


def _minimum(objective: object, near: float) -> arb:
    return BALLS.minimum_over_integers(objective, lambda k: objective(k + 1) - objective(k), lambda: np.float64(near))


@pytest.mark.parametrize("near", [1.0, 3.2, 40.0])
def test_minimum_over_integers_from_any_start(near: float) -> None:
    assert _minimum(lambda k: k + ball(30) / k, near).contains(11)  # attained at 5 and at 6: a tie
    assert _minimum(lambda k: k * k, near).contains(1)  # attained at the left end


def test_minimum_over_integers_withholds_what_it_cannot_certify() -> None:
    assert not _minimum(lambda k: ball(1), 5.0).is_finite()  # flat: no neighbour is worse


@pytest.mark.parametrize("near", [1.0, 5.0, 1e9, math.nan, math.inf])
def test_minimum_over_integers_far_from_its_start(near: float) -> None:
    assert _minimum(lambda k: (k - 10**6) ** 2, near) == 0


def test_minimum_of_a_flat_cover_needs_more_bits() -> None:
    result = transition_error_repaired.enclosure(S=5, H=8, n=10**15, delta="0.05", rows=5)
    assert result.narrow
    assert result.bits > 96


@given(st.integers(0, 400), st.integers(0, 400))
def test_float_log_binomial(n: int, k: int) -> None:
    top, bottom = max(n, k), min(n, k)
    assert log_binomial(np.float64(top), np.float64(bottom)) == pytest.approx(
        math.log(math.comb(top, bottom)), rel=4e-15, abs=1e-15
    )


def test_float_log_binomial_broadcasts_over_both_regimes() -> None:
    values = log_binomial(np.array([10.0, 1e12]), np.array([[3.0], [5.0]]))
    exact = [[math.log(math.comb(n, k)) for n in (10, 10**12)] for k in (3, 5)]
    np.testing.assert_allclose(values, exact, rtol=1e-14)
    mixed = log_binomial(np.array([10.0, 1000.0]), np.array([3.0, 500.0]))
    np.testing.assert_allclose(mixed, [math.log(120), math.log(math.comb(1000, 500))], rtol=1e-14)


@pytest.mark.parametrize("bottom", [3, 600])
def test_ball_log_binomial_in_both_regimes(bottom: int) -> None:
    with working_precision(200):
        exact = ball(math.comb(2000, bottom)).log()
        assert BALLS.log_binomial(ball(2000), ball(bottom)).overlaps(exact)
        assert BALLS.log_binomial(ball(2000), ball(bottom)).rel_accuracy_bits() > 150


def test_ball_log_binomial_of_a_fraction() -> None:
    half = BALLS.log_binomial(ball(3), ball(Fraction(3, 2)))
    assert half.overlaps((ball(32) / (3 * flint_balls.pi_ball())).log())


def test_ceilings_of_exact_rationals_are_exact() -> None:
    # 4 eta H / epsilon is the integer 320, which no ball around 1/10 tells from its neighbours
    point = {"S": 5, "A": 4, "H": 8, "eta": 1, "delta": "0.05", "epsilon": "0.1"}
    uniform = xi_bar.enclosure(N=1000, **point)
    assert uniform.narrow
    assert 0.97593 < uniform.lower <= uniform.upper < 0.97594
    assert squared_true_bonus_sum_stated.enclosure(
        n=1000, t=100, T=100, gamma_min="0.1", S_reach=5, delta_martingale="0.05", **point
    ).narrow
    assert BALLS.ceil(ball(Fraction(7, 2))) == 4


@given(st.fractions(min_value=Fraction(1, 10**9)), st.integers(-420, 420))
def test_six_digits_lie_on_the_safe_side(size: Fraction, exponent: int) -> None:
    value = size * Fraction(10) ** exponent
    below, above = Fraction(rounded_down(value)), Fraction(rounded_up(value))
    assert below <= value <= above
    assert above - below <= value / 10**5 * Fraction(11, 10)


def test_six_digits_of_numbers_that_float64_does_not_hold() -> None:
    assert rounded_down(3 * 2.0**-1074) == "1.48219e-323"  # a float near this decimal lies above the value
    assert (rounded_up(Fraction(1, 10**400)), rounded_down(Fraction(-1, 10**400))) == ("1e-400", "-1e-400")
    assert rounded_down(Fraction(10**400 + 1)) == "1e+400"
