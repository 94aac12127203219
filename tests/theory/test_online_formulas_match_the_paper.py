"""Each online and regret formula equals the paper's display, transcribed a second time by hand at one point."""

from __future__ import annotations

from math import ceil, cosh, e, exp, log, sqrt
from typing import Any

import pytest

from bridge_theory.bound import Bound
from bridge_theory.catalog import FORMULAS

B, W, lam, d, t, T, n = 1.5, 0.5, 2.0, 3, 7, 50, 40
S, A, H, eta, epsilon, delta, gamma_min, S_reach = 5, 4, 8, 1.25, 0.125, 0.0625, 0.25, 6
delta_w, delta_F, delta_P, delta_M, delta_V = 0.03125, 0.0625, 0.125, 0.25, 0.015625
K, N, U, Delta, squares, radius, R2, D = 3, 90, 21.5, 0.03125, 11.0, 0.125, 0.0078125, 0.75

k1, k2, k3 = (2 + 2 * cosh(factor * B * W) for factor in (1, 2, sqrt(2)))


def stated_beta(rounds: int) -> float:
    return sqrt(lam) * W + sqrt(log(1 / delta) + 2 * d * log(1 + rounds * B**2 / (k1 * lam * d)))


def proved_beta(comparisons: int) -> float:
    return sqrt(lam / k2) * W + 0.5 * sqrt(2 * log(1 / delta_w) + d * log(1 + 4 * comparisons * B**2 / (k2 * lam * d)))


def c(a: float) -> float:
    return a / log(1 + a)


alpha = 20 * B * W * sqrt(d * log(T * (1 + 2 * T) / delta))
gamma_T = 4 * k1 * stated_beta(T) + alpha
proved_gamma = 2 * sqrt(2) * k2 * proved_beta(t - 1) + 2 * W * sqrt(27 * B**2 * d * log((1 + 2 * T) / delta_V))
proved_gamma_T = 2 * sqrt(2) * k2 * proved_beta(T - 1) + 2 * W * sqrt(27 * B**2 * d * log((1 + 2 * T) / delta_V))
feature_sum = sqrt(2 * d * log(1 + 192 * B**2 * T * S * log(A / delta) / (n * d * lam)))
a = 4 * B**2 / (k2 * lam)
Psi = e / (e - 1) * (c(a) * d * log(1 + 4 * T * B**2 / (d * k2 * lam)) + a * log(1 / delta_F))
theorem_k = 4 * k2 * proved_beta(K * T) * sqrt(T * Psi)
N_max = (n + 2 * K * T) * (H - 1)
L_T = 2 * (S * log(2) + log(S * A * N_max * (N_max + 1) / delta_P))
batch = 2 * K * (H - 1)
Gamma = (
    e / (e - 1) / K
    * (4 * batch * S * A + 2 * sqrt(2 * L_T) * sqrt(2 * K * S * A * T * (H - 1)) + 2 * batch * log(1 / delta_M))
)  # fmt: skip
Gamma_covered = min(Gamma, 2 * T * (H - 1) * (sqrt(2 * L_T / (n * gamma_min)) + 2 * Delta))


def theorem_u_online(radii: float) -> float:
    return theorem_k + (4 * k2 * proved_beta(K * T) * B / sqrt(k2 * lam) + 2 * B * W * H) * radii


def theorem_u(radii: float) -> float:
    return min(2 * B * W * T * Delta, theorem_u_online(radii))


def eps_N(count: int) -> float:
    return min(2, sqrt(2 * (S * log(2) + log(S * A * count * (count + 1) / delta_P)) / count)) if count else 2


def xi(count: int) -> float:
    return min(2 * eta, 4 * eta * sqrt((H * log(S * A) + log(6 * log(count) / delta)) / count))


def xi_bar(count: int) -> float:
    cover = S * log(ceil(4 * eta * H / epsilon))
    return min(2 * eta, 4 * eta * sqrt((H * log(S * A) + cover + log(6 * log(count) / delta)) / count))


