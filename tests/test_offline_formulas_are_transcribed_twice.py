"""Each offline formula equals its display, transcribed a second time by hand, at points where no two factors agree."""

from __future__ import annotations

from math import acos, asin, ceil, comb, exp, expm1, inf, log, pi, sin, sqrt
from typing import Any

import pytest

from bridge_theory.catalog import FORMULAS

S, A, H, n, delta, gamma = 5, 3, 7, 1100, 0.0625, 0.15
B, d, R, R1, R2, eps = 1.5, 3, 0.07, 0.11, 0.013, 0.03
rows, log_N, size, chi2 = 4, 21.5, 77, 0.4


def binomials(counts: list[int], categories: int) -> float:
    return sum(log(comb(N + categories - 1, categories - 1)) for N in counts)


def radius(first: float, second: float) -> float:
    return sqrt(first) + sqrt(second) * (1 + sqrt(H * (1 + 2 * sqrt(first) / gamma)))


def lattice(epsilon: float) -> float:
    m = ceil((S - 1) / expm1(epsilon))
    return rows * log(comb(m + 2 * S - 2, S - 1))


def infimum(share: float) -> float:
    best = min(2 * rows / n * log(comb(k + 2 * S - 2, S - 1)) + 2 * H * log(1 + (S - 1) / k) for k in range(1, 60 * n))
    return best + 2 * log(1 / share) / n


def worst_ratio(r: float, g: float) -> float:
    return 1 / g if g >= (1 - r) ** 2 else (1 - r + sqrt(r * (2 - r) * (1 - g) / g)) ** 2


def stated_infimum() -> float:
    D = S * A * (S - 1)
    best = inf
    for i in range(1, 20000):
        e = i * 1e-5 * 8
        best = min(best, 6 * (log(2) + D * log(H / e + 1) + log(1 / delta)) / n + e)
    return best


def angle(first: float, second: float) -> float:
    return sin(min(pi / 2, asin(sqrt(min(1, first))) + acos(1 - min(1, second))))


alpha, beta = sqrt(4 * S * log(2 * A / delta)), sqrt(4 * S**2 * A * log(2 * n * H / delta))
tail = 1 - (delta / (2**S - 1)) ** (1 / n)
half_tail = 1 - (delta / 2 / (2**S - 1)) ** (1 / n)
visits, rates, errors, hats = [9, 4, 0, 2], [0.9, 0.4, 0.7], [0.11, 0.05, 0.3], [0.8, 0.6, 0.2]
t = sqrt(R * (2 - R))
D = rows * (S - 1)

