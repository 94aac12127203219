r"""Inequalities over boxes of parameters, proved by ball arithmetic with adaptive subdivision.

A box gives each variable a rational interval. Where the ball of the expression over a box has a certain sign, the box
is settled; otherwise it is halved along one side. An interval that reaches to infinity, or a point where both
sides are equal, is no box: such a claim records the analytic argument that reduces it to one.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, TypeAlias

from bridge_theory.arithmetic import flint_balls
from proofs_checks.outcome import Outcome

Ball: TypeAlias = Any
Exact: TypeAlias = Fraction | int | str
Box: TypeAlias = Mapping[str, tuple[Exact, Exact]]
Sides: TypeAlias = tuple[Fraction, Fraction]

BITS = 96


def prove_positive(
    name: str,
    expression: Callable[..., Ball],
    box: Box,
    *,
    geometric: tuple[str, ...] = (),
    bits: int = BITS,
    most: int = 20_000,
    weakly: bool = False,
) -> Outcome:
    """Whether the expression is positive at every point of the box.

    Args:
        expression: takes balls by the names of the box and returns a ball.
        geometric: variables (with positive intervals) that are halved at the geometric mean, for intervals that span
            orders of magnitude.
        bits: working precision.
        most: boxes to look at before giving up, which is a failure.
        weakly: prove that it is not negative instead.

    >>> prove_positive("parabola", lambda x: x * x - x + 1, {"x": (-1, 2)}).holds
    True
    >>> prove_positive("parabola", lambda x: x * x - x, {"x": (0, 2)}).failures
    ('parabola: not positive at x = 1',)
    """
    with flint_balls.working_precision(bits):
        return _search(
            name, expression, {k: (Fraction(a), Fraction(b)) for k, (a, b) in box.items()}, geometric, most, weakly
        )


def _search(
    name: str,
    expression: Callable[..., Ball],
    box: dict[str, Sides],
    geometric: tuple[str, ...],
    most: int,
    weakly: bool,
) -> Outcome:
    open_, seen, sign = deque([box]), 0, "at least 0" if weakly else "positive"
    while open_:
        current, seen = open_.popleft(), seen + 1  # coarse boxes first: a violation is seen before depth is spent
        value = expression(**{k: flint_balls.box(*sides) for k, sides in current.items()})
        if value > 0 or (weakly and value >= 0):
            continue
        if value < 0 or (not weakly and value <= 0):
            return Outcome(seen, (f"{name}: not {sign} for {_shown(current)}",))
        middle = expression(**{k: flint_balls.ball(_middle(k, i, geometric)) for k, i in current.items()})
        if middle < 0 or (not weakly and middle <= 0):
            point = {k: (_middle(k, i, geometric),) * 2 for k, i in current.items()}
            return Outcome(seen, (f"{name}: not {sign} at {_shown(point)}",))
        parts = _halves(expression, current, geometric)
        if seen >= most or not parts:  # a single point that stays undecided has no halves, and is not proved
            return Outcome(seen, (f"{name}: undecided after {seen} boxes, for example {_shown(current)}",))
        open_ += parts
    return Outcome(seen, details=f"{name}: {sign} on the box ({seen} boxes)")


def _halves(
    expression: Callable[..., Ball], box: dict[str, Sides], geometric: tuple[str, ...]
) -> list[dict[str, Sides]]:
    """The two halves along the side whose halving makes the expression's balls narrowest."""

    def badness(key: str) -> tuple[float, Fraction]:
        values = [expression(**{k: flint_balls.box(*sides) for k, sides in half.items()}) for half in halves[key]]
        spread = sum(float(value.rad()) if value.is_finite() else math.inf for value in values)
        low, high = box[key]
        return spread, (low - high) / (abs(low) + abs(high))  # on a tie, the relatively longest side

    cuts = {key: _middle(key, sides, geometric) for key, sides in box.items() if sides[0] < sides[1]}
    halves = {key: [{**box, key: (box[key][0], cut)}, {**box, key: (cut, box[key][1])}] for key, cut in cuts.items()}
    return halves[min(halves, key=badness)] if len(halves) > 1 else next(iter(halves.values()), [])


def _middle(key: str, sides: Sides, geometric: tuple[str, ...]) -> Fraction:
    low, high = sides
    if key not in geometric or high <= 4 * low:
        return (low + high) / 2
    return Fraction(2) ** round((_log2(low) + _log2(high)) / 2)


def _log2(value: Fraction) -> float:
    return math.log2(value.numerator) - math.log2(value.denominator)


def _shown(box: Mapping[str, tuple[Fraction, ...]]) -> str:
    return ", ".join(
        f"{k} = {_number(ends[0])}" if ends[0] == ends[-1] else f"{k} in [{_number(ends[0])}, {_number(ends[-1])}]"
        for k, ends in box.items()
    )


def _number(value: Fraction) -> str:
    return str(value) if value.denominator < 1000 else f"{float(value):.6g}"
