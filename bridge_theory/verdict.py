"""Does a bound meet a target at a point, or on a whole interval? Answers are certified or withheld."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from bridge_theory.arithmetic import flint_balls
from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.arithmetic.protocol import Value
from bridge_theory.bound import Bound
from bridge_theory.enclosure import FIRST_BITS, LAST_BITS, Enclosure, ball_arguments
from bridge_theory.errors import InputError
from bridge_theory.parameters import Exact, Stored

_MOST_BOXES = 1000

Verdict = Literal["meets", "fails", "undecided"]


@dataclass(frozen=True)
class Probe:
    """The verdict at one point, with the enclosure it rests on."""

    verdict: Verdict
    enclosure: Enclosure


def applies(bound: Bound, exact: Mapping[str, Stored]) -> bool:
    """Whether the statement's conditions hold at exact parameters."""
    try:
        bound.check_conditions(exact)
    except InputError:
        return False
    return True


def decide(bound: Bound, exact: Mapping[str, Stored], target: Exact) -> Probe:
    """Whether ``bound <= target`` at exact parameters, precision raised until it is certain."""
    bits = FIRST_BITS
    while True:
        with flint_balls.working_precision(bits):
            outcome = bound(BALLS, **ball_arguments(exact))
            value, verdict = flint_balls.as_ball(outcome), _compare(outcome, flint_balls.rational(target))
            if verdict != "undecided" or bits >= LAST_BITS:
                lower, upper = flint_balls.ends(value)
                return Probe(verdict, Enclosure(lower, upper, bits, flint_balls.accuracy_bits(value) >= 53))
        bits *= 2


def excluded_by_boxes(
    bound: Bound, name: str, others: Mapping[str, Stored], target: Exact, low: Exact, high: Exact, *, integer: bool
) -> bool:
    """Whether ball arithmetic over intervals proves ``bound > target`` for every value from ``low`` to ``high``.

    No monotonicity is assumed. False means only that the proof was not found within a fixed number of intervals.
    """
    fixed = dict(others)
    pending = [(low, high)]
    for _ in range(_MOST_BOXES):
        if not pending:
            return True
        left, right = pending.pop()
        with flint_balls.working_precision(FIRST_BITS * 2):
            point = {**ball_arguments(fixed), name: flint_balls.box(left, right)}
            proved = _compare(bound(BALLS, **point), flint_balls.rational(target)) == "fails"
        if proved:
            continue
        if left == right:
            return False
        pending += _halves(left, right, integer)
    return False


def _halves(left: Exact, right: Exact, integer: bool) -> list[tuple[Exact, Exact]]:
    # near the solution the intervals must shrink with the distance to it, which halving the interval does
    if integer:
        middle = (int(left) + int(right)) // 2
        return [(left, middle), (middle + 1, right)]
    centre = Fraction(left + right) / 2
    return [(left, centre), (centre, right)]


def _compare(value: Value, goal: Value) -> Verdict:
    if value <= goal:
        return "meets"
    return "fails" if value > goal else "undecided"
