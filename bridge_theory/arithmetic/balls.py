"""The rigorous interpretation: every value is a ball that contains the true number, and every branch is enclosed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from functools import reduce

import numpy as np

from bridge_theory.arithmetic import flint_balls
from bridge_theory.arithmetic.flint_balls import Ball
from bridge_theory.arithmetic.protocol import FloatArray, Value

_LONGEST_PRODUCT = 512  # below it a product is cheaper than three log-gammas, and far tighter on wide balls
_LONGEST_WALK = 64  # how far the float starting point of a minimisation may be off before we give up


class Balls:
    """Operations on ``arb`` balls at the working precision; array-valued arguments are tuples of exact numbers."""

    def number(self, value: int | Fraction) -> Value:
        return flint_balls.ball(value)

    def sqrt(self, x: Value) -> Value:
        return x.sqrt()

    def log(self, x: Value) -> Value:
        return x.log()

    def log1p(self, x: Value) -> Value:
        return x.log1p()

    def exp(self, x: Value) -> Value:
        return x.exp()

    def expm1(self, x: Value) -> Value:
        return x.expm1()

    def cosh(self, x: Value) -> Value:
        return x.cosh()

    def sin(self, x: Value) -> Value:
        return x.sin()

    def arcsin(self, x: Value) -> Value:
        return x.asin()

    def arccos(self, x: Value) -> Value:
        return x.acos()

    def pi(self) -> Value:
        return flint_balls.pi_ball()

    def min(self, *values: Value) -> Value:
        return reduce(lambda x, y: x.min(y), self._lifted(values))

    def max(self, *values: Value) -> Value:
        return reduce(lambda x, y: x.max(y), self._lifted(values))

    def ceil(self, x: Value) -> Value:
        return x.ceil()

    def log_binomial(self, top: Value, bottom: Value) -> Value:
        count = flint_balls.exact_integer(bottom)
        if count is None or count > _LONGEST_PRODUCT:
            return (top + 1).lgamma() - (bottom + 1).lgamma() - (top - bottom + 1).lgamma()
        product = self.number(1)
        for i in range(1, count + 1):
            product *= (top - bottom + i) / i
        return product.log()

    def if_at_most(self, x: Value, y: Value, then: Callable[[], Value], otherwise: Callable[[], Value]) -> Value:
        if x <= y:
            return then()
        if x > y:
            return otherwise()
        return then().union(otherwise())

    def sum(self, summand: Callable[..., Value], *arrays: Value) -> Value:
        # equal cells are summed once: count tables have few distinct values
        cells = Counter(zip(*arrays, strict=True))
        terms = (count * summand(*map(self.number, cell)) for cell, count in cells.items())
        return sum(terms, start=self.number(0))

    def minimum_over_integers(
        self, objective: Callable[[Value], Value], near: Callable[..., FloatArray], *arguments: Value
    ) -> Value:
        start = near(*(np.float64(flint_balls.midpoint(x)) for x in arguments))
        return _IntegerMinimum(objective, self.number).enclose(max(1, round(float(start))))

    def _lifted(self, values: tuple[Value, ...]) -> list[Ball]:
        return [self.number(value) if isinstance(value, int | Fraction) else value for value in values]


class _IntegerMinimum:
    """Certified minimum of a strictly quasi-convex objective over the integers ``k >= 1``.

    If ``objective(a) > objective(k)`` with ``a < k`` then every integer up to ``a`` is worse than ``a``, and likewise
    on the right; so the minimum lies strictly between two neighbours that are certified to be worse.
    """

    def __init__(self, objective: Callable[[Ball], Ball], number: Callable[[int], Ball]) -> None:
        self._objective = objective
        self._number = number
        self._known: dict[int, Ball] = {}

    def enclose(self, start: int) -> Ball:
        k = self._walk_downhill(start)
        below = self._worse_neighbour(k, -1)
        above = self._worse_neighbour(k, +1)
        best = self._at(k)
        if below is None or above is None:
            return flint_balls.everything()  # not decided at this precision: the caller raises it
        for candidate in range(below + 1, above):
            best = best.min(self._at(candidate))
        return best

    def _walk_downhill(self, k: int) -> int:
        for _ in range(_LONGEST_WALK):
            if self._at(k + 1) < self._at(k):
                k += 1
            elif k > 1 and self._at(k - 1) < self._at(k):
                k -= 1
            else:
                break
        return k

    def _worse_neighbour(self, k: int, direction: int) -> int | None:
        # two integers may tie, three cannot
        for distance in (1, 2):
            neighbour = k + direction * distance
            if neighbour < 1 or self._at(neighbour) > self._at(k):
                return neighbour
        return None

    def _at(self, k: int) -> Ball:
        if k not in self._known:
            self._known[k] = self._objective(self._number(k))
        return self._known[k]


BALLS = Balls()