V_squared = H * log(S * A * H) + S * log(4 * eta * H / epsilon) + log(6 * log(H * T) / delta_M)
V_ceiling = H * log(S * A * H) + S * log(ceil(4 * eta * H / epsilon)) + log(6 * log(H * T) / delta)
V_utility = H * log(S * A * H) + S * log(32 * H**2 * W * B / epsilon) + log(6 * log(H * T) / delta)
M = 2 * T * (H - 1)
M_n = 4 * eta * (H - 1) * sqrt(2 * U / (n * gamma_min))
growth = min(log(T), T / (n * gamma_min))
Capital = (W * sqrt(k1 * B) + W * B) * d * log(T * B / (k1 * delta))
martingale = H**2.5 * W * B * sqrt(T) / sqrt(n * gamma_min) + H**2 * W * B * sqrt(T) * S**0.5 * A**0.25 / n**0.25
played = H * S * sqrt(A * T * H / (n * gamma_min)) + martingale
term_1 = (k1 + B * W) * sqrt(d * log(T)) + H**2 * W * B * S * sqrt(growth)
term_2 = sqrt(
    T * log(1 + (B**2 * H * S**2 * min(T / n, log(T)) + T * S * B**2 * sqrt(A * H) / sqrt(n * gamma_min)) / d)
)
cells: dict[str, Any] = {"occupancy": [2.5, 1.25, 0.25], "counts": [300, 90, 2]}