# name -> values by hand, beside the parameters that differ from POINT
BY_HAND: dict[str, list[tuple[dict[str, Any], float]]] = {
    "alpha_offline": [({}, alpha)],
    "beta_offline": [({}, beta)],
    "offline_radius": [({}, alpha / sqrt(n) + beta / sqrt(n) * (1 + sqrt(H * (1 + 2 * alpha / (gamma * sqrt(n))))))],
    "offline_radius_appendix": [({}, radius(alpha**2 / n, beta**2 / n))],
    "offline_radius_corollaries": [({}, radius(1.5 * alpha**2 / n, 1.5 * beta**2 / n))],
    "offline_radius_known": [({}, sqrt(6 * S * log(A / delta) / n))],
    "offline_radius_closed": [({}, 0.0)],
    "offline_radius_mass": [({"mass": 0.09}, 0.3)],
    "offline_radius_repaired": [({}, sqrt((S * log(2) + log(2 / delta)) / n) + sqrt(2 * infimum(delta / 2)))],
    "offline_radius_repaired_angle": [({}, angle(half_tail, infimum(delta / 2)))],
    "offline_radius_stochastic": [
        ({"n": 30}, sqrt(1 - exp(-(binomials(visits, A) + log(1 / delta)) / 60))),
    ],
    "concentrability_stated": [({}, 1 + 2 * sqrt(R) / gamma)],
    "concentrability_deterministic": [({}, 1 + R / gamma)],
    "concentrability_sharp": [
        ({}, worst_ratio(R, gamma)),
        ({"gamma_min": 0.9}, 1 / 0.9),
        ({"R": 0.3, "gamma_min": 0.6}, 1 / 0.6),
        ({"R": 0.3, "gamma_min": 0.02}, worst_ratio(0.3, 0.02)),
    ],
    "confidence_set_radius": [({}, radius(R1, R2))],
    "confidence_set_radius_repaired": [({}, sqrt(R1) + 2 * sqrt(R2))],
    "confidence_set_radius_deterministic": [({}, sqrt(R1) + sqrt(2 * R2))],
    "confidence_set_radius_angle": [
        ({}, angle(R1, R2)),
        ({"R1": 0.6, "R2": 0.55}, 1.0),
        ({"R1": 1.7, "R2": 0.1}, 1.0),
        ({"R1": 0.1, "R2": 1.7}, 1.0),
    ],
    "mean_difference_stated": [({}, 2 * sqrt(2) * B * sqrt(d * R))],
    "mean_difference_sharp": [({}, 2 * B * t)],
    "covariance_difference_stated": [({}, 6 * d * B**2 * sqrt(2 * R))],
    "covariance_difference_sharp": [({}, 4 * B**2 * t * (1 - t)), ({"R": 0.4}, B**2)],
    "feature_difference_stated": [({}, 4 * sqrt(2) * B / sqrt(n))],
    "feature_difference_squared_stated": [({}, 192 * B**2 * S * log(A / delta) / n)],
    "feature_difference_repaired": [
        ({"radius": 0.3}, 2 * B * sin(2 * acos(1 - 0.09))),
        ({"radius": 0.7}, 2 * B),
        ({"radius": 1.2}, 2 * B),
    ],
    "feature_difference_deterministic": [({"radius": 0.3}, 4 * B * 0.09), ({"radius": 0.8}, 2 * B)],
    "hellinger_from_kl": [({"kl": 0.7}, 1 - exp(-0.35))],
    "hellinger_from_kl_with_exits": [
        ({"kl": 0.7, "exit_mass": 0.2}, 1 - 0.8 * exp(-(0.7 + 0.2 * log(5)) / 1.6)),
        ({"kl": 0.7, "exit_mass": 0}, 1 - exp(-0.35)),
    ],
    "missing_mass_expected": [({"n": 6}, S * 6**6 / 7**7)],
    "missing_mass_good_turing": [({"singletons": 13}, 13 / n + (2 * sqrt(2) + sqrt(3)) * sqrt(log(3 / delta) / n))],
    "missing_mass_observed": [
        ({"n": 20, "unvisited": 2}, 1 - (delta / (S * 10)) ** (1 / 20)),
        ({"n": 20, "unvisited": 1}, 1 - (delta / (S * 5)) ** (1 / 20)),
        ({"n": 20, "unvisited": 0}, 0.0),
    ],
    "mle_covering_repaired": [({}, 2 * (log_N + log(1 / delta)) / n + 2 * eps)],
    "mle_covering_stated": [({}, 6 * (log(2 * delta) + log_N) / n + 4 * eps + 2 * log(1 + chi2))],
    "mle_finite_repaired": [({}, log((size - 1) / delta) / n)],
    "mle_finite_sharp": [({}, 1 - (delta / (size - 1)) ** (1 / n))],
    "mle_finite_stated": [({}, 6 * log(2 * size * delta) / n + 2 * log(1 + chi2))],
    "mle_misspecified_repaired": [({}, 3 * (log(2 / delta) + log_N) / n + 2 * eps + log(1 + chi2))],
    "policy_error_stated": [({}, 4 * S * log(A / 0.03125) / n)],
    "policy_error_corollary": [({}, 6 * S * log(A / delta) / n)],
    "policy_error_covering": [({}, 6 * (log(2 / delta) + log_N) / n + eps)],
    "policy_error_finite": [({}, 6 * log(2 * size / delta) / n)],
    "policy_error_repaired": [({}, (S * log(2) + log(1 / delta)) / n)],
    "policy_error_sharp": [({}, tail)],
    "policy_kl_budget": [({}, binomials(visits, A) + log(1 / delta))],
    "row_error_at_step": [({}, R * (2 - R))],
    "row_error_summed": [({}, R * (1 + (H - 1) * (2 - R)))],
    "trajectory_error_stated": [({"C": 2.5}, H * 2.5 * R2)],
    "trajectory_error_one_sided": [({}, 2.97 * sum(q * h for q, h in zip(rates, errors, strict=True)))],
    "trajectory_error_symmetrised": [
        ({}, sum((q + p) * h for q, p, h in zip(rates, hats, errors, strict=True)) / 2),
    ],
    "trajectory_kl": [({"counts": visits, "ratio": 0.35}, 0.35 * (binomials(visits, S) + log(1 / delta)))],
    "transition_error_stated": [({}, 4 * S**2 * A * log(n * H / 0.015625) / n)],
    "transition_error_closed_form": [({}, 2 * D / n * (log(n * H / D + 3) + 2) + 2 * log(1 / delta) / n)],
    "transition_error_counts": [
        ({"n": 30, "counts": visits}, 1 - exp(-(binomials([*visits, 30], S) + log(1 / delta)) / 60)),
    ],
    "transition_error_covering": [({}, 6 * (log(2 / delta) + log_N) / n + eps)],
    "transition_error_infimum": [({}, stated_infimum())],
    "transition_error_rate": [({}, S**2 * A * log(n * H / delta) / n)],
    "transition_error_repaired": [({}, infimum(delta))],
    "transition_kl_budget": [({"counts": visits}, binomials(visits, S) + log(1 / delta))],
    "transition_log_covering_stated": [({}, S * A * (S - 1) * log(1 / eps + 1))],
    "transition_log_covering_closed_form": [({}, rows * (S - 1) * log(exp(1) * (1 / expm1(eps) + 3)))],
    "transition_log_covering_repaired": [({"epsilon": e}, lattice(e)) for e in (eps, 0.9, 3)],
    "transition_log_covering_two_states": [({"S": 2}, rows * log(ceil(1 / expm1(eps)))), ({"S": 2, "epsilon": 2}, 0.0)],
}  # fmt: skip

