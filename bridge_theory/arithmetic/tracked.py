"""Floats that know how far off they may be: each value carries a bound on its distance from the true number.

The values are those of ``FLOATS``, to the bit. The bounds follow a computation step by step (a running error analysis):
they see cancellation, an overflow or underflow on the way, a ceiling or a branch that rounding may have decided. Where
a bound is too large or unknown, the caller turns to balls.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import reduce

import numpy as np

from bridge_theory.arithmetic.floats import FEW_FACTORS, FLOATS
from bridge_theory.arithmetic.protocol import FloatArray, Value

_UNIT = 2.0**-53  # the relative error of one rounding
_LIBRARY = 8 * _UNIT  # NumPy's elementary functions are within a few units in the last place
_BINOMIAL = 64 * _UNIT  # for the sums inside log_binomial
_TINY = 5e-324  # what an underflow may lose
_NEIGHBOURS = 2.0**52  # below it float64 holds every whole number and its neighbours
_SPLIT = 2.0**27 + 1  # Veltkamp's factor, which halves the digits of a float
_SMALL, _LARGE = 1e-250, 1e250  # between them the halves of a product neither underflow nor overflow


class Tracked:
    """A float64 scalar or array ``at`` with ``off``, at least its distance from the true number (nan: not known).

    ``x <= y`` and ``x >= y`` hold, elementwise, where the true numbers certainly are in that order.
    """

    __slots__ = ("at", "off")
    __array_ufunc__ = None  # an array on the left leaves the operation to this class

    def __init__(self, at: Value, off: Value = 0.0) -> None:
        self.at, self.off = at, off

    def __add__(self, other: Value) -> Tracked:
        return _added(self, _tracked(other))

    def __radd__(self, other: Value) -> Tracked:
        return _added(_tracked(other), self)

    def __sub__(self, other: Value) -> Tracked:
        return _added(self, -_tracked(other))

    def __rsub__(self, other: Value) -> Tracked:
        return _added(_tracked(other), -self)

    def __neg__(self) -> Tracked:
        return Tracked(-self.at, self.off)

    def __mul__(self, other: Value) -> Tracked:
        return _multiplied(self, _tracked(other))

    def __rmul__(self, other: Value) -> Tracked:
        return _multiplied(_tracked(other), self)

    def __truediv__(self, other: Value) -> Tracked:
        return _divided(self, _tracked(other))

    def __rtruediv__(self, other: Value) -> Tracked:
        return _divided(_tracked(other), self)

    def __pow__(self, exponent: Value) -> Tracked:
        return _power(self, _tracked(exponent))

    def __le__(self, other: Value) -> Value:
        return _certainly_at_most(self, _tracked(other))

    def __ge__(self, other: Value) -> Value:
        return _certainly_at_most(_tracked(other), self)


class TrackedFloats:
    """The operations of ``FLOATS`` on tracked values."""

    def number(self, value: int | Fraction) -> Value:
        return inexact(np.float64(value), value)

    def power(self, x: Value, exponent: Value) -> Value:
        return _power(_tracked(x), _tracked(exponent))

    def power_near_one(self, x: Value, exponent: Value) -> Value:
        return self.if_at_most(
            exponent, FEW_FACTORS, lambda: self.power(1 + x, exponent), lambda: self.exp(exponent * self.log1p(x))
        )

    def sqrt(self, x: Value) -> Value:
        x = _tracked(x)
        at = np.sqrt(x.at)
        # sqrt(x + e) - sqrt(x) and sqrt(x) - sqrt(x - e) are both at most min(e / sqrt(x), sqrt(e))
        return Tracked(at, np.fmin(_ratio(x.off, at), np.sqrt(x.off)) + _UNIT * at)

    def log(self, x: Value) -> Value:
        x = _tracked(x)
        at = np.log(x.at)
        return Tracked(at, -np.log1p(-_ratio(x.off, x.at)) + _LIBRARY * np.abs(at))

    def log1p(self, x: Value) -> Value:
        x = _tracked(x)
        at = np.log1p(x.at)
        return Tracked(at, -np.log1p(-_ratio(x.off, 1 + x.at) * (1 + _LIBRARY)) + _LIBRARY * np.abs(at))

    def log1p_ratio(self, x: Value, y: Value) -> Value:
        return self.log1p(x) / self.log1p(y)

    def exp(self, x: Value) -> Value:
        x = _tracked(x)
        at = np.exp(x.at)
        return Tracked(at, (at + _TINY) * np.expm1(x.off) + _rounded(at))

    def expm1(self, x: Value) -> Value:
        x = _tracked(x)
        at = np.expm1(x.at)
        return Tracked(at, 2 * np.exp(x.at) * np.expm1(x.off) + _rounded(at))

    def one_minus_root(self, x: Value, degree: Value) -> Value:
        return -self.expm1(self.log(x) / degree)

    def cosh(self, x: Value) -> Value:
        x = _tracked(x)
        at = np.cosh(x.at)
        return Tracked(at, 2 * at * np.expm1(x.off) + _rounded(at))

    def sin(self, x: Value) -> Value:
        x = _tracked(x)
        at = np.sin(x.at)
        return Tracked(at, x.off + _rounded(at))

    def arcsin(self, x: Value) -> Value:
        x = _tracked(x)
        at = np.arcsin(x.at)
        return Tracked(at, _by_steepest_arc(x) + _rounded(at))

    def arccos(self, x: Value) -> Value:
        x = _tracked(x)
        at = np.arccos(x.at)
        return Tracked(at, _by_steepest_arc(x) + _rounded(at))

    def pi(self) -> Value:
        return Tracked(FLOATS.pi(), _UNIT * np.pi)

    def min(self, *values: Value) -> Value:
        return _chosen(np.minimum, values)

    def max(self, *values: Value) -> Value:
        return _chosen(np.maximum, values)

    def ceil(self, x: Value) -> Value:
        x = _tracked(x)
        at = np.ceil(x.at)
        # beside an integer, or where whole numbers lie farther apart than 1, rounding may decide the ceiling
        decided = (np.ceil(x.at - x.off) == np.ceil(x.at + x.off)) & ((x.off == 0) | (np.abs(at) < 1 / _UNIT))
        return Tracked(at, np.where(decided, 0.0, np.inf))

    def log_binomial(self, top: Value, bottom: Value) -> Value:
        top, bottom = _tracked(top), _tracked(bottom)
        at = FLOATS.log_binomial(top.at, bottom.at)
        # the slopes are at most log(top + 1) in either argument
        moved = (top.off + bottom.off) * np.log1p(top.at + top.off)
        return Tracked(at, moved + _BINOMIAL * np.abs(at))

    def if_at_most(self, x: Value, y: Value, then: Callable[[], Value], otherwise: Callable[[], Value]) -> Value:
        x, y, first, second = _tracked(x), _tracked(y), _tracked(then()), _tracked(otherwise())
        holds = np.asarray(x.at) <= y.at
        at = np.where(holds, first.at, second.at)
        off = np.where(holds, first.off, second.off)
        return Tracked(at, np.where(is_decided(x, y), off, np.inf))

    def sum(self, summand: Callable[..., Value], *arrays: Value) -> Value:
        cells = [_tracked(array) for array in arrays]
        known = np.stack(np.broadcast_arrays(*(cell.at for cell in cells), *(cell.off for cell in cells)), axis=-1)
        rows, counts = np.unique(known, axis=0, return_counts=True)
        terms = (
            count * summand(*map(Tracked, row[: len(cells)], row[len(cells) :]))
            for row, count in zip(rows, counts, strict=True)
        )
        return sum(terms, start=self.number(0))

    def minimum_over_integers(
        self,
        objective: Callable[[Value], Value],
        step: Callable[[Value], Value],
        near: Callable[..., FloatArray],
        *arguments: Value,
    ) -> Value:
        centre = np.rint(near(*(_tracked(argument).at for argument in arguments)))
        candidates = [np.maximum(centre + shift, 1.0) for shift in (-1.0, 0.0, 1.0)]
        smallest = _chosen(np.minimum, tuple(objective(Tracked(k)) for k in candidates))
        # the objective falls and then rises: a certain fall to the first candidate and rise from the last enclose it
        into, beyond = (_tracked(step(Tracked(k))) for k in (np.maximum(candidates[0] - 1, 1.0), candidates[2]))
        falls = (candidates[0] == 1) | (into.at + into.off < 0)
        certain = falls & (beyond.at - beyond.off > 0) & (centre < _NEIGHBOURS)
        return Tracked(smallest.at, np.where(certain, smallest.off, np.inf))


def inexact(at: Value, exact: int | Fraction) -> Tracked:
    """The float nearest to an exact number, with the distance between the two.

    >>> inexact(0.5, Fraction(1, 2)).off, inexact(0.1, Fraction(1, 10)).off < 1e-16
    (0.0, True)
    """
    distance = abs(Fraction(float(at)) - exact)
    return Tracked(at, float(distance) * (1 + _UNIT) + _TINY if distance else 0.0)


def is_decided(x: Value, y: Value) -> Value:
    """Whether the order of two values is that of the true numbers, elementwise."""
    x, y = _tracked(x), _tracked(y)
    apart = np.abs(np.asarray(x.at) - y.at) > (x.off + y.off) * (1 + 4 * _UNIT)
    return apart | ((np.asarray(x.off) == 0) & (np.asarray(y.off) == 0))


def _tracked(x: Value) -> Tracked:
    return x if isinstance(x, Tracked) else Tracked(x)


def _rounded(at: Value) -> Value:
    return _LIBRARY * np.abs(at) + _TINY


def _ratio(off: Value, at: Value) -> Value:
    """``off / |at|``, and 0 for an exact value, be it 0 or infinite."""
    return np.where(np.asarray(off) == 0, 0.0, off / np.abs(np.asarray(at)))


def _added(x: Tracked, y: Tracked) -> Tracked:
    at = x.at + y.at
    second = at - x.at
    lost = (x.at - (at - second)) + (y.at - second)  # what the rounding lost, exactly (Knuth's two-sum)
    return Tracked(at, (x.off + y.off) * (1 + 4 * _UNIT) + np.abs(lost))


def _certainly_at_most(x: Tracked, y: Tracked) -> Value:
    return np.asarray(y.at) - x.at >= (x.off + y.off) * (1 + 4 * _UNIT)


def _multiplied(x: Tracked, y: Tracked) -> Tracked:
    at = x.at * y.at
    if _exact(x, y):
        return Tracked(at, np.where(_in_range(x.at, y.at, at), np.abs(_lost(x.at, y.at, at)), _cut(x, y, at)))
    exact = (np.asarray(x.at) == 0) & (np.asarray(x.off) == 0) | (np.asarray(y.at) == 0) & (np.asarray(y.off) == 0)
    off = np.abs(x.at) * y.off + x.off * (np.abs(y.at) + y.off) + _UNIT * np.abs(at) + _TINY
    return Tracked(at, np.where(exact, 0.0, off))


def _divided(x: Tracked, y: Tracked) -> Tracked:
    at = x.at / y.at
    if _exact(x, y):
        product = at * y.at
        rest = (x.at - product) - _lost(at, y.at, product)  # of the division, exactly
        rounding = np.abs(rest / y.at) * (1 + 4 * _UNIT)
        bound = np.where((np.asarray(x.at) == 0) & (np.asarray(y.at) != 0), 0.0, _UNIT * np.abs(at) + _TINY)
        return Tracked(at, np.where(_in_range(x.at, y.at, at), rounding, bound))
    least = np.abs(y.at) - y.off  # of the denominator's size
    off = np.where(least > 0, (x.off + np.abs(at) * y.off) / least, np.inf) + _UNIT * np.abs(at) + _TINY
    return Tracked(at, np.where((np.asarray(x.at) == 0) & (np.asarray(x.off) == 0) & (least > 0), 0.0, off))


def _exact(x: Tracked, y: Tracked) -> bool:
    return bool(np.all(np.asarray(x.off) == 0) and np.all(np.asarray(y.off) == 0))


def _cut(x: Tracked, y: Tracked, at: Value) -> Value:
    zero = (np.asarray(x.at) == 0) | (np.asarray(y.at) == 0)
    return np.where(zero, 0.0, _UNIT * np.abs(at) + _TINY)


def _in_range(*values: Value) -> Value:
    return reduce(np.logical_and, ((np.abs(v) > _SMALL) & (np.abs(v) < _LARGE) for v in map(np.asarray, values)))


def _lost(x: Value, y: Value, at: Value) -> Value:
    """``x y - at`` where ``at`` is the rounded product and all three are in range, exactly (Dekker's two-product)."""
    x_high, x_low = _halves(x)
    y_high, y_low = _halves(y)
    return ((x_high * y_high - at) + x_high * y_low + x_low * y_high) + x_low * y_low


def _halves(x: Value) -> tuple[Value, Value]:
    scaled = _SPLIT * x
    high = scaled - (scaled - x)
    return high, x - high


def _power(x: Tracked, exponent: Tracked) -> Tracked:
    at = x.at**exponent.at
    base = np.abs(np.asarray(x.at))
    if _exact(x, exponent) and np.all(np.asarray(exponent.at) == 2):
        square = _multiplied(x, x)
        return Tracked(at, square.off + 2 * np.abs(at - square.at))
    if _exact(x, exponent):
        return Tracked(at, np.where((base == 0) | (base == 1), 0.0, _rounded(at)))
    # |log| of the base moves by -log(1 - off / base), and the power's logarithm by what that and the exponent do
    moved = -np.abs(exponent.at) * np.log1p(-_ratio(x.off, x.at)) + np.abs(np.log(base)) * exponent.off
    near = np.abs(at) * np.expm1(moved) + _rounded(at)
    squared = 2 * base * np.asarray(x.off) + np.asarray(x.off) ** 2 + _rounded(at)
    return Tracked(at, np.where((np.asarray(exponent.at) == 2) & (exponent.off == 0), squared, near))


def _by_steepest_arc(x: Tracked) -> Value:
    reach = np.abs(x.at) + x.off
    steep = x.off / np.sqrt((1 - reach) * (1 + reach))
    return np.where(np.asarray(x.off) == 0, 0.0, np.where(reach < 1, steep * (1 + _LIBRARY), np.inf))


def _chosen(choose: Callable[[Value, Value], Value], values: tuple[Value, ...]) -> Tracked:
    tracked = [_tracked(value) for value in values]
    at = reduce(choose, (value.at for value in tracked))
    # nan, which is an unknown distance, propagates through both
    low = reduce(choose, (value.at - value.off for value in tracked))
    high = reduce(choose, (value.at + value.off for value in tracked))
    off = np.maximum(at - low, high - at)
    exact = reduce(np.logical_and, (np.asarray(value.off) == 0 for value in tracked))
    return Tracked(at, np.where(exact, 0.0, off * (1 + _UNIT) + 2 * _UNIT * np.abs(at)))


TRACKED = TrackedFloats()