BY_HAND: dict[str, float] = {
    "kappa": k1,
    "kappa_differences": k2,
    "kappa_nonnegative": k3,
    "beta_t": stated_beta(t),
    "confidence_radius": 2 * k1 * stated_beta(t),
    "beta_repaired_logdet": sqrt(lam / k2) * W + 0.5 * sqrt(2 * log(1 / delta_w) + 3.5),
    "beta_repaired": proved_beta(K * (t - 1)),
    "confidence_radius_repaired": k2 * (sqrt(lam / k2) * W + 0.5 * sqrt(2 * log(1 / delta_w) + 3.5) + 0.75),
    "confidence_radius_nonnegative": k3 * (sqrt(lam / k3) * W + 0.5 * sqrt(2 * log(1 / delta_w) + 3.5) + 0.75),
    "matrix_shift": 84 * B**2 * d * log((1 + 2 * T) / delta),
    "alpha_dT": alpha,
    "gamma_known": 4 * k1 * stated_beta(t) + alpha,
    "norm_relation": proved_gamma,
    "norm_relation_sharp": 2 * sqrt(e / (e - 1)) * k2 * proved_beta(t - 1)
    + 2 * W * sqrt(4 * e / (e - 1) * B**2 * (d * log(1 + 2 * T) + log(1 / delta_V)) + 8 * (1 + e / (e - 1)) * B**2),
    "gamma_unknown": sqrt(2) * (4 * k1 * stated_beta(t) + alpha) + 2 * sqrt(squares) + 1 / t,
    "gamma_unknown_repaired": sqrt(2) * proved_gamma + 2 * sqrt(squares),
    "containment_failure_known": 0.0625 + delta_w,
    "containment_failure_unknown": 0.0625 + delta_w + delta_P,
    "online_bonus_delta": delta / (2 * A**S),
    "net_scale": 1 / (t**2 * k1 * lam + 4 * B**2 * t**3),
    "net_delta": delta / (1 + 4 * W / epsilon) ** d,
    "step_bonus_delta": delta / (8 * t**3 * A**S),
    "xi": xi(N),
    "xi_bar": xi_bar(N),
    "xi_repaired": xi(N),
    "empirical_bonus": 2.5 * xi(300) + 1.25 * xi(90) + 0.25 * xi(2),
    "expected_bonus": 2.5 * xi_bar(300) + 1.25 * xi_bar(90) + 0.25 * xi_bar(2),
    "bonus_radius": eps_N(N),
    "transition_bonus": eta * min(2, 2.5 * eps_N(300) + 1.25 * eps_N(90) + 0.25 * eps_N(2)),
    "estimated_radius_sum": H * 0.375,
    "empirical_from_true_bonus": 2 * 0.375 + epsilon,
    "empirical_from_true_bonus_sharp": (1 + 1 / H) * 0.375 + epsilon,
    "reach_size": min(S * A, H / gamma_min),
    "coverage_failure": S_reach * exp(-n * gamma_min / 8),
    "covered_bonus": (H - 1) * 4 * eta * sqrt(2 * U / (n * gamma_min)) + 2 * eta * (H - 1) * Delta,
    "potential_factor": c(1.75**2 / 2.25),
    "elliptical_potential": c(1.75**2 / 2.25) * d * log(1 + 30 / (d * 2.25)),
    "elliptical_potential_capped": d * log(1 + 30 / (d * 2.25)) / log(2),
    "elliptical_norm_sum": sqrt(T * c(1.75**2 / 2.25) * d * log(1 + 30 / (d * 2.25))),
    "regret_trivial": 2 * B * W * T,
    "regret_diameter": T * W * D,
    "regret_offline": 2 * B * W * T * Delta,
    "regret_width": 2 * (9.5 + 4.25),
    "regret_optimism": min(20.0, W * 30) + 4.25,
    "regret_hindsight": min(20.0, W * 30) + 4.25 / 2,
    "regret_known_from_sum": 2 * gamma_T * 6.5,
    "feature_difference_sum": feature_sum,
    "regret_known_stated": (2 * k1 * stated_beta(T) + alpha) * feature_sum,
    "regret_known_scale": Capital,
    "regret_known_rate": Capital * sqrt(log(1 + T * S / (n * d))),
    "regret_regime_small_horizon": Capital * sqrt(T * S / (n * d)),
    "regret_regime_transition": Capital,
    "regret_regime_large_horizon": Capital * sqrt(log(T)),
    "expected_potential": Psi,
    "regret_known_apriori": theorem_k,
    "regret_known_repaired": min(T * W * D, 2 * B * W * T * Delta, theorem_k),
    "regret_known_version_space": 2 * B * W * T * min(1, 1 - (0.0625 / (2**S - 1)) ** (1 / n)),
    "regret_known_log": 2 * proved_gamma_T
    * sqrt(T * c(D**2 / (k2 * lam)) * d * log(1 + T * D**2 / (d * k2 * lam))),
    "delta_n_known": 2 * sqrt(2) * radius,
    "delta_n_known_deterministic": 2 * radius**2,
    "delta_n_unknown": 2 * sqrt(2) * radius + sqrt(2) * sqrt(R2),
    "delta_n_unknown_deterministic": 2 * radius**2 + sqrt(2) * sqrt(R2),
    "delta_n_version_space": (S * log(A) + log(1 / 0.0625)) / n,
    "delta_n_version_space_sharp": 1 - (0.0625 / (2**S - 1)) ** (1 / n),
    "exact_recovery_failure": S_reach * (1 - gamma_min) ** n,
    "regret_known_deterministic": min(2 * B * W * T, 24 * B * W * T * S * log(A / 0.0625) / n),
    "elliptical_floor": min(4 * sqrt(log(2)) * T * W * D, 2 * 6.25 * sqrt(d * T * log(2))),
    "radius_sum": Gamma,
    "radius_sum_covered": Gamma_covered,
    "regret_unknown_repaired": theorem_u(Gamma),
    "regret_unknown_covered": theorem_u(Gamma_covered),
    "regret_unknown_version_space": 2 * B * W * T * (1 - (0.0625 / (2**S - 1)) ** (1 / n)),
    "gamma_true_bonus": sqrt(2) * gamma_T + 1 / T + 4 * sqrt(squares + 24 * T * epsilon * H**2 * W * B),
    "regret_unknown_stated": 2
    * (sqrt(2) * gamma_T + 1 / T + 4 * sqrt(squares + 24 * T * epsilon * H**2 * W * B)) * sqrt(T * 6.5) + 4.25,
    "regret_unknown_squared": 2 * (sqrt(2) * gamma_T + 2 * sqrt(squares) + 1 / T) * sqrt(T * 8.5) + 4.25,
    "offline_bonus_log_term": H * log(S * A * H) + S * log(4 * eta * H / epsilon) + log(6 * log(t) / delta),
    "squared_bonus_sum_stated": 32 * eta**2 * V_squared * S_reach * log(1 + T / (n * gamma_min)),
    "squared_true_bonus_sum_stated": 12 * eta**2 * H**2
    * (1.4 * log(log(2 * max(4 * eta**2 * H * t, 1))) + log(5.2 / delta_M) + 1)
    + 64 * eta**2 * H * S_reach * log(1 + T / (n * gamma_min)) * V_ceiling,
    "bonus_sum_stated": 64 * H * W * B * sqrt(V_utility) * S_reach * 2 * sqrt(T / (n * gamma_min)),
    "played_bonus_sum_stated": 2048 * H * W * B * sqrt(V_utility) * S_reach * sqrt(T / (n * gamma_min)),
    "squared_bonus_sum_repaired": 32 * eta**2 * U
    * (S_reach * log(1 + 2 * M / (S_reach * n * gamma_min)) + 2 * log(1 + M / 2))
    + 8 * eta**2 * 2 * (H - 1) * (2 + S_reach),
    "bonus_sum_repaired": 4 * eta * sqrt(U)
    * (min(2 * sqrt(2 * S_reach * M), 2 * M / sqrt(n * gamma_min)) + 2 * sqrt(2 * 2 * M))
    + 4 * 2 * (H - 1) * eta * (2 + S_reach),
    "squared_true_bonus_sum_repaired": 2 * T * (M_n + 2 * eta * (H - 1) * Delta) ** 2,
    "martingale_repaired": sqrt(2 * T * (M_n**2 + (2 * eta * (H - 1)) ** 2 * Delta) * log(2 / delta_M))
    + 4 / 3 * eta * (H - 1) * log(2 / delta_M),
    "main_simplified_rate": sqrt(T) * sqrt(log(1 + T / n)) + sqrt(T) / sqrt(n * gamma_min),
    "term_1_rate": term_1 + sqrt(T * epsilon * H**2 * W * B),
    "term_2_rate": term_2,
    "term_3_rate": H * S * sqrt(A * T * H / (n * gamma_min)) + H**2.5 * W * B * sqrt(T) / sqrt(n * gamma_min)
    + H**2 * W * B * T * sqrt(log(T)) * S**0.5 * A**0.25 / n**0.25,
    "played_bonus_rate": played,
    "martingale_rate": martingale,
    "bridge_regret_rate": 2 * (term_1 + H * sqrt(W * B)) * term_2 + played,
    "squared_bonus_rate": eta**2 * H**2 * S**2 * growth,
    "feature_drift_rate": B**2 * H * S**2 * log(S * A / delta) * 1.5**2
    * (t / (n + t) ** 2 + t**2 / ((n + t) ** 2 * n)),
}  # fmt: skip

