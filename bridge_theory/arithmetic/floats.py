"""The NumPy interpretation: float64, broadcasting over arrays, fast, and without any certificate."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import reduce

import numpy as np

from bridge_theory.arithmetic.protocol import FloatArray, Value
from bridge_theory.arithmetic.special import log_binomial

FEW_FACTORS = 64


class Floats:
    """Every value is a float64 scalar or array."""

    def number(self, value: int | Fraction) -> Value:
        return np.float64(value)

    def power(self, x: Value, exponent: Value) -> Value:
        return x**exponent

    def power_near_one(self, x: Value, exponent: Value) -> Value:
        # few factors lose little, and may be exact
        return self.if_at_most(
            exponent, FEW_FACTORS, lambda: (1 + x) ** exponent, lambda: np.exp(exponent * np.log1p(x))
        )

    def sqrt(self, x: Value) -> Value:
        return np.sqrt(x)

    def log(self, x: Value) -> Value:
        return np.log(x)

    def log1p(self, x: Value) -> Value:
        return np.log1p(x)

    def log1p_ratio(self, x: Value, y: Value) -> Value:
        return np.log1p(x) / np.log1p(y)

    def exp(self, x: Value) -> Value:
        return np.exp(x)

    def expm1(self, x: Value) -> Value:
        return np.expm1(x)

    def one_minus_root(self, x: Value, degree: Value) -> Value:
        return -np.expm1(np.log(x) / degree)

    def cosh(self, x: Value) -> Value:
        return np.cosh(x)

    def sin(self, x: Value) -> Value:
        return np.sin(x)

    def arcsin(self, x: Value) -> Value:
        return np.arcsin(x)

    def arccos(self, x: Value) -> Value:
        return np.arccos(x)

    def pi(self) -> Value:
        return np.float64(np.pi)

    def min(self, *values: Value) -> Value:
        return reduce(np.minimum, values)

    def max(self, *values: Value) -> Value:
        return reduce(np.maximum, values)

    def ceil(self, x: Value) -> Value:
        return np.ceil(x)

    def log_binomial(self, top: Value, bottom: Value) -> Value:
        return log_binomial(top, bottom)

    def if_at_most(self, x: Value, y: Value, then: Callable[[], Value], otherwise: Callable[[], Value]) -> Value:
        return np.where(np.asarray(x) <= y, then(), otherwise())

    def sum(self, summand: Callable[..., Value], *arrays: Value) -> Value:
        rows, counts = np.unique(np.stack(arrays, axis=-1), axis=0, return_counts=True)
        terms = (count * summand(*row) for row, count in zip(rows, counts, strict=True))
        return sum(terms, start=np.float64(0))

    def minimum_over_integers(
        self,
        objective: Callable[[Value], Value],
        step: Callable[[Value], Value],
        near: Callable[..., FloatArray],
        *arguments: Value,
    ) -> Value:
        centre = np.rint(near(*arguments))
        return reduce(np.minimum, (objective(np.maximum(centre + shift, 1.0)) for shift in (-1.0, 0.0, 1.0)))


FLOATS = Floats()
