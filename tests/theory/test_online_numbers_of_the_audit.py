"""The audit's numbers for the online and regret parts, reproduced with certificates where they are bounds."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from bridge_theory import (
    alpha_dT,
    beta_repaired,
    beta_t,
    bonus_radius,
    bridge_regret_rate,
    elliptical_floor,
    elliptical_norm_sum,
    elliptical_potential,
    feature_difference_sum,
    gamma_known,
    gamma_true_bonus,
    kappa,
    kappa_differences,
    main_simplified_rate,
    matrix_shift,
    norm_relation,
    norm_relation_sharp,
    potential_factor,
    regret_known_apriori,
    regret_known_deterministic,
    regret_known_log,
    regret_known_stated,
    regret_trivial,
    regret_unknown_squared,
    regret_unknown_stated,
    squared_bonus_rate,
    squared_true_bonus_sum_stated,
    xi,
)
from bridge_theory.bound import Bound

positive = st.integers(1, 4 * 2**10).map(lambda k: Fraction(k, 2**10))
chance = st.integers(1, 99).map(lambda k: Fraction(k, 100))


def certified_at_most(bound: Bound, limit: float, **point: object) -> bool:
    return bound.enclosure(**point).upper <= limit  # type: ignore[arg-type]


def certified_above(bound: Bound, limit: float, **point: object) -> bool:
    return bound.enclosure(**point).lower > limit  # type: ignore[arg-type]


def test_the_lemma_with_its_square_promises_no_more_than_its_parts() -> None:
    """Audit C.12: of the five events two cost delta (1 + log2 T) together; none of this is proved."""
    point = {"B": 1, "W": 1, "lam": 1, "d": 1, "T": 1024, "delta": "0.01"}
    part = gamma_known.value(**point, t=1024).failure
    whole = regret_unknown_squared.value(**point, bonus_square_sum=0, potential=1, bonus_sum=0)
    assert part is not None
    assert whole.failure is not None
    assert part.upper == pytest.approx(0.11)
    assert whole.failure.upper == pytest.approx(0.14)
    # 1 - 0.14, rounded down: no ball tells log2(1024) from its neighbours
    assert "with probability at least 0.859999, " in whole.words
    assert regret_unknown_squared.status == "stated"


def test_the_stated_multiplier_promises_no_more_than_the_lemma_that_uses_it() -> None:
    point = {"B": 1, "W": 1, "lam": 1, "d": 1, "H": 2, "T": 9, "delta": "0.01", "epsilon": 1, "bonus_square_sum": 0}
    part, whole = gamma_true_bonus.value(**point), regret_unknown_stated.value(**point, norm_sum=1, bonus_sum=0)
    assert part.failure is not None
    assert whole.failure is not None
    assert part.failure.exact == whole.failure.exact == Fraction(5, 100)


def test_kappa_is_the_largest_inverse_slope_of_the_sigmoid() -> None:
    x = sympy.Symbol("x", positive=True)
    sigma = 1 / (1 + sympy.exp(-x))
    assert sympy.simplify((1 / sympy.diff(sigma, x) - (2 + 2 * sympy.cosh(x))).rewrite(sympy.exp)) == 0
    assert kappa.expression(B=1, W=1) == 2 + 2 * sympy.cosh(1)
    assert kappa_differences.expression(B=1, W=1) == 2 + 2 * sympy.cosh(2)


def test_kappa_is_too_small_for_feature_differences() -> None:
    # at B = W = 1 a difference of norm 2 has inverse slope 9.524 against the stated 5.086
    assert round(kappa_differences.enclosure(B=1, W=1).lower, 3) == 9.524
    assert round(kappa.enclosure(B=1, W=1).upper, 3) == 5.086
    ratio = kappa_differences.enclosure(B=5, W=1).middle / kappa.enclosure(B=5, W=1).middle
    assert ratio == pytest.approx((math.cosh(5) / math.cosh(2.5)) ** 2)
    assert round(ratio) == 146


@given(B=positive, W=positive)
def test_kappa_squared_exceeds_the_repaired_kappa_by_four_plus_eight_cosh(B: Fraction, W: Fraction) -> None:
    small, large = kappa.enclosure(B=B, W=W), kappa_differences.enclosure(B=B, W=W)
    assert small.middle**2 - large.middle == pytest.approx(4 + 8 * math.cosh(B * W), rel=1e-9)


@given(B=positive, W=positive, lam=positive, d=st.integers(1, 40), t=st.integers(1, 10**9), delta=chance)
def test_the_stated_width_is_at_least_root_two_times_the_proved_one(
    B: Fraction, W: Fraction, lam: Fraction, d: int, t: int, delta: Fraction
) -> None:
    stated = beta_t.enclosure(B=B, W=W, lam=lam, d=d, t=t, delta=delta)
    proved = beta_repaired.enclosure(B=B, W=W, lam=lam, d=d, t=t, K=1, delta_w=delta)
    assert stated.upper >= math.nextafter(math.sqrt(2), 0) * proved.lower
    assert stated.lower >= 1.4142 * proved.upper


def test_the_width_ratio_tends_to_two_root_two_and_grows_with_kappa() -> None:
    point = {"B": 1, "W": 1, "lam": 1, "d": 3}
    far = beta_t.enclosure(t=10**20_000, delta="0.05", **point).middle
    far /= beta_repaired.enclosure(t=10**20_000, K=1, delta_w="0.05", **point).middle
    assert far == pytest.approx(2 * math.sqrt(2), rel=0.01)
    heavy = {"B": 4, "W": 2, "lam": 10**16, "d": 1, "t": 1}
    ratio = beta_t.enclosure(delta="0.05", **heavy).middle
    ratio /= beta_repaired.enclosure(K=1, delta_w="0.05", **heavy).middle
    assert ratio == pytest.approx(math.sqrt(kappa_differences.enclosure(B=4, W=2).middle), rel=1e-3)


def test_u_is_at_most_twice_log_exactly_up_to_2_51286() -> None:
    assert certified_at_most(potential_factor, math.nextafter(2, 0), L=1, v=1 / Fraction("2.512862417"))
    assert certified_above(potential_factor, 2, L=1, v=1 / Fraction("2.512862418"))
    root = sympy.N(-1 - 2 * sympy.LambertW(-sympy.exp(-sympy.Rational(1, 2)) / 2, -1), 15)
    assert 2.512862417 < root < 2.512862418
    assert certified_at_most(potential_factor, 1.4427, L=1, v=1)
    # the paper's inequality for all u >= 1 fails at u = 10
    assert 2 * math.log(11) < 10


def test_the_potential_is_attained_and_the_stated_factor_two_is_not_enough() -> None:
    # T = 1, d = 1, kappa lam = 10, ||D|| = 20: the sum is 40 exactly, twice the logarithm is 7.4
    enclosure = elliptical_potential.enclosure(L=20, v=10, d=1, square_sum=400)
    assert 40 in enclosure
    assert enclosure.width < 1e-13
    assert 2 * math.log(41) < 40


def test_a_deterministic_run_exceeds_the_stated_feature_sum_and_theorem() -> None:
    # one state, two actions with features +-1/2, both always playable: D_t = 1 and kappa lam = 1 in every round
    lam = float(1 / kappa.estimate(B=0.5, W=1))
    point = {"B": 0.5, "lam": lam, "d": 1, "S": 1, "A": 2, "n": 22, "delta": "0.05"}
    for T, stated, regret in ((4_000, 408.81, 2_000), (10_000, 443.75, 5_000)):
        assert certified_at_most(regret_known_stated, stated, T=T, W=1, **point)
        assert regret > stated
        norms = math.fsum(1 / math.sqrt(t) for t in range(1, T + 1))
        assert certified_at_most(feature_difference_sum, 5.05, T=T, **point)
        assert norms > 100
        assert certified_above(elliptical_norm_sum, norms, L=1, v=1, d=1, T=T, square_sum=T)
        proved = {"B": 0.5, "W": 1, "lam": lam, "d": 1, "K": 1, "delta_w": "0.025", "delta_F": "0.025"}
        assert certified_above(regret_known_apriori, regret, T=T, **proved)
    assert round(math.fsum(1 / math.sqrt(t) for t in range(1, 10_001)), 1) == 198.5
    assert regret_known_stated.enclosure(T=10_000, W=1, **point).middle == pytest.approx(443.7, abs=0.05)


@pytest.mark.parametrize(("d", "decades"), [(1, "4.65"), (3, "5.40"), (20, "6.95")])
def test_the_a_priori_bound_starts_to_say_something_where_the_audit_found_it(d: int, decades: str) -> None:
    # the audit's 4.5e4, 2.5e5, 8.9e6 are points of a grid of ratio 10^0.05 at BW = 1/2, delta_w = delta_F = 0.025
    point = {"B": 1, "W": 0.5, "d": d, "K": 1, "delta_w": 0.025, "delta_F": 0.025}
    first, before = round(10 ** float(decades)), math.floor(10 ** (float(decades) - 0.05))
    lams = np.geomspace(0.05, 5_000, 2_000)
    best = float(lams[np.argmin(regret_known_apriori.estimate(lam=lams, T=first, **point))])
    trivial = regret_trivial.enclosure(B=1, W=0.5, T=first).lower
    assert certified_at_most(regret_known_apriori, trivial, lam=best, T=first, **point)
    assert np.all(regret_known_apriori.estimate(lam=lams, T=before, **point) > before)


def test_at_lam_one_the_a_priori_bound_needs_even_longer() -> None:
    for d, first in ((1, 8 * 10**4), (3, 48 * 10**4), (20, 2 * 10**7)):
        point = {"B": 1, "W": 0.5, "lam": 1, "d": d, "K": 1, "delta_w": "0.025", "delta_F": "0.025"}
        assert certified_at_most(regret_known_apriori, first, T=first, **point)
        assert certified_above(regret_known_apriori, first * 3 // 4, T=first * 3 // 4, **point)


def test_the_constants_of_the_norm_relation() -> None:
    # 2 sqrt(27) = 10.4 and 2 sqrt(84) = 18.3 <= 20
    point = {"B": 1, "W": 1, "d": 1, "T": 10}
    shift = matrix_shift.enclosure(B=1, d=1, T=10, delta="0.05").upper
    assert certified_above(alpha_dT, 2 * math.sqrt(shift), delta="0.05", **point)
    sampling = norm_relation.value(lam=1, t=1, delta_w="0.05", delta_V="0.05", **point).terms["sampling"]
    assert sampling.middle / math.sqrt(math.log(21 / 0.05)) == pytest.approx(10.392, abs=1e-3)


@given(B=positive, W=positive, lam=positive, d=st.integers(1, 30), T=st.integers(1, 10**6), dw=chance, dv=chance)
def test_rounding_the_constants_of_the_norm_relation_only_loosens_it(
    B: Fraction, W: Fraction, lam: Fraction, d: int, T: int, dw: Fraction, dv: Fraction
) -> None:
    point = {"B": B, "W": W, "lam": lam, "d": d, "t": T, "T": T, "delta_w": dw, "delta_V": dv}
    assert norm_relation_sharp.enclosure(**point).upper <= norm_relation.enclosure(**point).lower


def test_the_floor_of_the_offline_enhanced_bound_has_constant_3_33() -> None:
    small = elliptical_floor.value(W=1, d=1, T=1, gamma=10, diameter=1).terms["small_diameter"]
    assert small.lower > 3.3
    assert small.middle == pytest.approx(3.3302, abs=1e-4)


@given(
    B=positive, W=positive, lam=positive, d=st.integers(1, 30), T=st.integers(1, 10**8), delta=chance,
    diameter=st.integers(0, 2**12).map(lambda k: Fraction(k, 2**9)),
)  # fmt: skip
def test_offline_data_gain_only_inside_the_logarithm(
    B: Fraction, W: Fraction, lam: Fraction, d: int, T: int, delta: Fraction, diameter: Fraction
) -> None:
    point = {"B": B, "W": W, "lam": lam, "d": d, "T": T, "delta_w": delta, "delta_V": delta}
    multiplier = norm_relation.enclosure(t=T, **point)
    floor = elliptical_floor.enclosure(W=W, d=d, T=T, gamma=multiplier.lower, diameter=diameter)
    assert floor.lower <= regret_known_log.enclosure(diameter=diameter, **point).upper


def test_the_l1_bonus_is_several_times_smaller_than_the_stated_one() -> None:
    for S, A, H, N in ((5, 4, 8, 1_000), (5, 4, 8, 10_000), (16, 5, 10, 10_000), (16, 5, 10, 100_000)):
        stated = xi.enclosure(S=S, A=A, H=H, eta=1, delta=Fraction(1, 20) / (2 * A**S), N=N)
        proved = bonus_radius.enclosure(S=S, A=A, delta_P="0.05", N=N)
        assert 2.5 < stated.middle / proved.middle < 6.6


def test_the_first_term_of_the_simplified_theorem_is_the_trivial_rate_when_n_exceeds_t() -> None:
    n, T = np.meshgrid(np.geomspace(1, 1e9, 40).round(), np.geomspace(1, 1e9, 40).round())
    covered = n >= T
    first = main_simplified_rate.estimate(n=n, T=T, gamma_min=1) - np.sqrt(T / n)
    ratio = first[covered] / (T / np.sqrt(n))[covered]
    assert ratio.min() >= 0.8325
    assert ratio.max() <= 1


def test_the_appendix_theorem_does_not_imply_the_simplified_one() -> None:
    point = {"T": 1000, "gamma_min": 0.1}
    rest = {"B": 1, "W": 1, "d": 1, "S": 5, "A": 4, "H": 8}
    ratios = [
        float(bridge_regret_rate.estimate(n=n, **point, **rest) / main_simplified_rate.estimate(n=n, **point))
        for n in (1e15, 1e18)
    ]
    assert ratios[1] / ratios[0] == pytest.approx(10**0.75, rel=0.02)


def test_the_squared_bonus_lemma_does_not_give_its_asymptotic_form() -> None:
    point = {"S": 5, "H": 8, "eta": 1, "n": 10**12, "T": 1000, "gamma_min": 0.1}
    detailed = squared_true_bonus_sum_stated.enclosure(
        A=4, epsilon=1, t=1000, S_reach=5, delta="0.05", delta_martingale="0.05", **point
    )
    assert detailed.lower / float(squared_bonus_rate.estimate(**point)) > 1e8


def test_regret_twenty_four_b_w_t_s_over_n() -> None:
    enclosure = regret_known_deterministic.enclosure(B=1, W="0.5", S=5, A=4, n=10**6, T=1000, delta_off="0.05")
    assert enclosure.middle == pytest.approx(24 * 0.5 * 1000 * 5 * math.log(80) / 10**6)
