"""Certified values: two floats that provably lie on either side of the number."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from bridge_theory.arithmetic import flint_balls
from bridge_theory.arithmetic.protocol import Value
from bridge_theory.parameters import Stored
from bridge_theory.rounding import rounded_down, rounded_up

FIRST_BITS = 96
LAST_BITS = 6144
_ENOUGH_BITS = 60  # seven more than a float64 holds


@dataclass(frozen=True)
class Enclosure:
    """``lower <= value <= upper``, both ends rounded outward to float64.

    Source: ball arithmetic (Johansson 2017). ``bits`` is the working precision that was needed; ``narrow`` is False
    when even the highest precision left the ends more than a few units in the last place apart. ``exact`` is the value
    itself where it is a rational number that the computation knows, as ``sqrt(4)`` or a cap that is attained.

    >>> 1.25 in Enclosure(1.0, 1.5, bits=96, narrow=False)
    True
    """

    lower: float
    upper: float
    bits: int
    narrow: bool
    exact: Fraction | None = None

    @property
    def width(self) -> float:
        """``upper - lower``, rounded up."""
        return math.nextafter(self.upper - self.lower, math.inf) if self.upper > self.lower else 0.0

    @property
    def middle(self) -> float:
        """A float between the ends, for display."""
        return self.lower + (self.upper - self.lower) / 2 if math.isfinite(self.width) else math.nan

    @property
    def at_most(self) -> str:
        """Six digits that the value does not exceed."""
        return rounded_up(self.upper if self.exact is None else self.exact)

    @property
    def at_least(self) -> str:
        """Six digits that the value does not fall below."""
        return rounded_down(self.lower if self.exact is None else self.exact)

    @property
    def complement_at_least(self) -> str:
        """Six digits that ``1 - value`` does not fall below, nor 0: the chance that an event of this failure holds."""
        value = min(1.0, self.upper) if self.exact is None else min(Fraction(1), self.exact)
        return rounded_down(1 - Fraction(value))

    def __contains__(self, number: float) -> bool:
        return self.lower <= number <= self.upper

    def __str__(self) -> str:
        note = "" if self.narrow else f" (still wide at {self.bits} bits)"
        return f"[{self.lower!r}, {self.upper!r}]{note}"


def ball_arguments(exact: Mapping[str, Stored]) -> dict[str, Any]:
    """Validated exact parameters as the rigorous arithmetic takes them, still exact; it converts arrays by entry."""
    return {name: value if isinstance(value, tuple) else flint_balls.rational(value) for name, value in exact.items()}


def sharpen(compute: Callable[[], Value]) -> tuple[Value, int, bool]:
    """Evaluate at rising precision until the ball pins a float64 down: the value, the precision, whether it did."""
    bits = FIRST_BITS
    while True:
        with flint_balls.working_precision(bits):
            value = compute()
            narrow = flint_balls.accuracy_bits(value) >= _ENOUGH_BITS
        if narrow or bits >= LAST_BITS:
            return value, bits, narrow
        bits *= 2


def enclose(compute: Callable[[], Value]) -> Enclosure:
    """The certified float64 enclosure of a ball-valued computation, precision raised as far as needed."""
    value, bits, narrow = sharpen(compute)
    with flint_balls.working_precision(bits):
        lower, upper = flint_balls.ends(value)
    return Enclosure(lower, upper, bits, narrow, flint_balls.as_fraction(value))