POINT: dict[str, Any] = {
    "S": S, "A": A, "H": H, "n": n, "delta": delta, "gamma_min": gamma, "B": B, "d": d, "R": R, "R1": R1, "R2": R2,
    "epsilon": eps, "rows": rows, "log_covering": log_N, "class_size": size, "chi2": chi2, "delta1": 0.03125,
    "delta2": 0.015625, "visits": visits, "occupancy": rates, "row_errors": errors, "occupancy_hat": hats,
}  # fmt: skip
LOOSE = {"transition_error_infimum": 1e-7}
"""A minimum over a grid of scales lies above the infimum by this much at most."""

CASES = [(name, changes, value) for name, cases in BY_HAND.items() for changes, value in cases]


def test_every_offline_formula_is_transcribed() -> None:
    offline = {name for name, f in FORMULAS.items() if f.function.__module__.startswith("bridge_theory.offline")}
    assert offline == set(BY_HAND)


@pytest.mark.parametrize(("name", "changes", "expected"), CASES, ids=[f"{name}-{c}" for name, c, _ in CASES])
def test_formula_equals_its_transcription(name: str, changes: dict[str, Any], expected: float) -> None:
    formula = FORMULAS[name]
    point = {key: value for key, value in (POINT | changes).items() if key in formula.parameters}
    assert float(formula.estimate(**point)) == pytest.approx(expected, rel=LOOSE.get(name, 1e-12), abs=1e-15)


def by_name(*values: tuple[float, str]) -> dict[str, float]:
    return {name: value for value, names in values for name in names.split()}


