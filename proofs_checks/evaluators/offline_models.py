"""Two kernels and two policies on one state space: the steps of the offline analysis, from whole trajectory laws.

A law includes the arrival after the last action, so that ``horizon`` counts transitions, as in the paper's appendix.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from fractions import Fraction
from math import prod
from typing import Any

from bridge_theory.arithmetic.flint_balls import ball, working_precision
from bridge_theory.errors import InputError
from proofs_checks.counterexample import Number, evaluates
from proofs_checks.evaluators.offline_numbers import log, side
from proofs_checks.evaluators.online_numbers import enclosed
from proofs_checks.exact.laws import (
    Choice,
    History,
    Law,
    Row,
    deterministic,
    occupancies,
    row_hellinger,
    squared_hellinger,
    stationary_policy,
)
from proofs_checks.exact.model import Model, fractions_of, kernel_of, point, probability_row
from proofs_checks.exact.surd import Surd, root, surd

TRUE, ESTIMATED = "P^*", "\\hat P"
EXPERT, OTHER = "\\pi^*", "\\pi"


def model(data: Mapping[str, Any], kernel: str = TRUE) -> Model:
    """The model with one of the instance's kernels."""
    return Model(probability_row(data["initial"]), kernel_of(data["kernels"][kernel]), int(data["horizon"]))


def policy(data: Mapping[str, Any], name: str) -> Choice:
    """One of the instance's policies: an action per state, a row per state, or a row per pattern of histories.

    A history is written with the names of states and actions, ``"s a x"``; the first pattern that fits it counts, and
    ``*`` in a pattern stands for anything.
    """
    table = data["policies"][name]
    if isinstance(table, Mapping):
        return _by_pattern(data, {pattern: probability_row(row) for pattern, row in table.items()})
    if isinstance(table[0], list):
        return stationary_policy([probability_row(row) for row in table])
    return deterministic([int(action) for action in table], len(data["kernels"][next(iter(data["kernels"]))][0]))


def _by_pattern(data: Mapping[str, Any], rows: Mapping[str, Row]) -> Choice:
    names = data["states"], data["actions"]

    def choice(history: History) -> Row:
        written = " ".join(names[i % 2][x] for i, x in enumerate(history))
        fitting = (row for pattern, row in rows.items() if fnmatchcase(written, pattern))
        if (row := next(fitting, None)) is None:
            raise InputError(f"no pattern of the policy fits the history {written!r}.")
        return row

    return choice


def law(data: Mapping[str, Any], kernel: str, name: str, *, arrival: bool = True) -> Law:
    """The trajectory law of a kernel and a policy."""
    return model(data, kernel).law(policy(data, name), arrival=arrival)


def trajectory_error(data: Mapping[str, Any], name: str) -> Surd:
    """H^2 between the estimated and the true law of one policy."""
    return squared_hellinger(law(data, ESTIMATED, name), law(data, TRUE, name))


def row_errors(data: Mapping[str, Any], name: str) -> list[Surd]:
    """E_{d_t} H^2(P-hat, P*) of the rows, one number a step, under the truth and one policy."""
    true, estimate = model(data), model(data, ESTIMATED)
    return [
        sum((row_hellinger(true.kernel[s][a], estimate.kernel[s][a]) * p for (s, a), p in d.items()), surd(0))
        for d in occupancies(law(data, TRUE, name), true.horizon)
    ]


def concentrability(data: Mapping[str, Any]) -> Fraction:
    """sup_t sup_{d* > 0} d/d*."""
    horizon = int(data["horizon"])
    expert, other = (occupancies(law(data, TRUE, name), horizon) for name in (EXPERT, OTHER))
    return max(o.get(key, Fraction(0)) / p for e, o in zip(expert, other, strict=True) for key, p in e.items())