POINT: dict[str, Any] = {
    "B": B, "W": W, "lam": lam, "d": d, "t": t, "T": T, "n": n, "S": S, "A": A, "H": H, "eta": eta, "epsilon": epsilon,
    "delta": delta, "gamma_min": gamma_min, "S_reach": S_reach, "delta_w": delta_w, "delta_F": delta_F,
    "delta_P": delta_P, "delta_M": delta_M, "delta_V": delta_V, "delta_off": 0.0625, "delta_martingale": delta_M,
    "K": K, "N": N, "log_covering": U, "Delta_n": Delta, "bonus_square_sum": squares, "radius": radius, "R2": R2,
    "diameter": D,
    "log_det_ratio": 3.5, "residual": 0.75, "true_bonus": 0.375, "L": 1.75, "v": 2.25, "square_sum": 30,
    "width_sum": 9.5, "bonus_sum": 4.25, "optimism": 20, "norm": 30, "norm_sum": 6.5, "potential": 8.5, "gamma": 6.25,
    "uncovered": 2, "C": 1.5, **cells,
}  # fmt: skip


def test_every_online_and_regret_formula_is_transcribed() -> None:
    ours = {
        name
        for name, formula in FORMULAS.items()
        if formula.function.__module__.startswith(("bridge_theory.online", "bridge_theory.regret"))
    }
    assert ours | {"kappa", "kappa_differences", "kappa_nonnegative"} == set(BY_HAND)


@pytest.mark.parametrize("name", sorted(BY_HAND))
def test_formula_equals_its_transcription(name: str) -> None:
    formula = FORMULAS[name]
    value = formula.estimate(**{key: POINT[key] for key in formula.parameters})
    assert float(value) == pytest.approx(BY_HAND[name], rel=1e-13)


# parts of minima that are not the smallest at the point above
PARTS: dict[str, dict[str, float]] = {
    "regret_known_repaired": {"diameter": T * W * D, "offline": 2 * B * W * T * Delta, "elliptical": theorem_k},
    "regret_known_version_space": {"trivial": 2 * B * W * T, "elliptical": theorem_k},
    "regret_known_deterministic": {"offline": 24 * B * W * T * S * log(A / 0.0625) / n},
    "regret_unknown_repaired": {"online": theorem_u_online(Gamma)},
    "regret_unknown_covered": {"online": theorem_u_online(Gamma_covered)},
    "radius_sum_covered": {
        "online": Gamma,
        "offline": 2 * T * (H - 1) * (sqrt(2 * L_T / (n * gamma_min)) + 2 * Delta),
    },
    "elliptical_floor": {
        "small_diameter": 4 * sqrt(log(2)) * T * W * D,
        "large_diameter": 2 * 6.25 * sqrt(d * T * log(2)),
    },
    "reach_size": {"all_pairs": S * A, "visited": H / gamma_min},
}


@pytest.mark.parametrize("name", sorted(PARTS))
def test_every_candidate_of_a_minimum_equals_its_transcription(name: str) -> None:
    bound = FORMULAS[name]
    assert isinstance(bound, Bound)
    terms = bound.value(**{key: POINT[key] for key in bound.parameters}).terms
    for part, expected in PARTS[name].items():
        assert terms[part].middle == pytest.approx(expected, rel=1e-13)
