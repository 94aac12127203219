"""The offline formulas of the paper typed a second time from its text, against bridge_theory.

This is no evidence for a statement, but for its transcription: a changed constant, sign or operator in bridge_theory
disagrees with the text here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import acos, asin, ceil, comb, cosh, exp, log, pi, sin, sqrt
from typing import Any

import bridge_theory
from proofs_checks.outcome import Outcome, Tally

_ROUNDING = 1e-12

# A point where all branches of the formulas below are strict, and one where they go the other way.
_POINTS: tuple[Mapping[str, Any], ...] = (
    {"S": 5, "A": 4, "H": 8, "n": 300, "delta": 0.05, "delta1": 0.03, "delta2": 0.02, "gamma_min": 0.1, "B": 1.5,
     "W": 0.7, "d": 3, "R": 0.02, "R1": 0.01, "R2": 0.03, "C": 1.7, "epsilon": 0.2, "log_covering": 9.0, "chi2": 0.3,
     "class_size": 33, "rows": 7, "radius": 0.3, "mass": 0.36, "kl": 0.8, "exit_mass": 0.25, "unvisited": 2,
     "singletons": 4, "ratio": 0.4, "counts": (40, 0, 7), "visits": (12, 3, 0), "occupancy": (0.5, 0.25, 1.0),
     "occupancy_hat": (0.125, 0.5, 0.75), "row_errors": (0.25, 0.1, 0.3)},
    {"S": 2, "A": 3, "H": 3, "n": 7, "delta": 0.4, "delta1": 0.3, "delta2": 0.45, "gamma_min": 0.9, "B": 0.25,
     "W": 3.0, "d": 2, "R": 0.6, "R1": 0.7, "R2": 0.8, "C": 0.6, "epsilon": 1.1, "log_covering": 2.0, "chi2": 2.0,
     "class_size": 5, "rows": 2, "radius": 0.9, "mass": 0.04, "kl": 3.0, "exit_mass": 0.6, "unvisited": 1,
     "singletons": 1, "ratio": 0.1, "counts": (2, 5), "visits": (7, 1), "occupancy": (1.0, 0.4),
     "occupancy_hat": (0.9, 0.0), "row_errors": (0.2, 1.0)},
)  # fmt: skip


def _lemma_radius(R1: float, R2: float, H: float, gamma_min: float) -> float:
    return sqrt(R1) + sqrt(R2) * (1 + sqrt(H * (1 + 2 * sqrt(R1) / gamma_min)))


def _sharp_concentrability(R: float, gamma_min: float) -> float:
    if gamma_min >= (1 - R) ** 2:
        return 1 / gamma_min
    return float((1 - R + sqrt(R * (2 - R) * (1 - gamma_min) / gamma_min)) ** 2)


def _budget(size: int, cells: tuple[int, ...], delta: float) -> float:
    return sum(log(comb(N + size - 1, size - 1)) for N in cells) + log(1 / delta)


def _lattice(S: int, k: int) -> float:
    return log(comb(k + 2 * S - 2, S - 1))


def _covariance(B: float, R: float) -> float:
    t = sqrt(R * (2 - R))
    return B**2 * (4 * t * (1 - t) if t <= 0.5 else 1.0)


TEXT: Mapping[str, Callable[..., float]] = {
    "alpha_offline": lambda S, A, delta: sqrt(4 * S * log(A * 2 / delta)),
    "beta_offline": lambda S, A, H, n, delta: sqrt(4 * S**2 * A * log(n * H * 2 / delta)),
    "policy_error_stated": lambda S, A, n, delta1: 4 * S * log(A / delta1) / n,
    "transition_error_stated": lambda S, A, H, n, delta2: 4 * S**2 * A * log(n * H / delta2) / n,
    "policy_error_corollary": lambda S, A, n, delta: 6 * S * log(A / delta) / n,
    "policy_error_finite": lambda n, delta, class_size: 6 * log(2 * class_size / delta) / n,
    "policy_error_covering": lambda n, delta, log_covering, epsilon: (
        6 * (log(2) + log_covering + log(1 / delta)) / n + epsilon
    ),
    "transition_error_covering": lambda n, delta, log_covering, epsilon: (
        6 * (log(2) + log_covering + log(1 / delta)) / n + epsilon
    ),
    "transition_error_rate": lambda S, A, H, n, delta: S**2 * A * log(n * H / delta) / n,
    "mle_covering_stated": lambda n, delta, log_covering, epsilon, chi2: (
        6 * (log(2) + log_covering - log(1 / delta)) / n + 4 * epsilon + 2 * log(1 + chi2)
    ),
    "mle_finite_stated": lambda n, delta, class_size, chi2: (
        6 * log(2 * class_size / (1 / delta)) / n + 2 * log(1 + chi2)
    ),
    "confidence_set_radius": _lemma_radius,
    "concentrability_stated": lambda R, gamma_min: 1 + 2 * sqrt(R) / gamma_min,
    "trajectory_error_stated": lambda H, C, R2: H * C * R2,
    "transition_log_covering_stated": lambda S, A, epsilon: S * A * (S - 1) * log(1 / epsilon + 1),
    "mean_difference_stated": lambda B, d, R: 2 * sqrt(2) * B * sqrt(d * R),
    "covariance_difference_stated": lambda B, d, R: 6 * d * B**2 * sqrt(2 * R),
    "feature_difference_stated": lambda B, n: 4 * sqrt(2) * B / sqrt(n),
    "feature_difference_squared_stated": lambda B, S, A, n, delta: 8 * B**2 * 24 * S * log(A / delta) / n,
    "offline_radius_known": lambda S, A, n, delta: sqrt(6 * S * log(A / delta) / n),
    "kappa": lambda B, W: 2 + 2 * cosh(B * W),
    "kappa_differences": lambda B, W: 4 * cosh(B * W) ** 2,
    "kappa_nonnegative": lambda B, W: 4 * cosh(B * W / sqrt(2)) ** 2,
    "concentrability_sharp": _sharp_concentrability,
    "concentrability_deterministic": lambda R, gamma_min: 1 + R / gamma_min,
    "row_error_at_step": lambda R: R * (2 - R),
    "row_error_summed": lambda R, H: R * (1 + (H - 1) * (2 - R)),
    "mle_finite_repaired": lambda n, delta, class_size: log((class_size - 1) / delta) / n,
    "mle_finite_sharp": lambda n, delta, class_size: 1 - (delta / (class_size - 1)) ** (1 / n),
    "mle_covering_repaired": lambda n, delta, log_covering, epsilon: (
        2 * (log_covering + log(1 / delta)) / n + 2 * epsilon
    ),
    "mle_misspecified_repaired": lambda n, delta, log_covering, epsilon, chi2: (
        3 * (log(2) + log_covering + log(1 / delta)) / n + 2 * epsilon + log(1 + chi2)
    ),
    "policy_error_repaired": lambda S, n, delta: (S * log(2) + log(1 / delta)) / n,
    "policy_error_sharp": lambda S, n, delta: 1 - (delta / (2**S - 1)) ** (1 / n),
    "missing_mass_expected": lambda S, n: S * (n / (n + 1)) ** n / (n + 1),
    "missing_mass_good_turing": lambda n, singletons, delta: (
        singletons / n + (2 * sqrt(2) + sqrt(3)) * sqrt(log(3 / delta) / n)
    ),
    "missing_mass_observed": lambda S, n, unvisited, delta: 1 - (delta / (S * comb(S, unvisited))) ** (1 / n),
    "offline_radius_mass": lambda mass: sqrt(mass),
    "offline_radius_closed": lambda: 0.0,
    "trajectory_error_symmetrised": lambda occupancy, occupancy_hat, row_errors: (
        sum((d + d_hat) * h for d, d_hat, h in zip(occupancy, occupancy_hat, row_errors, strict=True)) / 2
    ),
    "trajectory_error_one_sided": lambda occupancy, row_errors: (
        297 * sum(d * h for d, h in zip(occupancy, row_errors, strict=True)) / 100
    ),
    "transition_kl_budget": lambda S, counts, delta: _budget(S, counts, delta),
    "trajectory_kl": lambda S, counts, ratio, delta: ratio * _budget(S, counts, delta),
    "transition_error_counts": lambda S, n, counts, delta: 1 - exp(-_budget(S, (*counts, n), delta) / (2 * n)),
    "policy_kl_budget": lambda A, visits, delta: _budget(A, visits, delta),
    "offline_radius_stochastic": lambda A, n, visits, delta: sqrt(1 - exp(-_budget(A, visits, delta) / (2 * n))),
    "transition_log_covering_repaired": lambda S, rows, epsilon: rows * _lattice(S, ceil((S - 1) / (exp(epsilon) - 1))),
    "transition_error_repaired": lambda S, H, n, delta, rows: (
        2 * log(1 / delta) / n
        + min(2 * rows * _lattice(S, k) / n + 2 * H * log(1 + (S - 1) / k) for k in range(1, 2000))
    ),
    "confidence_set_radius_repaired": lambda R1, R2: sqrt(R1) + 2 * sqrt(R2),
    "confidence_set_radius_deterministic": lambda R1, R2: sqrt(R1) + sqrt(2 * R2),
    "confidence_set_radius_angle": lambda R1, R2: sin(min(pi / 2, asin(sqrt(R1)) + acos(1 - R2))),
    "hellinger_from_kl": lambda kl: 1 - exp(-kl / 2),
    "hellinger_from_kl_with_exits": lambda kl, exit_mass: (
        1 - (1 - exit_mass) * exp(-(kl + exit_mass * log(1 / exit_mass)) / (2 * (1 - exit_mass)))
    ),
    "transition_log_covering_closed_form": lambda S, rows, epsilon: (
        rows * (S - 1) * (1 + log(1 / (exp(epsilon) - 1) + 3))
    ),
    "transition_error_closed_form": lambda S, H, n, delta, rows: (
        2 * rows * (S - 1) * (log(n * H / (rows * (S - 1)) + 3) + 2) / n + 2 * log(1 / delta) / n
    ),
    "mean_difference_sharp": lambda B, R: 2 * B * sqrt(R * (2 - R)),
    "covariance_difference_sharp": _covariance,
    "feature_difference_repaired": lambda B, radius: 2 * B * sin(min(pi / 2, 2 * acos(1 - radius**2))),
    "feature_difference_deterministic": lambda B, radius: 2 * B * min(1, 2 * radius**2),
}
"""The right-hand sides, as the paper or the repaired theorem prints them."""


def formulas(*, names: tuple[str, ...] = (), factor: float = 1.0) -> Outcome:
    """The named formulas (all of them by default) agree with their text at two points; ``factor`` changes the text."""
    tally = Tally()
    for name in names or tuple(TEXT):
        formula = getattr(bridge_theory, name)
        for point in _POINTS:
            values = {key: point[key] for key in formula.parameters}
            expected = factor * TEXT[name](**values)
            value = float(formula.estimate(**values))
            agree = abs(value - expected) <= _ROUNDING * max(abs(expected), 1e-3)
            tally.expect(bool(agree), f"{name} is {value!r}, its text says {expected!r}")
    return tally.outcome("bridge_theory agrees with a second transcription")


def compositions(*, half: float = 0.5) -> Outcome:
    """The composed proved radii: T7(b) and T11 at delta/2 each, put together by T9."""
    from bridge_theory import offline_radius_repaired, offline_radius_repaired_angle, transition_error_repaired

    tally = Tally()
    for S, H, n, rows, delta in ((5, 8, 900, 5, 0.05), (3, 2, 4000, 12, 0.3)):
        r2 = float(transition_error_repaired.estimate(S=S, H=H, n=n, delta=half * delta, rows=rows))
        plain = sqrt((S * log(2) + log(1 / (half * delta))) / n) + sqrt(2 * r2)
        angle = TEXT["confidence_set_radius_angle"](R1=1 - (half * delta / (2**S - 1)) ** (1 / n), R2=r2)
        for formula, expected in ((offline_radius_repaired, plain), (offline_radius_repaired_angle, angle)):
            value = float(formula.estimate(S=S, H=H, n=n, delta=delta, rows=rows))
            tally.expect(
                bool(abs(value - expected) < _ROUNDING), f"{formula.name} is {value!r} instead of {expected!r}"
            )
    return tally.outcome("composed radii")
