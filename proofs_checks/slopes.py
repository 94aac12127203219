r"""Balls with a derivative: a formula evaluated over them shows in which direction it moves on a whole box.

The same formula text runs over this arithmetic as over floats, symbols and balls. A value carries its ball and the
balls of its possible slopes in one chosen parameter; where a minimum or maximum cannot tell which argument it
takes, the slopes of both remain possible. A function that is continuous and has all possible slopes of one sign almost
everywhere is monotone. Branches whose condition is undecided on a box may jump: their slope is unknown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from functools import reduce
from typing import Any, Literal

from bridge_theory.arithmetic import flint_balls
from bridge_theory.bound import Bound
from bridge_theory.errors import InputError
from proofs_checks.balls import Ball, Box, prove_positive
from proofs_checks.outcome import Outcome

_MOST_ALTERNATIVES = 8


class Slope:
    """A ball and the balls of its possible slopes."""

    __slots__ = ("slopes", "value")

    def __init__(self, value: Ball, slopes: Iterable[Ball]) -> None:
        self.value = value
        kept = tuple(slopes)
        self.slopes = kept if len(kept) <= _MOST_ALTERNATIVES else (reduce(lambda a, b: a.union(b), kept),)

    def _with(self, other: Any, value: Callable[[Ball, Ball], Ball], slope: Callable[..., Ball]) -> Slope:
        x, y = self, lifted(other)
        return Slope(value(x.value, y.value), (slope(x.value, y.value, a, b) for a in x.slopes for b in y.slopes))

    def __add__(self, other: Any) -> Slope:
        return self._with(other, lambda x, y: x + y, lambda x, y, a, b: a + b)

    def __sub__(self, other: Any) -> Slope:
        return self._with(other, lambda x, y: x - y, lambda x, y, a, b: a - b)

    def __mul__(self, other: Any) -> Slope:
        return self._with(other, lambda x, y: x * y, lambda x, y, a, b: a * y + b * x)

    def __truediv__(self, other: Any) -> Slope:
        return self._with(other, lambda x, y: x / y, lambda x, y, a, b: a / y - b * x / y / y)

    def __pow__(self, other: Any) -> Slope:
        if isinstance(other, int):
            return self.through(lambda x: x**other, lambda x: other * x ** (other - 1))
        return (lifted(other) * self.through(lambda x: x.log(), lambda x: 1 / x)).through(_exp, _exp)

    def __neg__(self) -> Slope:
        return Slope(-self.value, (-slope for slope in self.slopes))

    def __radd__(self, other: Any) -> Slope:
        return lifted(other) + self

    def __rsub__(self, other: Any) -> Slope:
        return lifted(other) - self

    def __rmul__(self, other: Any) -> Slope:
        return lifted(other) * self

    def __rtruediv__(self, other: Any) -> Slope:
        return lifted(other) / self

    def __rpow__(self, other: Any) -> Slope:
        return lifted(other) ** self

    def through(self, function: Callable[[Ball], Ball], derivative: Callable[[Ball], Ball]) -> Slope:
        """A differentiable function of this value."""
        rate = derivative(self.value)
        return Slope(function(self.value), (rate * slope for slope in self.slopes))


def _exp(x: Ball) -> Ball:
    return x.exp()


def lifted(value: Any) -> Slope:
    """A constant as a value whose slope is zero."""
    if isinstance(value, Slope):
        return value
    ball = flint_balls.ball(value) if isinstance(value, int | Fraction) else value
    return Slope(ball, (flint_balls.ball(0),))


class Slopes:
    """The operations of ``bridge_theory.arithmetic.Arithmetic`` over values with slopes."""

    def number(self, value: int | Fraction) -> Slope:
        return lifted(value)

    def power(self, x: Any, exponent: Any) -> Slope:
        return lifted(x) ** lifted(exponent)

    def power_near_one(self, x: Any, exponent: Any) -> Slope:
        return self.exp(exponent * self.log1p(x))

    def sqrt(self, x: Any) -> Slope:
        return lifted(x).through(lambda v: v.sqrt(), lambda v: 1 / (2 * v.sqrt()))

    def log(self, x: Any) -> Slope:
        return lifted(x).through(lambda v: v.log(), lambda v: 1 / v)

    def log1p(self, x: Any) -> Slope:
        return lifted(x).through(lambda v: v.log1p(), lambda v: 1 / (1 + v))

    def log1p_ratio(self, x: Any, y: Any) -> Slope:
        return self.log1p(x) / self.log1p(y)

    def exp(self, x: Any) -> Slope:
        return lifted(x).through(_exp, _exp)

    def expm1(self, x: Any) -> Slope:
        return lifted(x).through(lambda v: v.expm1(), _exp)

    def one_minus_root(self, x: Any, degree: Any) -> Slope:
        return -self.expm1(self.log(x) / degree)

    def cosh(self, x: Any) -> Slope:
        return lifted(x).through(lambda v: v.cosh(), lambda v: v.sinh())

    def pi(self) -> Slope:
        return lifted(flint_balls.pi_ball())

    def min(self, *values: Any) -> Slope:
        return reduce(
            lambda x, y: _chosen(x, y, x.value < y.value, y.value < x.value, x.value.min(y.value)), _all(values)
        )

    def max(self, *values: Any) -> Slope:
        return reduce(
            lambda x, y: _chosen(x, y, x.value > y.value, y.value > x.value, x.value.max(y.value)), _all(values)
        )

    def ceil(self, x: Any) -> Slope:
        constant = all(slope == 0 for slope in lifted(x).slopes)
        return Slope(lifted(x).value.ceil(), (flint_balls.ball(0) if constant else flint_balls.everything(),))

    def if_at_most(self, x: Any, y: Any, then: Callable[[], Any], otherwise: Callable[[], Any]) -> Slope:
        left, right = lifted(x).value, lifted(y).value
        if left <= right:
            return lifted(then())
        if left > right:
            return lifted(otherwise())
        both = lifted(then()).value.union(lifted(otherwise()).value)
        return Slope(both, (flint_balls.everything(),))


def _all(values: tuple[Any, ...]) -> list[Slope]:
    return [lifted(value) for value in values]


def _chosen(x: Slope, y: Slope, first: bool, second: bool, value: Ball) -> Slope:
    return x if first else y if second else Slope(value, (*x.slopes, *y.slopes))


SLOPES = Slopes()


def prove_monotone(
    bound: Bound, parameter: str, box: Box, direction: Literal["rises", "falls"], *, most: int = 20_000
) -> Outcome:
    """Whether a bound moves weakly in one direction in a parameter, at every real point of a box of its parameters.

    Integer parameters are treated as real numbers, which proves more. Errors: ``InputError`` if the box leaves a
    parameter of the bound open.

    >>> from bridge_theory import reach_size
    >>> box = {"S": (1, 100), "A": (1, 10), "H": (1, 50), "gamma_min": ("1/100", 1)}
    >>> prove_monotone(reach_size, "gamma_min", box, "falls").holds
    True
    >>> prove_monotone(reach_size, "gamma_min", box, "rises").holds
    False
    """
    missing = set(bound.parameters) - set(box)
    if missing:
        raise InputError(f"{bound.name} needs an interval for {', '.join(sorted(missing))}")
    sign = 1 if direction == "rises" else -1

    def least_slope(**balls: Ball) -> Ball:
        outcome = _sloped(bound, parameter, balls)
        return _lowest([sign * slope * balls[parameter] for slope in outcome.slopes])

    name = f"{bound.name} {direction} in {parameter}"
    sides = {key: (Fraction(low), Fraction(high)) for key, (low, high) in box.items() if key in bound.parameters}
    return prove_positive(name, least_slope, sides, geometric=tuple(sides), most=most, weakly=True)


def _sloped(bound: Bound, parameter: str, balls: Mapping[str, Ball]) -> Slope:
    one, zero = flint_balls.ball(1), flint_balls.ball(0)
    return lifted(bound(SLOPES, **{key: Slope(x, (one if key == parameter else zero,)) for key, x in balls.items()}))


def _lowest(balls: list[Ball]) -> Ball:
    """A ball that is certainly nonnegative exactly when all of them are."""
    undecided = [ball for ball in balls if not ball >= 0]
    return undecided[0] if undecided else balls[0]