@evaluates("offline-technical-lemma")
def technical_lemma(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """H^2 for the other policy, and H C H^2 for the expert; ``H`` in the data counts otherwise than transitions."""
    scale = int(data.get("H", data["horizon"])) * concentrability(data)
    return side(trajectory_error(data, OTHER)), side(trajectory_error(data, EXPERT) * scale)


@evaluates("offline-full-support")
def full_support(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """The technical lemma's sides; refused unless the expert visits at every step every pair that the policy visits."""
    horizon = int(data["horizon"])
    expert, other = (occupancies(law(data, TRUE, name), horizon) for name in (EXPERT, OTHER))
    if any(set(o) - set(e) for e, o in zip(expert, other, strict=True)):
        raise InputError("the policy visits a pair that the expert does not; the support is not full.")
    return technical_lemma(data)


@evaluates("offline-root-two")
def root_two(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """H(P-hat^pi*, P-hat^pi), and sqrt(R1) + sqrt(2 R2), enclosed."""
    k, r1 = (squared_hellinger(law(data, kernel, EXPERT), law(data, kernel, OTHER)) for kernel in (ESTIMATED, TRUE))
    r2 = trajectory_error(data, EXPERT)
    with working_precision(256):
        roots = [value.ball().sqrt() if value > 0 else ball(0) for value in (k, r1, r2 * 2)]
        return enclosed(roots[0]), enclosed(roots[1] + roots[2])


@evaluates("offline-step-1")
def step_1(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """H^2 of the trajectories, and the sum over steps of the expected row errors."""
    return side(trajectory_error(data, EXPERT)), side(sum(row_errors(data, EXPERT), surd(0)))


@evaluates("offline-product-formula")
def product_formula(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """H^2 of the trajectories, and 1 - prod_t E_{d_t} gamma_t."""
    return side(trajectory_error(data, EXPERT)), side(
        1 - prod((1 - e for e in row_errors(data, EXPERT)), start=surd(1))
    )


@evaluates("offline-step-2")
def step_2(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """E_{d_t} of the row error for the other policy, and C times that for the expert, at step ``step``."""
    step = int(data["step"]) - 1
    return side(row_errors(data, OTHER)[step]), side(row_errors(data, EXPERT)[step] * concentrability(data))


@evaluates("offline-step-3")
def step_3(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """H^2 of the trajectories, and a share 1/H of the summed row errors, where the sum is at most 2(H - 1)/H."""
    horizon, total = int(data["horizon"]), sum(row_errors(data, EXPERT), surd(0))
    if total > Fraction(2 * (horizon - 1), horizon):
        raise InputError(f"the row errors sum to {total}, above the paper's condition 2(H - 1)/H.")
    return side(trajectory_error(data, EXPERT)), side(total * Fraction(1, horizon))


@evaluates("offline-matrix-power")
def matrix_power(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """1 - sum_i [M^H d_0]_i as printed, and H^2 by enumeration; two deterministic policies."""
    first = second = model(data)
    one, two = (data["policies"][name] for name in (EXPERT, OTHER))
    size = first.n_states
    matrix = [
        [root(first.kernel[s][one[s]][p] * second.kernel[s][two[s]][p]) * int(one[s] == two[s]) for p in range(size)]
        for s in range(size)
    ]
    x = [surd(p) for p in first.initial]
    for _ in range(first.horizon):
        x = [sum((entry * value for entry, value in zip(row, x, strict=True)), surd(0)) for row in matrix]
    enumerated = squared_hellinger(
        first.law(policy(data, EXPERT), arrival=True), second.law(policy(data, OTHER), arrival=True)
    )
    return side(1 - sum(x, surd(0))), side(enumerated)


@evaluates("offline-rarest-visit")
def rarest_visit(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """gamma_min of the first policy and of the second."""
    values = []
    for name in (EXPERT, OTHER):
        steps = occupancies(law(data, TRUE, name, arrival=False), int(data["horizon"]))
        values.append(min(p for step in steps for p in step.values()))
    return values[0], values[1]


@evaluates("offline-feature-difference")
def feature_difference(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """||phi(pi_1) - phi(pi_2)||^2 of two policies of the stated confidence set, and 32 B^2/n.

    Refused unless the theorem's radius is below 1 and both policies lie within it of the clone.
    """
    n, b = int(data["n"]), Fraction(data["B"])
    estimate = model(data, ESTIMATED)
    clone, *pair = (law(data, ESTIMATED, name, arrival=False) for name in ("\\widehat\\pi", "\\pi_1", "\\pi_2"))
    feature = {tuple(int(x) for x in key.split()): Fraction(v) for key, v in data["features"].items()}
    if max(abs(value) for value in feature.values()) > b:
        raise InputError(f"a feature is larger than B = {b}.")
    rarest = min(p for d in occupancies(clone, estimate.horizon) for p in d.values())
    with working_precision(128):
        s, a, h, delta = estimate.n_states, estimate.n_actions, estimate.horizon, Fraction(data["delta"])
        alpha = (4 * s * log(2 * a / delta)).sqrt() / ball(n).sqrt()
        beta = (4 * s * s * a * log(2 * n * h / delta)).sqrt() / ball(n).sqrt()
        radius = alpha + beta * (1 + (h * (1 + 2 * alpha / ball(rarest))).sqrt())
        if not (radius < 1 and all(squared_hellinger(clone, x).ball() <= radius**2 for x in pair)):
            raise InputError("the radius is not below 1, or a policy lies outside the set.")
    means = [_mean(x, feature) for x in pair]
    return (means[0] - means[1]) ** 2, 32 * b**2 / n


def _mean(trajectories: Law, feature: Mapping[History, Fraction]) -> Fraction:
    return sum((p * feature.get(h[-2:], Fraction(0)) for h, p in trajectories.items()), Fraction(0))


@evaluates("offline-estimate-from-data")
def estimate_from_data(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """H^2(P-hat^pi*, P-hat^BC) for two readings of the estimator: what follows the last action, or the empty rows.

    ``readings`` are two pairs (state after the last action or "", default row); everything else is the same data.
    """
    first, second = (_distance_under_reading(data, *reading) for reading in data["readings"])
    return first, second


def _distance_under_reading(data: Mapping[str, Any], last: str, default: Sequence[str]) -> Number:
    size, actions = len(data["initial"]), int(data["n_actions"])
    counts = [[[0] * size for _ in range(actions)] for _ in range(size)]
    for recorded in data["demonstrations"]:
        states, played = recorded[::2], recorded[1::2]
        following = [*states[1:], *([int(last)] if last else [])]
        for s, a, p in zip(states, played, following, strict=False):
            counts[s][a][p] += 1
    start = fractions_of(data["initial"])
    kernel = tuple(
        tuple(
            tuple(Fraction(c, sum(row)) for c in row)
            if sum(row)
            else (fractions_of(default) if default else tuple(point(s, size)))
            for row in counts[s]
        )
        for s in range(size)
    )
    estimate = Model(start, kernel, int(data["horizon"]))
    expert, clone = (estimate.law(data["policies"][name]) for name in (EXPERT, "\\widehat\\pi"))
    return side(squared_hellinger(expert, clone))
