"""What a formula may do with its arguments: the operations every interpretation of the arithmetic provides."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

Value: TypeAlias = Any
"""Whatever the arithmetic at hand computes with: a float64 scalar or array, a SymPy expression, or an ``arb`` ball,
which mixes with exact rationals."""

FloatArray: TypeAlias = npt.NDArray[np.float64]


class Arithmetic(Protocol):
    """The operations of a formula besides ``+ - * /`` and whole powers, which its values support themselves."""

    def number(self, value: int | Fraction) -> Value:
        """The exact constant ``value``; needed where two Python integers would otherwise meet, as in ``1 / 2``."""

    def power(self, x: Value, exponent: Value) -> Value:
        """``x ** exponent`` where the exponent is a value and not a Python integer; ``x >= 0``."""

    def power_near_one(self, x: Value, exponent: Value) -> Value:
        """``(1 + x) ** exponent`` without losing digits of a small ``x``, for ``x > -1`` and whole exponents."""

    def sqrt(self, x: Value) -> Value:
        """Square root; the caller knows that ``x >= 0``."""

    def log(self, x: Value) -> Value:
        """Natural logarithm; the caller knows that ``x > 0``."""

    def log1p(self, x: Value) -> Value:
        """``log(1 + x)`` without cancellation near 0."""

    def log1p_ratio(self, x: Value, y: Value) -> Value:
        """``log(1 + x) / log(1 + y)`` for ``x >= 0`` and ``y > 0``; exactly 1 where the two are known to be equal."""

    def exp(self, x: Value) -> Value:
        """Exponential."""

    def expm1(self, x: Value) -> Value:
        """``exp(x) - 1`` without cancellation near 0."""

    def one_minus_root(self, x: Value, degree: Value) -> Value:
        """``1 - x ** (1 / degree)`` without cancellation near 0, for ``0 < x <= 1`` and integers ``degree >= 1``."""

    def cosh(self, x: Value) -> Value:
        """Hyperbolic cosine."""

    def sin(self, x: Value) -> Value:
        """Sine."""

    def arcsin(self, x: Value) -> Value:
        """Inverse sine on [-1, 1]."""

    def arccos(self, x: Value) -> Value:
        """Inverse cosine on [-1, 1]."""

    def pi(self) -> Value:
        """The number pi."""

    def min(self, *values: Value) -> Value:
        """The smallest value; a ball that cannot tell which one is smallest encloses all candidates."""

    def max(self, *values: Value) -> Value:
        """The largest value; a ball that cannot tell which one is largest encloses all candidates."""

    def ceil(self, x: Value) -> Value:
        """The smallest integer that is at least ``x``; a ball around an integer encloses both candidates."""

    def log_binomial(self, top: Value, bottom: Value) -> Value:
        """``log C(top, bottom)`` for ``0 <= bottom <= top``, integers."""

    def if_at_most(self, x: Value, y: Value, then: Callable[[], Value], otherwise: Callable[[], Value]) -> Value:
        """``then()`` where ``x <= y`` and ``otherwise()`` elsewhere; an undecided ball encloses both."""

    def sum(self, summand: Callable[..., Value], *arrays: Value) -> Value:
        """``sum_i summand(a_i, b_i, ...)`` over array-valued arguments of one length."""

    def minimum_over_integers(
        self,
        objective: Callable[[Value], Value],
        step: Callable[[Value], Value],
        near: Callable[..., FloatArray],
        *arguments: Value,
    ) -> Value:
        """``min_{k >= 1} objective(k)`` over integers, for an objective that strictly falls and then strictly rises.

        ``step(k)`` is ``objective(k + 1) - objective(k)`` in a form that does not cancel, for floats to certify by.
        ``near(*arguments)`` maps floats to a float close to the real minimiser: it saves time and proves nothing.
        """