W, T, eta = 0.5, 40, 1.25
S_reach, delta_M = 6, 0.25
TRIVIAL: dict[str, float] = by_name(
    (
        2 * B * W * T,
        """regret_known_apriori regret_known_deterministic regret_known_from_sum regret_known_log
            regret_known_repaired regret_known_stated regret_known_version_space regret_offline regret_unknown_covered
            regret_unknown_repaired regret_unknown_squared regret_unknown_stated regret_unknown_version_space""",
    ),
    (2 * eta, "empirical_bonus expected_bonus transition_bonus xi xi_bar xi_repaired"),
    (1 / gamma, "concentrability_deterministic concentrability_sharp concentrability_stated"),
    (
        2 * B,
        """mean_difference_sharp feature_difference_deterministic feature_difference_repaired
            feature_difference_stated""",
    ),
    (4 * T * (H - 1), "radius_sum radius_sum_covered"),
    (4 * eta * T * (H - 1), "bonus_sum_repaired"),
    (16 * H * W * B * T * (H - 1), "bonus_sum_stated"),
    (2 * eta * (H - 1), "covered_bonus"),
    (2 * eta * T * (H - 1), "martingale_repaired"),
    (8 * eta**2 * T * (H - 1), "squared_bonus_sum_repaired"),
    (4 * eta**2 * T * (H - 1), "squared_bonus_sum_stated"),
    (8 * T * (eta * (H - 1)) ** 2, "squared_true_bonus_sum_repaired"),
    (S * A, "reach_size"),
    (H, "row_error_summed"),
    (2, "bonus_radius"),
    (B**2, "covariance_difference_sharp"),
    (d * B**2, "covariance_difference_stated"),
    (4 * B**2, "feature_difference_squared_stated"),
    (2 * B * sqrt(d), "mean_difference_stated"),
    (
        1,
        """confidence_set_radius confidence_set_radius_angle confidence_set_radius_deterministic
            confidence_set_radius_repaired containment_failure_known containment_failure_unknown coverage_failure
            delta_n_known delta_n_known_deterministic delta_n_unknown delta_n_unknown_deterministic
            delta_n_version_space delta_n_version_space_sharp exact_recovery_failure hellinger_from_kl
            hellinger_from_kl_with_exits missing_mass_expected missing_mass_good_turing missing_mass_observed
            mle_covering_repaired mle_covering_stated mle_finite_repaired mle_finite_sharp mle_finite_stated
            mle_misspecified_repaired offline_radius offline_radius_appendix offline_radius_closed
            offline_radius_corollaries offline_radius_known offline_radius_mass offline_radius_repaired
            offline_radius_repaired_angle offline_radius_stochastic policy_error_corollary policy_error_covering
            policy_error_finite policy_error_repaired policy_error_sharp policy_error_stated row_error_at_step
            trajectory_error_one_sided trajectory_error_stated trajectory_error_symmetrised
            transition_error_closed_form transition_error_counts transition_error_covering transition_error_infimum
            transition_error_repaired transition_error_stated preference_width""",
    ),
)
coverage = S_reach * exp(-n * gamma / 8)
FAILURE: dict[str, float] = by_name(
    (delta + delta * log(T) / log(2), "alpha_dT gamma_known regret_known_from_sum"),
    (5 * delta, "gamma_unknown gamma_true_bonus regret_unknown_stated"),
    (4 * delta + delta * log(T) / log(2), "regret_unknown_squared"),
    (2 * delta, "played_bonus_sum_stated"),
    (2 * delta_M, "squared_bonus_sum_stated squared_true_bonus_sum_stated"),
    (delta_M + coverage, "martingale_repaired"),
    (0.125 + delta_M + coverage, "radius_sum_covered"),
    (0.03125 + 0.0625 + 0.125 + delta_M + coverage, "regret_unknown_covered"),
)
MORE: dict[str, Any] = {
    "W": W, "T": T, "eta": eta, "S_reach": S_reach, "delta_martingale": delta_M, "delta_M": delta_M, "delta_P": 0.125,
    "delta_w": 0.03125, "delta_F": 0.0625,
}  # fmt: skip


def meaning(name: str, attribute: str) -> float:
    """The trivial value or the failure probability, evaluated over floats from its own parameters."""
    from bridge_theory.arithmetic.floats import FLOATS
    from bridge_theory.bound import call_with

    given = getattr(FORMULAS[name], attribute)
    return float(call_with(given, FLOATS, POINT | MORE) if callable(given) else given)


def test_every_trivial_value_and_failure_probability_is_transcribed() -> None:
    having = {
        kind: {n for n, f in FORMULAS.items() if getattr(f, kind, None) is not None} for kind in ("trivial", "failure")
    }
    assert having == {"trivial": set(TRIVIAL), "failure": set(FAILURE)}


@pytest.mark.parametrize("name", sorted(TRIVIAL))
def test_trivial_value_equals_its_transcription(name: str) -> None:
    assert meaning(name, "trivial") == pytest.approx(TRIVIAL[name], rel=1e-13)


@pytest.mark.parametrize("name", sorted(FAILURE))
def test_failure_probability_equals_its_transcription(name: str) -> None:
    assert meaning(name, "failure") == pytest.approx(FAILURE[name], rel=1e-12)
