"""What a log says, with its shapes, types and ranges made sure of; whether it is true is decided elsewhere."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge_algos.run.log_file import RunLog
from bridge_theory.errors import InputError
from proofs_checks.verify.enclosed import FloatArray
from proofs_checks.verify.entries import check_probabilities, count, floats, integers, json_object, number, text
from proofs_checks.verify.features import Coordinates, IntArray, coordinates

ALGORITHMS = ("bridge", "bridge-known", "pbrl")
ARRAYS = ("transitions", "initial", "demonstrations/states", "demonstrations/actions")
"""Arrays that all algorithms of a log share."""
OWN_ARRAYS = (
    "policies", "pairs", "states", "actions", "outcomes", "w",
    "gamma", "log_det", "uncertainty", "bonus", "solver_error", "set_size",
)  # fmt: skip
"""Arrays of each algorithm."""
MOST_PAIRS = 3 * 10**10
"""Pairs of policies that are compared in one log: about ten minutes."""
MOST_RESIDUALS = 10**7
"""Comparisons in the estimating equations of all rounds together: about a minute."""

MOST_PRODUCTS = 6 * 10**10
"""Products of balls in the data matrices of all rounds together, d^3 in each: about ten minutes."""

_CHOICES = {
    "confidence": ("fixed", "stated", "repaired", "likelihood"),
    "oracle": ("returns", "bradley-terry"),
    "empty_row": ("self_loop", "uniform"),
    "transition_model": ("counts", "mlp"),
    "pair_rule": ("uncertainty_and_bonus", "max_uncertainty", "ucb", "greedy_vs_random"),
}


@dataclass(frozen=True, eq=False)
class Facts:
    """One algorithm's part of a log.

    Args:
        configuration: the run's, as JSON.
        known: whether the learner knew the dynamics.
        weight_bound, lam, delta, slope: W, lambda, the failure probability of each event, c; exact.
        gamma, bonus_multiplier: of a hand-set confidence set.
        kernel, initial: of the real environment, (S, A, S) and (S,).
        offline: (S, A, S) transitions in the demonstrations that the learner saw.
        table: the embedding.
        policies, pairs, states, actions, outcomes, w, claims: see :mod:`bridge_algos.run.log_file`.
    """

    algorithm: str
    seed: int
    configuration: dict[str, Any]
    known: bool
    weight_bound: Fraction
    lam: Fraction
    delta: Fraction
    slope: Fraction
    gamma: float
    bonus_multiplier: float
    kernel: FloatArray
    initial: FloatArray
    demonstrations: tuple[IntArray, IntArray]
    offline: IntArray
    table: Coordinates
    policies: IntArray
    pairs: IntArray
    states: IntArray
    actions: IntArray
    outcomes: FloatArray
    w: FloatArray
    claims: dict[str, NDArray[Any]]

    @property
    def rounds(self) -> int:
        """T."""
        return len(self.pairs)


def facts(log: RunLog, algorithm: str) -> Facts:
    """Read one algorithm out of a log.

    Raises:
        InputError: for anything that is missing, of another type or shape, not finite, out of range, or too large.
    """
    if algorithm not in ALGORITHMS:
        raise InputError(f"the log names an algorithm {algorithm!r}, expected one of {', '.join(ALGORITHMS)}.")
    arrays, config = log.arrays, json_object(log.header, "configuration")
    kernel = floats(arrays, "transitions", ("S", "A", "S"), {})
    n_states, n_actions, arrivals = kernel.shape
    if arrivals != n_states:
        raise InputError(f"the log's transitions has shape {kernel.shape}, expected (S, A, S).")
    size = {"S": n_states, "A": n_actions, "H": count(log.header, "horizon")}
    initial = floats(arrays, "initial", ("S",), size)
    check_probabilities("transitions", kernel)
    check_probabilities("initial", initial)
    demonstrated = tuple(
        integers(arrays, f"demonstrations/{name}", ("n", "H"), size, size[letter])
        for name, letter in (("states", "S"), ("actions", "A"))
    )
    if demonstrated[0].shape != demonstrated[1].shape:
        raise InputError("the log's demonstrations have states and actions of different shapes.")
    table = coordinates(text(config, "embedding"), n_states, n_actions, size["H"])
    own = f"{algorithm}/"
    policies = integers(arrays, own + "policies", ("N", "S"), size, n_actions)
    pairs = integers(arrays, own + "pairs", ("T", 2), size, len(policies))
    size |= {"T": len(pairs), "T + 1": len(pairs) + 1, "K": count(config, "comparisons"), "d": table.dimension}
    for name, choices in _CHOICES.items():
        if text(config, name) not in choices:
            raise InputError(f"the log's {name} is {reprlib.repr(config[name])}, expected one of {', '.join(choices)}.")
    _affordable(len(policies), size)
    outcomes = floats(arrays, own + "outcomes", ("T", "K"), size, missing=True)
    if not (np.isnan(outcomes) | ((outcomes >= 0) & (outcomes <= 1))).all():
        raise InputError(f"{own}outcomes holds values outside [0, 1].")
    offline = np.zeros((n_states, n_actions, n_states), dtype=np.int64)
    if algorithm == "bridge":
        add_transitions(offline, *demonstrated)
    return Facts(
        algorithm=algorithm,
        seed=count(log.header, "seed", least=0),
        configuration=config,
        known=algorithm == "bridge-known",
        weight_bound=number(log.header, "weight_bound"),
        lam=number(config, "lam"),
        delta=number(config, "delta", 1e-300, 1 - 1e-9),
        slope=number(config, "slope"),
        gamma=float(number(config, "gamma", 0)),
        bonus_multiplier=float(number(config, "bonus_multiplier", 0)),
        kernel=kernel,
        initial=initial,
        demonstrations=(demonstrated[0], demonstrated[1]),
        offline=offline,
        table=table,
        policies=policies,
        pairs=pairs,
        states=integers(arrays, own + "states", ("T", 2, "K", "H"), size, n_states),
        actions=integers(arrays, own + "actions", ("T", 2, "K", "H"), size, n_actions),
        outcomes=outcomes,
        w=floats(arrays, own + "w", ("T + 1", "d"), size),
        claims={
            "gamma": floats(arrays, own + "gamma", ("T",), size),
            "log_det": floats(arrays, own + "log_det", ("T",), size),
            "uncertainty": floats(arrays, own + "uncertainty", ("T",), size),
            "bonus": floats(arrays, own + "bonus", ("T", 2), size),
            "solver_error": floats(arrays, own + "solver_error", ("T + 1",), size),
            "set_size": integers(arrays, own + "set_size", ("T",), size, len(policies) + 1),
        },
    )


def configured_algorithms(log: RunLog) -> list[str]:
    """The algorithms that a log's configuration runs, without the clone, which learns nothing."""
    names = json_object(log.header, "configuration").get("algorithms")
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise InputError(f"the log's configuration runs {reprlib.repr(names)}, expected a list of algorithms.")
    return [name for name in names if name != "bc"]


def add_transitions(counts: IntArray, states: IntArray, actions: IntArray) -> None:
    """Add the H - 1 transitions inside each trajectory (..., H) to counts (S, A, S)."""
    np.add.at(counts, (states[..., :-1], actions[..., :-1], states[..., 1:]), 1)


def _affordable(policies: int, size: Mapping[str, int]) -> None:
    rounds, comparisons, features = size["T"], size["K"], size["d"]
    if features**3 * rounds > MOST_PRODUCTS:
        raise InputError(
            f"the log has {rounds:,} rounds with {features:,} features, which takes hours to check; log a run of fewer "
            "rounds, or with an embedding of fewer features."
        )
    if policies**2 * rounds > MOST_PAIRS:
        raise InputError(
            f"the log compares {policies:,} policies in {rounds:,} rounds, which is too large to check here (at most "
            f"{MOST_PAIRS:.0e} pairs); log a run with a smaller candidate_limit or search_size."
        )
    if rounds**2 * comparisons > MOST_RESIDUALS:
        raise InputError(
            f"the log has {rounds:,} rounds of {comparisons:,} comparisons, which is too long to check here; log a run "
            f"of at most {int((MOST_RESIDUALS / comparisons) ** 0.5):,} rounds."
        )
