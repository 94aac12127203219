"""What stands beside a bound, typed a second time: where it becomes trivial, and what failure probability it spends."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import exp, log2
from typing import Any

import bridge_theory
from bridge_theory.arithmetic.floats import FLOATS
from proofs_checks.online.checks.transcription import POINTS
from proofs_checks.outcome import Outcome, Tally

_REGRETS = (
    "regret_known_from_sum", "regret_known_stated", "regret_known_apriori", "regret_known_repaired", "regret_known_log",
    "regret_known_version_space", "regret_known_deterministic", "regret_offline", "regret_unknown_stated",
    "regret_unknown_squared", "regret_unknown_repaired", "regret_unknown_covered", "regret_unknown_version_space",
)  # fmt: skip
_CAPPED = ("xi", "xi_bar", "xi_repaired", "empirical_bonus", "expected_bonus", "transition_bonus")
_PROBABILITIES = (
    "coverage_failure", "exact_recovery_failure", "delta_n_known", "delta_n_known_deterministic", "delta_n_unknown",
    "delta_n_unknown_deterministic", "delta_n_version_space", "delta_n_version_space_sharp",
    "containment_failure_known", "containment_failure_unknown",
)  # fmt: skip

TRIVIAL: Mapping[str, Callable[..., float]] = {
    **dict.fromkeys(_REGRETS, lambda B, W, T: 2 * B * W * T),
    **dict.fromkeys(_CAPPED, lambda eta: 2 * eta),
    **dict.fromkeys(_PROBABILITIES, lambda: 1),
    "bonus_radius": lambda: 2,
    "reach_size": lambda S, A: S * A,
    "covered_bonus": lambda eta, H: 2 * eta * (H - 1),
    "squared_bonus_sum_stated": lambda eta, T, H: T * (H - 1) * (2 * eta) ** 2,
    "bonus_sum_stated": lambda B, W, T, H: T * (H - 1) * 2 * (8 * H * W * B),
    "squared_bonus_sum_repaired": lambda eta, T, H: 2 * T * (H - 1) * (2 * eta) ** 2,
    "bonus_sum_repaired": lambda eta, T, H: 2 * T * (H - 1) * 2 * eta,
    "squared_true_bonus_sum_repaired": lambda eta, T, H: 2 * T * ((H - 1) * 2 * eta) ** 2,
    "martingale_repaired": lambda eta, T, H: T * (H - 1) * 2 * eta,
    "radius_sum": lambda T, H: 2 * T * (H - 1) * 2,
    "radius_sum_covered": lambda T, H: 2 * T * (H - 1) * 2,
}
"""What is known without the statement."""

_NORM_RELATION = ("alpha_dT", "gamma_known", "regret_known_from_sum")
_FIVE_EVENTS = ("gamma_unknown", "gamma_true_bonus", "regret_unknown_stated")


def _uncovered(S_reach: float, n: float, gamma_min: float) -> float:
    return S_reach * exp(-n * gamma_min / 8)


FAILURE: Mapping[str, Callable[..., float]] = {
    **dict.fromkeys(_NORM_RELATION, lambda delta, T: delta + delta * log2(T)),
    **dict.fromkeys(_FIVE_EVENTS, lambda delta: 5 * delta),
    "regret_unknown_squared": lambda delta, T: delta * (4 + log2(T)),
    "squared_bonus_sum_stated": lambda delta_martingale: 2 * delta_martingale,
    "squared_true_bonus_sum_stated": lambda delta_martingale: 2 * delta_martingale,
    "played_bonus_sum_stated": lambda delta: 2 * delta,
    "martingale_repaired": lambda delta_martingale, **k: delta_martingale + _uncovered(**k),
    "radius_sum_covered": lambda delta_P, delta_M, **k: delta_P + delta_M + _uncovered(**k),
    "regret_unknown_covered": lambda delta_w, delta_F, delta_P, delta_M, **k: (
        delta_w + delta_F + delta_P + delta_M + _uncovered(**k)
    ),
}
"""How much failure probability a statement spends, where that is not simply the sum of its deltas."""


def companions(*, factor: float = 1.0) -> Outcome:
    """Trivial values and failure probabilities agree with their text."""
    tally = Tally()
    for kind, texts in (("trivial", TRIVIAL), ("failure", FAILURE)):
        for name, text in texts.items():
            stored = getattr(getattr(bridge_theory, name), kind)
            for point in POINTS:
                value, expected = _value(stored, point), factor * _value(text, point, _value_names(stored))
                tally.expect(
                    bool(abs(value - expected) <= 1e-12 * expected), f"{kind} of {name}: {value}, not {expected}"
                )
    return tally.outcome(f"{len(TRIVIAL)} trivial values and {len(FAILURE)} failure probabilities")


def _value_names(function: Any) -> tuple[str, ...]:
    code = getattr(function, "__code__", None)
    return tuple(name for name in code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]) if code else ()


def _value(function: Any, point: Mapping[str, Any], extra: tuple[str, ...] = ()) -> float:
    """A number as it is; a function at the parameters it names, the package's with its arithmetic first."""
    if not callable(function):
        return float(function)
    names = _value_names(function)
    takes_all = bool(function.__code__.co_flags & 0x08)
    wanted = {name: point[name] for name in (*names, *(extra if takes_all else ())) if name in point}
    return float(function(FLOATS, **wanted) if "m" in names else function(**wanted))
