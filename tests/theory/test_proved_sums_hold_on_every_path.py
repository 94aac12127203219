"""Pathwise repaired bounds hold on generated paths, the hard ones included, and fail when their content is removed."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bridge_theory import (
    bonus_radius,
    bonus_sum_repaired,
    coverage_failure,
    delta_n_known_deterministic,
    delta_n_version_space,
    delta_n_version_space_sharp,
    elliptical_norm_sum,
    elliptical_potential,
    elliptical_potential_capped,
    offline_radius_known,
    radius_sum,
    radius_sum_covered,
    regret_known_deterministic,
    regret_known_repaired,
    regret_offline,
    squared_bonus_sum_repaired,
)

seeds = st.integers(0, 2**32 - 1)


def visits_by_round(rng: np.random.Generator, rounds: int, batch: int, cells: int) -> np.ndarray:
    """How often each cell is used in each round; half of the paths concentrate on few cells, the worst case."""
    weights = rng.dirichlet(np.full(cells, 0.05 if rng.random() < 0.5 else 5.0))
    return rng.multinomial(batch, weights, size=rounds)


def sum_over_path(per_cell: np.ndarray, visits: np.ndarray) -> float:
    return float((per_cell * visits).sum())


def frozen_counts(visits: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Counts of each cell at the start of each round."""
    return before + np.cumsum(visits, axis=0) - visits


@given(seed=seeds, d=st.integers(1, 4), T=st.integers(1, 40), v=st.sampled_from([0.25, 1.0, 8.0]))
def test_elliptical_potential_bounds_every_sequence(seed: int, d: int, T: int, v: float) -> None:
    rng = np.random.default_rng(seed)
    vectors = rng.normal(size=(T, d)) * rng.uniform(0, 3)
    if rng.random() < 0.5:
        vectors[:, 1:] = 0  # one direction only: the determinant grows slowest
    squares = np.zeros(T)
    matrix = v * np.eye(d)
    for t, x in enumerate(vectors):
        squares[t] = x @ np.linalg.solve(matrix, x)
        matrix += np.outer(x, x)
    norms = (vectors**2).sum(axis=1)
    L = math.nextafter(math.sqrt(norms.max()), math.inf)
    point = {"v": v, "d": d, "square_sum": math.nextafter(float(norms.sum()), math.inf)}
    slack = 1 + 1e-9
    assert squares.sum() <= slack * elliptical_potential.enclosure(L=L, **point).upper
    assert np.minimum(squares, 1).sum() <= slack * elliptical_potential_capped.enclosure(**point).upper
    assert np.sqrt(squares).sum() <= slack * elliptical_norm_sum.enclosure(L=L, T=T, **point).upper


