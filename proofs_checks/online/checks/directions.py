"""The directions that ``solve_for`` relies on: derivatives of formulas have the declared sign on whole intervals.

One parameter runs over an interval of real numbers, the others stand at a reference setting. The sign is proved on the
interval by ball arithmetic; it is not claimed for other settings of the rest.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from bridge_theory.bound import Bound
from bridge_theory.catalog import all_bounds
from proofs_checks.balls import Exact
from proofs_checks.context import Context
from proofs_checks.outcome import Outcome, Tally

_INTERVALS: dict[str, tuple[Exact, Exact]] = {
    "n": (2, 10**12), "T": (2, 10**9), "t": (2, 10**9), "N": (2, 10**9), "S": (2, 50), "A": (2, 20), "H": (2, 30),
    "d": (1, 50), "K": (1, 10), "B": ("1/10", 10), "W": ("1/10", 1), "lam": ("1/100", 10), "gamma_min": ("1/100", 1),
    "eta": ("1/10", 10), "S_reach": (1, 50),
}  # fmt: skip
_DELTAS: tuple[Exact, Exact] = ("1/1000", "1/2")
_REST: tuple[Exact, Exact] = ("1/100", "9/10")

SETTING: dict[str, Exact] = {
    "S": 5, "A": 4, "H": 8, "n": 1000, "T": 1000, "t": 1000, "d": 3, "B": 1, "W": "1/2", "lam": 8, "gamma_min": "1/10",
    "N": 100, "eta": 1, "K": 1, "S_reach": 5, "uncovered": 3, "log_covering": 30, "R": "1/10", "R1": "1/10",
    "R2": "1/100", "rows": 5, "class_size": 30, "L": 1, "v": 1, "gamma": 10, "square_sum": 10, "unvisited": 2,
    "singletons": 2, "ratio": "1/2", "chi2": "1/2", "log_det_ratio": 1, "norm_sum": 1, "bonus_square_sum": 1,
}  # fmt: skip

_ARRAYS = ("occupancy", "occupancy_hat", "row_errors", "counts", "visits")

_JUMPS = ("squared_bonus_sum_repaired", "bonus_sum_repaired")
_STEPS = (
    "squared_true_bonus_sum_stated", "xi_bar", "concentrability_sharp", "covariance_difference_sharp",
    "transition_log_covering_two_states",
)  # fmt: skip
_NOT_DIFFERENTIATED = (
    "offline_radius_repaired", "offline_radius_repaired_angle", "transition_error_repaired", "missing_mass_observed",
    "transition_log_covering_repaired", "confidence_set_radius_angle", "feature_difference_repaired",
)  # fmt: skip
LEFT_OUT = (*_JUMPS, *_STEPS, *_NOT_DIFFERENTIATED)
"""Formulas with jumps, ceilings or corners at unknown places, and with functions whose derivative is not programmed."""

_SPECIAL: dict[tuple[str, str], tuple[Exact, Exact]] = {
    ("coverage_failure", "n"): (2, 1000),  # beyond, balls cannot tell the exponential from zero
    ("exact_recovery_failure", "n"): (2, 200),
    ("exact_recovery_failure", "gamma_min"): ("1/100", "3/100"),
    ("elliptical_norm_sum", "L"): ("1/2", 10),  # c(a) is flat near a = 0
    ("elliptical_potential", "L"): ("1/2", 10),
    ("potential_factor", "L"): ("1/2", 10),
    ("mle_finite_repaired", "class_size"): (3, 1000),
    ("mle_finite_sharp", "class_size"): (3, 1000),
}


def directions(context: Context, *, group: str = "regret", flipped: bool = False) -> Outcome:
    """Every declared direction of a group in which the derivative can decide; ``flipped`` claims the opposite one."""
    from proofs_checks.slopes import prove_monotone

    parameters = ("n", "T", "N") if context.quick else None
    tally = Tally()
    for bound, parameter in declared(group, parameters):
        claimed = bound.monotone[parameter].direction
        opposite = {"rises": "falls", "falls": "rises"}[claimed] if flipped else claimed
        outcome = prove_monotone(bound, parameter, _box(bound, parameter), opposite, most=3000)  # type: ignore[arg-type]
        tally.expect(outcome.holds, "; ".join(outcome.failures))
    return tally.outcome(f"{tally.decisions} directions of the {group} formulas")


def declared(group: str, parameters: tuple[str, ...] | None = None) -> Iterator[tuple[Bound, str]]:
    """The directions that are checked: all that are declared, without arrays and ``LEFT_OUT``."""
    for bound in all_bounds():
        if bound.group != group or bound.name in LEFT_OUT or any(name in _ARRAYS for name in bound.parameters):
            continue
        yield from ((bound, name) for name in bound.monotone if parameters is None or name in parameters)


def _box(bound: Bound, running: str) -> dict[str, tuple[Exact, Exact]]:
    interval = _SPECIAL.get((bound.name, running)) or _interval(running)
    return {name: interval if name == running else (_value(name),) * 2 for name in bound.parameters}


def _interval(name: str) -> tuple[Exact, Exact]:
    return _DELTAS if name.startswith("delta") else _INTERVALS.get(name, _REST)


def _value(name: str) -> Any:
    return SETTING.get(name, Fraction(1, 20) if name.startswith("delta") else Fraction(1, 10))
