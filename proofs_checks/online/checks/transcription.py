"""The online formulas typed a second time from the paper and from the repaired theorems, against bridge_theory.

This is no evidence for a statement, but for its transcription: a changed constant, sign or operator in bridge_theory
disagrees with the text here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import ceil, cosh, e, exp, log, sqrt
from typing import Any

import bridge_theory
from proofs_checks.outcome import Outcome, Tally

_ROUNDING = 1e-10

# Three points on which the branches of the formulas below go different ways.
POINTS: tuple[Mapping[str, Any], ...] = (
    {"S": 5, "A": 4, "H": 8, "n": 300, "T": 700, "t": 40, "K": 3, "d": 3, "B": 1.5, "W": 0.7, "lam": 0.8, "N": 900,
     "eta": 1.3, "epsilon": 0.2, "delta": 0.05, "delta_w": 0.04, "delta_V": 0.03, "delta_P": 0.02, "delta_F": 0.06,
     "delta_M": 0.07, "delta_off": 0.08, "delta_martingale": 0.09, "gamma_min": 0.1, "S_reach": 6, "uncovered": 2,
     "log_covering": 9.0, "Delta_n": 0.3, "radius": 0.3, "R2": 0.03, "diameter": 0.9, "square_sum": 7.0, "L": 1.7,
     "v": 0.6, "gamma": 5.0, "norm_sum": 2.5, "bonus_square_sum": 3.5, "log_det_ratio": 2.2, "residual": 0.4,
     "occupancy": (6.0, 0.75, 0.25), "counts": (4000, 900, 0),
     "true_bonus": 1.9, "optimism": 3.0, "norm": 2.0, "bonus_sum": 1.1, "width_sum": 4.4, "potential": 1.6, "C": 1.7},
    {"S": 2, "A": 3, "H": 3, "n": 10**5, "T": 9, "t": 3, "K": 1, "d": 2, "B": 0.4, "W": 2.5, "lam": 3.0, "N": 20,
     "eta": 0.6, "epsilon": 0.7, "delta": 0.3, "delta_w": 0.2, "delta_V": 0.25, "delta_P": 0.35, "delta_F": 0.15,
     "delta_M": 0.1, "delta_off": 0.12, "delta_martingale": 0.22, "gamma_min": 0.9, "S_reach": 2, "uncovered": 0,
     "log_covering": 4.0, "Delta_n": 0.001, "radius": 0.01, "R2": 0.0002, "diameter": 0.05, "square_sum": 0.4, "L": 0.3,
     "v": 2.0, "gamma": 30.0, "norm_sum": 0.5, "bonus_square_sum": 0.2, "log_det_ratio": 0.3, "residual": 0.0,
     "occupancy": (0.5, 1.5), "counts": (10**5, 20),
     "true_bonus": 0.3, "optimism": 9.0, "norm": 0.1, "bonus_sum": 0.7, "width_sum": 0.3, "potential": 0.2, "C": 0.4},
    {"S": 3, "A": 2, "H": 2, "n": 50, "T": 10**7, "t": 7, "K": 2, "d": 1, "B": 1.0, "W": 0.8, "lam": 1.2, "N": 5,
     "eta": 0.9, "epsilon": 0.4, "delta": 0.11, "delta_w": 0.21, "delta_V": 0.31, "delta_P": 0.12, "delta_F": 0.22,
     "delta_M": 0.32, "delta_off": 0.13, "delta_martingale": 0.23, "gamma_min": 0.4, "S_reach": 4, "uncovered": 1,
     "log_covering": 2.0, "Delta_n": 0.9, "radius": 0.9, "R2": 0.8, "diameter": 1e-6, "square_sum": 3.0, "L": 0.0,
     "v": 1.1, "gamma": 2.0, "norm_sum": 0.7, "bonus_square_sum": 0.6, "log_det_ratio": 0.1, "residual": 0.9,
     "occupancy": (1.0, 0.0), "counts": (1, 5),
     "true_bonus": 0.8, "optimism": 0.2, "norm": 8.0, "bonus_sum": 0.4, "width_sum": 0.9, "potential": 0.5, "C": 2.1},
)  # fmt: skip

_C = e / (e - 1)


def _kappa(B: float, W: float) -> float:
    return 2 + 2 * cosh(B * W)


def _steep(B: float, W: float) -> float:
    return 2 + 2 * cosh(2 * B * W)


def _beta(B: float, W: float, lam: float, d: float, t: float, delta: float) -> float:
    return sqrt(lam) * W + sqrt(log(1 / delta) + 2 * d * log(1 + t * B**2 / (_kappa(B, W) * lam * d)))


def _alpha(B: float, W: float, d: float, T: float, delta: float) -> float:
    return 20 * B * W * sqrt(d * log(T * (1 + 2 * T) / delta))


def _gamma(B: float, W: float, lam: float, d: float, t: float, T: float, delta: float) -> float:
    return 4 * _kappa(B, W) * _beta(B, W, lam, d, t, delta) + _alpha(B, W, d, T, delta)


def _width(B: float, W: float, lam: float, delta_w: float, log_det_ratio: float) -> float:
    return sqrt(lam / _steep(B, W)) * W + sqrt(2 * log(1 / delta_w) + log_det_ratio) / 2


def _closed(B: float, W: float, lam: float, d: float, seen: float, delta_w: float) -> float:
    return _width(B, W, lam, delta_w, d * log(1 + 4 * seen * B**2 / (_steep(B, W) * lam * d)))


def _relation(B: float, W: float, lam: float, d: float, t: float, T: float, delta_w: float, delta_V: float) -> float:
    root = 2 * W * sqrt(27 * B**2 * d * log((1 + 2 * T) / delta_V))
    return 2 * sqrt(2) * _steep(B, W) * _closed(B, W, lam, d, t - 1, delta_w) + root


def _relation_sharp(
    B: float, W: float, lam: float, d: float, t: float, T: float, delta_w: float, delta_V: float
) -> float:
    shift = 4 * _C * B**2 * (d * log(1 + 2 * T) + log(1 / delta_V)) + 8 * (1 + _C) * B**2
    return 2 * sqrt(_C) * _steep(B, W) * _closed(B, W, lam, d, t - 1, delta_w) + 2 * W * sqrt(shift)


def _xi(S: float, A: float, H: float, eta: float, delta: float, N: float, cover: float = 0.0) -> float:
    return min(2 * eta, 4 * eta * sqrt((H * log(S * A) + cover + log(6 * log(N) / delta)) / N))


def _radius(S: float, A: float, delta_P: float, N: float) -> float:
    return min(2.0, sqrt(2 * (S * log(2) + log(S * A * N * (N + 1) / delta_P)) / N)) if N else 2.0


def _covered(H: float, eta: float, log_covering: float, n: float, gamma_min: float, Delta_n: float) -> float:
    return (H - 1) * 4 * eta * sqrt(2 * log_covering / (n * gamma_min)) + 2 * eta * (H - 1) * Delta_n


ONLINE: Mapping[str, Callable[..., float]] = {
    "kappa": _kappa,
    "kappa_differences": _steep,
    "kappa_nonnegative": lambda B, W: _steep(B / sqrt(2), W),
    "beta_t": _beta,
    "confidence_radius": lambda B, W, lam, d, t, delta: 2 * _kappa(B, W) * _beta(B, W, lam, d, t, delta),
    "beta_repaired_logdet": _width,
    "beta_repaired": lambda B, W, lam, d, t, K, delta_w: _closed(B, W, lam, d, K * (t - 1), delta_w),
    "confidence_radius_repaired": lambda B, W, lam, delta_w, log_det_ratio, residual: (
        _steep(B, W) * (_width(B, W, lam, delta_w, log_det_ratio) + residual)
    ),
    "confidence_radius_nonnegative": lambda B, W, lam, delta_w, log_det_ratio, residual: (
        _steep(B / sqrt(2), W) * (_width(B / sqrt(2), W, lam, delta_w, log_det_ratio) + residual)
    ),
    "matrix_shift": lambda B, d, T, delta: 84 * B**2 * d * log((1 + 2 * T) / delta),
    "alpha_dT": _alpha,
    "gamma_known": _gamma,
    "norm_relation": _relation,
    "norm_relation_sharp": _relation_sharp,
    "gamma_unknown": lambda bonus_square_sum, t, **k: sqrt(2) * _gamma(t=t, **k) + 2 * sqrt(bonus_square_sum) + 1 / t,
    "gamma_unknown_repaired": lambda bonus_square_sum, delta_P, **k: (
        sqrt(2) * _relation(**k) + 2 * sqrt(bonus_square_sum)
    ),
    "online_bonus_delta": lambda S, A, delta: delta / (2 * A**S),
    "net_scale": lambda B, W, lam, t: 1 / (t**2 * _kappa(B, W) * lam + 4 * B**2 * t**3),
    "net_delta": lambda W, d, epsilon, delta: delta / (1 + 4 * W / epsilon) ** d,
    "step_bonus_delta": lambda S, A, t, delta: delta / (8 * t**3 * A**S),
    "xi": _xi,
    "xi_repaired": _xi,
    "xi_bar": lambda S, A, H, eta, delta, epsilon, N: _xi(S, A, H, eta, delta, N, S * log(ceil(4 * eta * H / epsilon))),
    "bonus_radius": _radius,
    "transition_bonus": lambda S, A, eta, delta_P, occupancy, counts: (
        eta * min(2.0, sum(q * _radius(S, A, delta_P, N) for q, N in zip(occupancy, counts, strict=True)))
    ),
    "estimated_radius_sum": lambda H, delta_P, true_bonus: H * true_bonus,
    "empirical_from_true_bonus": lambda true_bonus, epsilon, delta: 2 * true_bonus + epsilon,
    "empirical_from_true_bonus_sharp": lambda H, true_bonus, epsilon, delta: (1 + 1 / H) * true_bonus + epsilon,
    "reach_size": lambda S, A, H, gamma_min: min(S * A, H / gamma_min),
    "coverage_failure": lambda S_reach, n, gamma_min: S_reach * exp(-n * gamma_min / 8),
    "covered_bonus": _covered,
}
"""Sections "Elliptical confidence set" to "Transition estimation", and R1, R6, R9, R10."""


def formulas(*, names: tuple[str, ...] = (), factor: float = 1.0) -> Outcome:
    """The named formulas agree with their text at the points where they are defined; ``factor`` changes the text."""
    from bridge_theory.errors import InputError
    from proofs_checks.online.checks.transcription_regret import REGRET

    tally = Tally()
    for name in names:
        formula, text = getattr(bridge_theory, name), {**ONLINE, **REGRET}[name]
        for point in POINTS:
            values = {key: point[key] for key in formula.parameters}
            try:
                value = float(formula.estimate(**values))
            except InputError:
                continue  # a condition of the statement excludes this point; one must remain
            expected = factor * text(**values)
            agree = abs(value - expected) <= _ROUNDING * max(abs(expected), 1e-9)
            tally.expect(bool(agree), f"{name} is {value!r}, its text says {expected!r}")
    tally.expect(tally.decisions >= len(names), "some formula is excluded everywhere")
    return tally.outcome(f"{len(names)} formulas agree with a second transcription")


def edges(*, shift: float = 1e-6) -> Outcome:
    """Conditions of the statements hold up to their printed limits and fail just beyond."""
    from bridge_theory.errors import InputError

    point = {**POINTS[0], "T": 700, "delta": 0.2}
    H, eta, B, W = (point[name] for name in ("H", "eta", "B", "W"))
    limits = (
        ("offline_bonus_log_term", "epsilon", 4 * eta * H),
        ("squared_bonus_sum_stated", "epsilon", 4 * eta * H),
        ("bonus_sum_stated", "epsilon", 32 * H**2 * W * B),
        ("played_bonus_sum_stated", "epsilon", 32 * H**2 * W * B),
        ("regret_known_stated", "delta", exp(-1)),
        ("regret_known_stated", "lam", B / _kappa(B, W)),
    )
    tally = Tally()
    for name, parameter, limit in limits:
        formula, inward = getattr(bridge_theory, name), -1 if parameter != "lam" else 1
        for direction, wanted in ((inward, True), (-inward, False)):
            values = {key: point[key] for key in formula.parameters} | {parameter: limit * (1 + direction * shift)}
            try:
                formula.estimate(**values)
                allowed = True
            except InputError:
                allowed = False
            tally.expect(allowed == wanted, f"{name} at {parameter} = {values[parameter]} is allowed: {allowed}")
    from proofs_checks.online.checks.transcription_regret import REGRET

    for name in ("squared_bonus_sum_repaired", "bonus_sum_repaired"):
        for n in (223, 224):  # n gamma_min / 2 passes the batch size 2 (H - 1) = 14 at 224
            formula = getattr(bridge_theory, name)
            values = {key: point[key] for key in formula.parameters} | {"n": n, "gamma_min": 0.125}
            value, expected = float(formula.estimate(**values)), REGRET[name](**values)
            tally.expect(bool(abs(value - expected) <= _ROUNDING * expected), f"{name} is {value} at n = {n}")
    return tally.outcome("limits of the conditions")


def tables(*, factor: float = 1.0) -> Outcome:
    """The bonuses of a policy are sums over a table of occupancies and counts."""
    size = {"S": 5, "A": 4, "H": 8, "eta": 1.3, "delta": 0.05}
    occupancy, counts = (6.0, 0.75, 0.25), (4000, 900, 30)
    tally = Tally()
    cells = list(zip(occupancy, counts, strict=True))
    cover = 5 * log(ceil(4 * 1.3 * 8 / 0.2))
    radii = sum(q * _radius(5, 4, 0.05, N) for q, N in cells)
    for name, expected, extra in (
        ("empirical_bonus", sum(q * _xi(N=N, **size) for q, N in cells), size),
        ("expected_bonus", sum(q * _xi(N=N, cover=cover, **size) for q, N in cells), {**size, "epsilon": 0.2}),
        ("transition_bonus", 1.3 * min(2.0, radii), {"S": 5, "A": 4, "eta": 1.3, "delta_P": 0.05}),
    ):
        value = float(getattr(bridge_theory, name).estimate(occupancy=occupancy, counts=counts, **extra))
        wanted = factor * expected
        tally.expect(bool(abs(value - wanted) <= _ROUNDING * wanted), f"{name} is {value!r}, not {wanted!r}")
    for uses, wanted in ((0.5, 1.3), (5.0, 2 * 1.3)):  # an unseen cell has radius 2, and no bonus exceeds 2 eta
        unseen = bridge_theory.transition_bonus.estimate(
            occupancy=(uses,), counts=(0,), S=5, A=4, eta=1.3, delta_P=0.05
        )
        tally.expect(bool(abs(float(unseen) - factor * wanted) < _ROUNDING), f"an unseen cell costs {unseen}")
    for N in (0, 1):
        value = float(bridge_theory.xi_repaired.estimate(N=N, **size))
        tally.expect(bool(abs(value - factor * 2.6) < _ROUNDING), f"xi_repaired is {value} at N = {N}")
    return tally.outcome("bonuses of a policy")