@given(seed=seeds, H=st.integers(2, 6), T=st.integers(1, 120), K=st.integers(1, 4), n=st.integers(1, 20))
def test_l1_radii_on_every_path_sum_to_at_most_the_bracket(seed: int, H: int, T: int, K: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    S, A = 2, 2
    visits = visits_by_round(rng, T, 2 * K * (H - 1), S * A)
    before = rng.multinomial(n * (H - 1), rng.dirichlet(np.full(S * A, 0.3)))
    radii = bonus_radius.estimate(S=S, A=A, delta_P=0.05, N=frozen_counts(visits, before))
    point = {"S": S, "A": A, "H": H, "n": n, "T": T, "K": K, "delta_P": "0.05", "delta_M": "0.05"}
    terms = radius_sum.value(**point).terms
    bracket = (terms["first_visits"].upper + terms["later_visits"].upper) * (1 - math.exp(-1))
    # the bound is for the average over the K comparisons of a round
    assert sum_over_path(radii, visits) / K <= bracket * (1 + 1e-12)


@given(seed=seeds, H=st.integers(2, 6), T=st.integers(1, 120), n=st.integers(1, 400), uncovered=st.integers(0, 2))
def test_bonuses_on_every_covered_path_sum_to_at_most_the_repaired_sums(
    seed: int, H: int, T: int, n: int, uncovered: int
) -> None:
    rng = np.random.default_rng(seed)
    eta, log_term, gamma_min, reach = 1.0, 4.0, 0.25, 3
    visits = visits_by_round(rng, T, 2 * (H - 1), reach + uncovered)
    before = np.concatenate([np.full(reach, math.ceil(n * gamma_min / 2)), np.zeros(uncovered, dtype=int)])
    counts = np.maximum(frozen_counts(visits, before), 1e-300)
    xi = np.minimum(2 * eta, 4 * eta * np.sqrt(log_term / counts))
    point = {
        "H": H, "eta": 1, "log_covering": 4, "n": n, "T": T, "gamma_min": gamma_min, "S_reach": reach,
        "uncovered": uncovered,
    }  # fmt: skip
    assert sum_over_path(xi, visits) <= bonus_sum_repaired.enclosure(**point).upper
    assert sum_over_path(xi**2, visits) <= squared_bonus_sum_repaired.enclosure(**point).upper


def test_the_first_visits_of_a_round_are_not_free() -> None:
    # one cell without data, counts frozen within the first round: without its own term the bound would be violated
    H, T = 40, 1
    point = {"H": H, "eta": 1, "log_covering": 1, "n": 10**9, "T": T, "gamma_min": 1, "S_reach": 1, "uncovered": 1}
    bound = squared_bonus_sum_repaired.value(**point)
    played = 4 * 2 * (H - 1)
    logarithmic = 32 * math.log(1 + 2 * (H - 1))
    assert logarithmic < played <= bound.enclosure.lower


@pytest.mark.parametrize(("n", "gamma"), [(1, "1"), (7, "0.5"), (30, "0.1"), (60, "0.3"), (200, "0.05")])
def test_coverage_failure_exceeds_the_exact_binomial_probability(n: int, gamma: str) -> None:
    p = Fraction(gamma)
    exact = sum((math.comb(n, k) * p**k * (1 - p) ** (n - k) for k in range(n + 1) if 2 * k < n * p), start=Fraction(0))
    assert exact <= Fraction(coverage_failure.enclosure(S_reach=1, n=n, gamma_min=gamma).lower)


@given(
    S=st.integers(1, 30), A=st.integers(2, 9), n=st.integers(1, 10**6), k=st.integers(1, 99), T=st.integers(1, 10**6)
)
def test_offline_gains_are_consistent_with_one_another(S: int, A: int, n: int, k: int, T: int) -> None:
    chance = Fraction(k, 100)
    sharp = delta_n_version_space_sharp.enclosure(S=S, n=n, delta_off=chance)
    assert sharp.lower <= delta_n_version_space.enclosure(S=S, A=A, n=n, delta_off=chance).upper
    radius = offline_radius_known.enclosure(S=S, A=A, n=n, delta=chance)
    spread = delta_n_known_deterministic.enclosure(radius=radius.upper).upper
    direct = regret_known_deterministic.enclosure(B=1, W=1, S=S, A=A, n=n, T=T, delta_off=chance)
    assert direct.lower <= regret_offline.enclosure(B=1, W=1, T=T, Delta_n=spread).upper <= direct.upper * (1 + 1e-12)


def test_coverage_helps_only_when_there_is_data() -> None:
    point = {"S": 5, "A": 4, "H": 8, "T": 1000, "K": 1, "delta_P": "0.01", "delta_M": "0.01"}
    covered = {"gamma_min": "0.1", "S_reach": 5, "Delta_n": 0}
    few, many = (radius_sum_covered.value(n=n, **covered, **point) for n in (10, 10**7))
    assert (few.dominant, many.dominant) == ("online", "offline")
    assert few.enclosure == radius_sum.enclosure(n=10, **point)
    # the failure probability contains the coverage event: vacuous at n = 10, negligible at n = 10^7
    assert few.failure is not None
    assert many.failure is not None
    assert few.failure.lower > 1
    assert many.failure.upper < 0.020001


def test_a_horizon_of_one_has_no_transitions_to_pay_for() -> None:
    point = {"S": 5, "A": 4, "H": 1, "n": 10, "T": 100, "K": 1, "delta_P": "0.05", "delta_M": "0.05"}
    enclosure = radius_sum.enclosure(**point)
    assert (enclosure.lower, enclosure.upper) == (0, 0)


def test_knowing_nothing_leaves_the_trivial_bound() -> None:
    point = {"B": 1, "W": 0.5, "lam": 1, "d": 3, "T": 100, "K": 1, "delta_w": "0.05", "delta_F": "0.05"}
    value = regret_known_repaired.value(diameter=2, Delta_n=1, **point)
    assert value.vacuous
    assert value.enclosure.upper == 100
