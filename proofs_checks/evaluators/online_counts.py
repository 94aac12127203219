"""The pooled count estimator, and what happens when trajectories are sampled from the estimate itself."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from bridge_theory.arithmetic.flint_balls import ball, working_precision
from proofs_checks.counterexample import Number, evaluates
from proofs_checks.evaluators.online_numbers import enclosed, numbers


@evaluates("online-count-row")
def count_row(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """The sum of an estimated row with both counts taken over all H pairs of the trajectory, and 1."""
    path = [int(x) for x in data["trajectory"]]
    pairs = list(zip(path[::2], path[1::2], strict=True))
    wanted = (int(data["state"]), int(data["action"]))
    uses = sum(pair == wanted for pair in pairs)
    followed = sum(pair == wanted for pair in pairs[:-1])
    return Fraction(followed, uses), Fraction(1)


@evaluates("online-sampling-from-the-estimate")
def sampling_from_the_estimate(data: Mapping[str, Any]) -> tuple[Number, Number]:
    """A lower bound of the probability that the bonus is too small in round t, and the claimed delta.

    H = 2, one demonstration of the expert. When its one transition leads to a state x, the estimated row is certain of
    x, and so are all later trajectories drawn from the estimate: it never changes. f is ``utility`` of s_2; both pairs
    of a trajectory have the same count, and their bonuses add up.
    """
    row = [Fraction(p) for p in data["kernels"]["P^*"][0][0]]
    utility = [Fraction(value) for value in data["utility"]]
    n_states, n_actions, rounds = len(row), len(data["kernels"]["P^*"][0]), int(data["t"])
    truth = sum((p * u for p, u in zip(row, utility, strict=True)), Fraction(0))
    with working_precision(128):
        eta, delta = numbers(data, "eta delta")
        count = ball(1 + 2 * (rounds - 1))
        log_term = 2 * ball(n_states * n_actions).log() + (6 * count.log() / delta).log()
        bonus = 2 * (2 * eta).min(4 * eta * (log_term / count).sqrt())
        failing = sum((p for p, u in zip(row, utility, strict=True) if ball(truth - u) > bonus), Fraction(0))
    return failing, enclosed(delta)
