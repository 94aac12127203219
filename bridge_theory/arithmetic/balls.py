"""The rigorous interpretation: every value is a ball that contains the true number, and every branch is enclosed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from functools import reduce
from math import ceil, isfinite

import numpy as np

from bridge_theory.arithmetic import flint_balls
from bridge_theory.arithmetic.flint_balls import Ball, as_ball
from bridge_theory.arithmetic.protocol import FloatArray, Value

_LONGEST_EXACT_SUM = 64  # distinct cells
_LONGEST_PRODUCT = 512  # below it a product is cheaper than three log-gammas, and far tighter on wide balls


class Balls:
    """Operations on ``arb`` balls at the working precision; array-valued arguments are tuples of exact numbers.

    Values may also be exact rationals: wherever the result is rational for a reason that is known, it stays exact, so
    that a bound that attains its target is recognised.
    """

    def number(self, value: int | Fraction) -> Value:
        return flint_balls.rational(value)

    def power(self, x: Value, exponent: Value) -> Value:
        exact = flint_balls.exact_power(x, exponent)
        return as_ball(x) ** as_ball(exponent) if exact is None else exact

    def power_near_one(self, x: Value, exponent: Value) -> Value:
        return self.power(1 + x, exponent)

    def sqrt(self, x: Value) -> Value:
        exact = flint_balls.exact_root(x, 2)
        return as_ball(x).sqrt() if exact is None else exact

    def log(self, x: Value) -> Value:
        return self.number(0) if _is(x, 1) else as_ball(x).log()

    def log1p(self, x: Value) -> Value:
        return self.number(0) if _is(x, 0) else as_ball(x).log1p()

    def log1p_ratio(self, x: Value, y: Value) -> Value:
        exact = flint_balls.as_fraction(x)
        if exact is not None and exact == flint_balls.as_fraction(y):
            return self.number(1)
        return self.log1p(x) / self.log1p(y)

    def exp(self, x: Value) -> Value:
        return self.number(1) if _is(x, 0) else as_ball(x).exp()

    def expm1(self, x: Value) -> Value:
        return self.number(0) if _is(x, 0) else as_ball(x).expm1()

    def one_minus_root(self, x: Value, degree: Value) -> Value:
        exact = flint_balls.exact_root(x, degree)
        return -self.expm1(self.log(x) / degree) if exact is None else 1 - exact

    def cosh(self, x: Value) -> Value:
        return self.number(1) if _is(x, 0) else as_ball(x).cosh()

    def sin(self, x: Value) -> Value:
        return self.number(0) if _is(x, 0) else as_ball(x).sin()

    def arcsin(self, x: Value) -> Value:
        return self.number(0) if _is(x, 0) else as_ball(x).asin()

    def arccos(self, x: Value) -> Value:
        return self.number(0) if _is(x, 1) else as_ball(x).acos()

    def pi(self) -> Value:
        return flint_balls.pi_ball()

    def min(self, *values: Value) -> Value:
        return reduce(_smaller, values)

    def max(self, *values: Value) -> Value:
        return reduce(_larger, values)

    def ceil(self, x: Value) -> Value:
        exact = flint_balls.as_fraction(x)
        return x.ceil() if exact is None else flint_balls.rational(ceil(exact))

    def log_binomial(self, top: Value, bottom: Value) -> Value:
        if _is(bottom, 0) or _is(top - bottom, 0):
            return self.number(0)
        top, bottom = as_ball(top), as_ball(bottom)
        count = flint_balls.exact_integer(bottom)
        if count is None or count > _LONGEST_PRODUCT:
            return (top + 1).lgamma() - (bottom + 1).lgamma() - (top - bottom + 1).lgamma()
        product = flint_balls.ball(1)
        for i in range(1, count + 1):
            product *= (top - bottom + i) / i
        return product.log()

    def if_at_most(self, x: Value, y: Value, then: Callable[[], Value], otherwise: Callable[[], Value]) -> Value:
        if x <= y:
            return then()
        if x > y:
            return otherwise()
        return as_ball(then()).union(as_ball(otherwise()))

    def sum(self, summand: Callable[..., Value], *arrays: Value) -> Value:
        # equal cells are summed once: count tables have few distinct values
        cells = Counter(zip(*arrays, strict=True))
        # a sum of many exact fractions would have a denominator of all of them
        number = self.number if len(cells) <= _LONGEST_EXACT_SUM else flint_balls.ball
        terms = (count * summand(*map(number, cell)) for cell, count in cells.items())
        return sum(terms, start=self.number(0))

    def minimum_over_integers(
        self,
        objective: Callable[[Value], Value],
        step: Callable[[Value], Value],
        near: Callable[..., FloatArray],
        *arguments: Value,
    ) -> Value:
        with np.errstate(all="ignore"):  # the start proves nothing: where floats overflow, any will do
            start = float(near(*(np.float64(flint_balls.midpoint(x)) for x in arguments)))
        try:
            return _IntegerMinimum(objective, flint_balls.ball).enclose(max(1, round(start)) if isfinite(start) else 1)
        except _UndecidedError:
            return flint_balls.everything()  # the caller raises the precision


def _is(x: Value, constant: int) -> bool:
    exact = flint_balls.as_fraction(x)
    return exact is not None and exact == constant


def _smaller(x: Value, y: Value) -> Value:
    # a candidate that is certainly smallest keeps what is known of it
    return x if x <= y else y if y <= x else as_ball(x).min(as_ball(y))


def _larger(x: Value, y: Value) -> Value:
    return x if x >= y else y if y >= x else as_ball(x).max(as_ball(y))


class _UndecidedError(Exception):
    """Two neighbours of a minimisation cannot be told apart at the working precision."""


class _IntegerMinimum:
    """Certified minimum of an objective over the integers ``k >= 1`` that strictly falls and then strictly rises.

    A certified fall from ``k`` to ``k + 1`` puts the minimum after ``k``; a certified rise puts it at ``k`` or before.
    So the minimum is found by doubling steps and bisection, however far off the start.
    """

    def __init__(self, objective: Callable[[Ball], Ball], number: Callable[[int], Ball]) -> None:
        self._objective = objective
        self._number = number
        self._known: dict[int, Ball] = {}

    def enclose(self, start: int) -> Ball:
        low, high, step = start - 1, start, 1
        while not self._passed(high):
            low, high, step = high, high + step, 2 * step
        while low > 0 and self._passed(low):
            low, high, step = max(0, low - step), low, 2 * step
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if self._passed(middle) else (middle, high)
        return self._at(high).min(self._at(high + 1))

    def _passed(self, k: int) -> bool:
        """Whether a minimum lies at ``k + 1`` or before; otherwise all lie after ``k``."""
        if self._at(k + 1) < self._at(k):
            return False
        # k and k + 1 may tie, three neighbours cannot
        if self._at(k + 1) > self._at(k) or self._at(k + 2) > self._at(k):
            return True
        raise _UndecidedError

    def _at(self, k: int) -> Ball:
        if k not in self._known:
            self._known[k] = as_ball(self._objective(self._number(k)))
        return self._known[k]


BALLS = Balls()
