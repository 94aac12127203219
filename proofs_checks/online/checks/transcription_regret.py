"""The formulas of the regret analysis, typed a second time; see ``transcription``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import ceil, log, sqrt

from proofs_checks.online.checks.transcription import (
    _C,
    _alpha,
    _beta,
    _closed,
    _covered,
    _gamma,
    _kappa,
    _relation,
    _steep,
)


def _log_term(S: float, A: float, H: float, eta: float, epsilon: float, delta: float, t: float) -> float:
    return H * log(S * A * H) + S * log(4 * eta * H / epsilon) + log(6 * log(t) / delta)


def _true_squares(
    S: float, A: float, H: float, eta: float, epsilon: float, n: float, t: float, T: float, gamma_min: float,
    S_reach: float, delta: float, delta_martingale: float,
) -> float:  # fmt: skip
    first = 12 * eta**2 * H**2 * (
        1.4 * log(log(2 * max(4 * eta**2 * H * t, 1))) + log(5.2 / delta_martingale) + 1
    )  # fmt: skip
    logs = H * log(S * A * H) + S * log(ceil(4 * eta * H / epsilon)) + log(6 * log(H * T) / delta)
    return first + 64 * eta**2 * H * S_reach * log(1 + T / (n * gamma_min)) * logs


def _bonus_sum(
    B: float, W: float, S: float, A: float, H: float, epsilon: float, n: float, T: float, gamma_min: float,
    S_reach: float, delta: float,
) -> float:  # fmt: skip
    term = _log_term(S, A, H, 8 * H * W * B, epsilon, delta, H * T)
    return 64 * H * W * B * sqrt(term) * S_reach * 2 * sqrt(T / (n * gamma_min))


def _squares_repaired(
    H: float, eta: float, log_covering: float, n: float, T: float, gamma_min: float, S_reach: float, uncovered: float
) -> float:
    m, M = 2 * (H - 1), 2 * T * (H - 1)
    off = 32 * eta**2 * log_covering * uncovered * log(1 + M / uncovered) if uncovered else 0.0
    early = uncovered + (S_reach if n * gamma_min / 2 < m else 0)
    covered = 32 * eta**2 * log_covering * S_reach * log(1 + 2 * M / (S_reach * n * gamma_min))
    return covered + off + 8 * eta**2 * m * early


def _sum_repaired(
    H: float, eta: float, log_covering: float, n: float, T: float, gamma_min: float, S_reach: float, uncovered: float
) -> float:
    m, M = 2 * (H - 1), 2 * T * (H - 1)
    covered = min(2 * sqrt(2 * S_reach * M), 2 * M / sqrt(n * gamma_min))
    early = uncovered + (S_reach if n * gamma_min / 2 < m else 0)
    return 4 * eta * sqrt(log_covering) * (covered + 2 * sqrt(2 * uncovered * M)) + 4 * m * eta * early


def _martingale(
    H: float, eta: float, log_covering: float, n: float, T: float, gamma_min: float, S_reach: float, Delta_n: float,
    delta_martingale: float,
) -> float:  # fmt: skip
    M = 4 * eta * (H - 1) * sqrt(2 * log_covering / (n * gamma_min))
    chance = log(2 / delta_martingale)
    return sqrt(2 * T * (M**2 + (2 * eta * (H - 1)) ** 2 * Delta_n) * chance) + 4 / 3 * eta * (H - 1) * chance


def _features(B: float, lam: float, d: float, S: float, A: float, n: float, T: float, delta: float) -> float:
    return sqrt(2 * d * log(1 + 192 * B**2 * T * S * log(A / delta) / (n * d * lam)))


def _price(a: float) -> float:
    return a / log(1 + a) if a > 1e-9 else 1 + a / 2


def _psi(B: float, W: float, lam: float, d: float, T: float, delta_F: float) -> float:
    v = _steep(B, W) * lam
    a = 4 * B**2 / v
    return _C * (_price(a) * d * log(1 + 4 * T * B**2 / (d * v)) + a * log(1 / delta_F))


def _apriori(B: float, W: float, lam: float, d: float, T: float, K: float, delta_w: float, delta_F: float) -> float:
    return 4 * _steep(B, W) * _closed(B, W, lam, d, K * T, delta_w) * sqrt(T * _psi(B, W, lam, d, T, delta_F))


def _known_log(
    B: float, W: float, lam: float, d: float, T: float, delta_w: float, delta_V: float, diameter: float
) -> float:
    v, D2 = _steep(B, W) * lam, diameter**2
    width = _relation(B, W, lam, d, T, T, delta_w, delta_V)
    return 2 * width * sqrt(T * _price(D2 / v) * d * log(1 + T * D2 / (d * v)))


def _space(S: float, n: float, delta_off: float) -> float:
    return float(1 - (delta_off / (2**S - 1)) ** (1 / n))


def _L(S: float, A: float, H: float, n: float, T: float, K: float, delta_P: float) -> float:
    most = (n + 2 * K * T) * (H - 1)
    return 2 * (S * log(2) + log(S * A * most * (most + 1) / delta_P))


def _radii(S: float, A: float, H: float, n: float, T: float, K: float, delta_P: float, delta_M: float) -> float:
    later = 2 * sqrt(2 * _L(S, A, H, n, T, K, delta_P)) * sqrt(2 * S * A * T * (H - 1) / K)
    return _C * (8 * (H - 1) * S * A + later + 4 * (H - 1) * log(1 / delta_M))


def _radii_covered(gamma_min: float, S_reach: float, Delta_n: float, **k: float) -> float:
    term = _L(*(k[name] for name in ("S", "A", "H", "n", "T", "K", "delta_P")))
    offline = 2 * k["T"] * (k["H"] - 1) * (sqrt(2 * term / (k["n"] * gamma_min)) + 2 * Delta_n)
    return min(_radii(**k), offline)


def _unknown(radii: float, B: float, W: float, lam: float, d: float, H: float, T: float, K: float, delta_w: float,
             delta_F: float, Delta_n: float) -> float:  # fmt: skip
    k = _steep(B, W)
    factor = 4 * k * _closed(B, W, lam, d, K * T, delta_w) * B / sqrt(k * lam) + 2 * B * W * H
    return min(2 * B * W * T * Delta_n, _apriori(B, W, lam, d, T, K, delta_w, delta_F) + factor * radii)


_OWN = ("B", "W", "lam", "d", "H", "T", "K", "delta_w", "delta_F", "Delta_n")
_SUM = ("S", "A", "H", "n", "T", "K", "delta_P", "delta_M")


def _unknown_repaired(**k: float) -> float:
    return _unknown(_radii(**{name: k[name] for name in _SUM}), **{name: k[name] for name in _OWN})


def _unknown_covered(**k: float) -> float:
    radii = _radii_covered(**{name: k[name] for name in (*_SUM, "gamma_min", "S_reach", "Delta_n")})
    return _unknown(radii, **{name: k[name] for name in _OWN})


def _unknown_space(delta_off: float, **k: float) -> float:
    return _unknown_repaired(**k, Delta_n=_space(k["S"], k["n"], delta_off))


def _true_gamma(
    B: float, W: float, lam: float, d: float, H: float, T: float, delta: float, epsilon: float, bonus_square_sum: float
) -> float:
    known = sqrt(2) * _gamma(B, W, lam, d, T, T, delta)
    return known + 1 / T + 4 * sqrt(bonus_square_sum + 24 * T * epsilon * H**2 * W * B)


def _scale(B: float, W: float, d: float, T: float, delta: float) -> float:
    return (W * sqrt(_kappa(B, W) * B) + W * B) * d * log(T * B / (_kappa(B, W) * delta))


REGRET: Mapping[str, Callable[..., float]] = {
    "offline_bonus_log_term": _log_term,
    "squared_bonus_sum_stated": lambda S, A, H, eta, epsilon, n, T, gamma_min, S_reach, delta_martingale: (
        32 * eta**2 * _log_term(S, A, H, eta, epsilon, delta_martingale, H * T) * S_reach
        * log(1 + T / (n * gamma_min))
    ),
    "squared_true_bonus_sum_stated": _true_squares,
    "bonus_sum_stated": _bonus_sum,
    "played_bonus_sum_stated": lambda **k: 16 * _bonus_sum(**k),
    "squared_bonus_sum_repaired": _squares_repaired,
    "bonus_sum_repaired": _sum_repaired,
    "squared_true_bonus_sum_repaired": lambda T, **k: 2 * T * _covered(**k) ** 2,
    "martingale_repaired": _martingale,
    "feature_difference_sum": _features,
    "regret_known_from_sum": lambda B, W, lam, d, T, delta, norm_sum: (
        2 * _gamma(B, W, lam, d, T, T, delta) * norm_sum
    ),
    "regret_known_stated": lambda B, W, lam, d, S, A, n, T, delta: (
        (2 * _kappa(B, W) * _beta(B, W, lam, d, T, delta) + _alpha(B, W, d, T, delta))
        * _features(B, lam, d, S, A, n, T, delta)
    ),
    "expected_potential": _psi,
    "regret_known_apriori": _apriori,
    "regret_known_log": _known_log,
    "regret_known_repaired": lambda diameter, Delta_n, **k: min(
        k["T"] * k["W"] * diameter, 2 * k["B"] * k["W"] * k["T"] * Delta_n, _apriori(**k)
    ),
    "regret_known_version_space": lambda S, n, delta_off, **k: min(
        2 * k["B"] * k["W"] * k["T"], 2 * k["B"] * k["W"] * k["T"] * _space(S, n, delta_off), _apriori(**k)
    ),
    "delta_n_known": lambda radius: min(1, 2 * sqrt(2) * radius),
    "delta_n_known_deterministic": lambda radius: min(1, 2 * radius**2),
    "delta_n_unknown": lambda radius, R2: min(1, 2 * sqrt(2) * radius + sqrt(2 * R2)),
    "delta_n_unknown_deterministic": lambda radius, R2: min(1, 2 * radius**2 + sqrt(2 * R2)),
    "delta_n_version_space": lambda S, A, n, delta_off: min(1, (S * log(A) + log(1 / delta_off)) / n),
    "delta_n_version_space_sharp": _space,
    "exact_recovery_failure": lambda S_reach, n, gamma_min: S_reach * (1 - gamma_min) ** n,
    "regret_known_deterministic": lambda B, W, S, A, n, T, delta_off: min(
        2 * B * W * T, 24 * B * W * T * S * log(A / delta_off) / n
    ),
    "elliptical_floor": lambda W, d, T, gamma, diameter: min(
        4 * sqrt(log(2)) * T * W * diameter, 2 * gamma * sqrt(d * T * log(2))
    ),
    "potential_factor": lambda L, v: _price(L**2 / v),
    "elliptical_potential": lambda L, v, d, square_sum: _price(L**2 / v) * d * log(1 + square_sum / (d * v)),
    "elliptical_potential_capped": lambda v, d, square_sum: d * log(1 + square_sum / (d * v)) / log(2),
    "elliptical_norm_sum": lambda L, v, d, T, square_sum: sqrt(
        T * _price(L**2 / v) * d * log(1 + square_sum / (d * v))
    ),
    "regret_trivial": lambda B, W, T: 2 * B * W * T,
    "regret_diameter": lambda W, T, diameter: T * W * diameter,
    "regret_offline": lambda B, W, T, Delta_n: 2 * B * W * T * Delta_n,
    "regret_width": lambda width_sum, bonus_sum: 2 * (width_sum + bonus_sum),
    "regret_optimism": lambda W, optimism, norm, bonus_sum: min(optimism, W * norm) + bonus_sum,
    "regret_hindsight": lambda W, optimism, norm, bonus_sum: min(optimism, W * norm) + bonus_sum / 2,
    "gamma_true_bonus": _true_gamma,
    "regret_unknown_stated": lambda norm_sum, bonus_sum, **k: (
        2 * _true_gamma(**k) * sqrt(k["T"] * norm_sum) + bonus_sum
    ),
    "regret_unknown_squared": lambda B, W, lam, d, T, delta, bonus_square_sum, potential, bonus_sum: (
        2 * (sqrt(2) * _gamma(B, W, lam, d, T, T, delta) + 2 * sqrt(bonus_square_sum) + 1 / T) * sqrt(T * potential)
        + bonus_sum
    ),
    "radius_sum": _radii,
    "radius_sum_covered": _radii_covered,
    "regret_unknown_repaired": _unknown_repaired,
    "regret_unknown_covered": _unknown_covered,
    "regret_unknown_version_space": _unknown_space,
    "containment_failure_known": lambda delta_off, delta_w: delta_off + delta_w,
    "containment_failure_unknown": lambda delta_off, delta_w, delta_P: delta_off + delta_w + delta_P,
    "regret_known_scale": _scale,
    "regret_known_rate": lambda B, W, d, S, n, T, delta: _scale(B, W, d, T, delta) * sqrt(log(1 + T * S / (n * d))),
    "regret_regime_small_horizon": lambda B, W, d, S, n, T, delta: _scale(B, W, d, T, delta) * sqrt(T * S / (n * d)),
    "regret_regime_transition": _scale,
    "regret_regime_large_horizon": lambda B, W, d, T, delta: _scale(B, W, d, T, delta) * sqrt(log(T)),
}  # fmt: skip
"""Appendices A and D, and R3, R4, R5, R7, R8, R11."""


def _growth(n: float, T: float, gamma_min: float) -> float:
    return min(log(T), T / (n * gamma_min))


def _martingale_rate(B: float, W: float, S: float, A: float, H: float, n: float, T: float, gamma_min: float) -> float:
    second = H**2.5 * W * B * sqrt(T / (n * gamma_min))
    return float(second + H**2 * W * B * sqrt(T) * sqrt(S) * A**0.25 / n**0.25)


def _first(H: float, S: float, A: float, T: float, n: float, gamma_min: float) -> float:
    return H * S * sqrt(A * T * H / (n * gamma_min))


def _term_1(
    B: float, W: float, d: float, S: float, H: float, n: float, T: float, gamma_min: float, epsilon: float
) -> float:
    bonus = H**2 * W * B * S * sqrt(_growth(n, T, gamma_min))
    return (_kappa(B, W) + B * W) * sqrt(d * log(T)) + bonus + sqrt(T * epsilon * H**2 * W * B)


def _term_2(B: float, d: float, S: float, A: float, H: float, n: float, T: float, gamma_min: float) -> float:
    drift = B**2 * H * S**2 * min(T / n, log(T)) + T * S * B**2 * sqrt(A * H) / sqrt(n * gamma_min)
    return sqrt(T * log(1 + drift / d))


def _played(B: float, W: float, S: float, A: float, H: float, n: float, T: float, gamma_min: float) -> float:
    return _first(H, S, A, T, n, gamma_min) + _martingale_rate(B, W, S, A, H, n, T, gamma_min)


def _term_3(B: float, W: float, S: float, A: float, H: float, n: float, T: float, gamma_min: float) -> float:
    second = H**2.5 * W * B * sqrt(T) / sqrt(n * gamma_min)
    third = H**2 * W * B * T * sqrt(log(T)) * sqrt(S) * A**0.25 / n**0.25
    return float(_first(H, S, A, T, n, gamma_min) + second + third)


RATES: Mapping[str, Callable[..., float]] = {
    "main_simplified_rate": lambda n, T, gamma_min: sqrt(T) * sqrt(log(1 + T / n)) + sqrt(T) / sqrt(n * gamma_min),
    "term_1_rate": _term_1,
    "term_2_rate": _term_2,
    "term_3_rate": _term_3,
    "martingale_rate": _martingale_rate,
    "played_bonus_rate": _played,
    "squared_bonus_rate": lambda S, H, eta, n, T, gamma_min: eta**2 * H**2 * S**2 * _growth(n, T, gamma_min),
    "feature_drift_rate": lambda B, S, A, H, n, t, C, delta: (
        B**2 * H * S**2 * log(S * A / delta) * C**2 * (t / (n + t) ** 2 + t**2 / ((n + t) ** 2 * n))
    ),
    "bridge_regret_rate": lambda B, W, d, S, A, H, n, T, gamma_min: (
        2 * _term_1(B, W, d, S, H, n, T, gamma_min, 1 / T) * _term_2(B, d, S, A, H, n, T, gamma_min)
        + _played(B, W, S, A, H, n, T, gamma_min)
    ),
}
"""The leading expressions of the O-tilde statements."""
REGRET = {**REGRET, **RATES}
