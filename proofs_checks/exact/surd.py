r"""Exact numbers of the form :math:`\sum_k c_k\sqrt{k}` with rational :math:`c_k` and squarefree :math:`k`.

Bhattacharyya coefficients of rational laws are such numbers, and so are their sums and products. Roots of distinct
squarefree numbers are linearly independent over the rationals, so a number is zero only if it has no terms; a nonzero
one shows its sign at some finite precision. Comparisons therefore always terminate with the truth.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, total_ordering
from math import gcd, isqrt, prod

from flint import fmpz

from bridge_theory.arithmetic.flint_balls import Ball, ball
from bridge_theory.errors import InputError

Rational = int | Fraction


@total_ordering
@dataclass(frozen=True, eq=False)
class Surd:
    """A sum of rational multiples of square roots of squarefree numbers; build one with `surd` or `root`.

    >>> root(Fraction(1, 2)) * root(2) == 1
    True
    >>> root(2) + root(3) > root(Fraction(989, 100))
    True
    """

    terms: tuple[tuple[int, Fraction], ...]

    def __add__(self, other: Exact) -> Surd:
        sums = dict(self.terms)
        for radicand, factor in surd(other).terms:
            sums[radicand] = sums.get(radicand, Fraction(0)) + factor
        return _collected(sums)

    def __neg__(self) -> Surd:
        return Surd(tuple((radicand, -factor) for radicand, factor in self.terms))

    def __sub__(self, other: Exact) -> Surd:
        return self + -surd(other)

    def __mul__(self, other: Exact) -> Surd:
        products: dict[int, Fraction] = {}
        for k, c in self.terms:
            for j, e in surd(other).terms:
                common = gcd(k, j)
                radicand = k * j // common**2
                products[radicand] = products.get(radicand, Fraction(0)) + c * e * common
        return _collected(products)

    __radd__ = __add__
    __rmul__ = __mul__

    def __rsub__(self, other: Exact) -> Surd:
        return surd(other) + -self

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Surd | Fraction | int) and self.terms == surd(other).terms

    def __lt__(self, other: Exact) -> bool:
        return (self - other).sign() < 0

    def __hash__(self) -> int:
        return hash(self.terms)

    def sign(self) -> int:
        """-1, 0 or 1, decided by integer square roots of rising precision."""
        if not self.terms:
            return 0
        digits = 64
        while True:
            low = high = Fraction(0)
            for radicand, factor in self.terms:
                floor = isqrt(radicand << (2 * digits))
                ends = (factor * floor, factor * (floor if radicand == 1 else floor + 1))
                low, high = low + min(ends), high + max(ends)
            if low > 0 or high < 0:
                return 1 if low > 0 else -1
            digits *= 2

    def rational(self) -> Fraction:
        """The number as a fraction; refused where a root remains."""
        if any(radicand != 1 for radicand, _ in self.terms):
            raise InputError(f"{self} is irrational, expected a rational number.")
        return sum((factor for _, factor in self.terms), Fraction(0))

    def ball(self) -> Ball:
        """A ball around the number at the working precision."""
        return sum((ball(factor) * ball(radicand).sqrt() for radicand, factor in self.terms), start=ball(0))

    def __float__(self) -> float:
        return float(self.ball().mid())

    def __str__(self) -> str:
        shown = [str(c) if k == 1 else f"{c}*sqrt({k})" for k, c in self.terms]
        return " + ".join(shown) or "0"


Exact = Surd | Fraction | int


def surd(value: Exact) -> Surd:
    """An exact number as a `Surd`."""
    return value if isinstance(value, Surd) else _collected({1: Fraction(value)})


def root(value: Rational) -> Surd:
    """The square root of a nonnegative rational number.

    >>> print(root(Fraction(8, 9)))
    2/3*sqrt(2)
    """
    number = Fraction(value)
    if number < 0:
        raise InputError(f"the square root of {number} is not real; expected a nonnegative number.")
    (outside_n, inside_n), (outside_d, inside_d) = map(_split_square, (number.numerator, number.denominator))
    return _collected({inside_n * inside_d: Fraction(outside_n, outside_d * inside_d)})


def at_most_roots(value: Exact, *parts: tuple[Rational, Exact]) -> bool:
    r"""Whether :math:`\sqrt{value} \le c_1\sqrt{x_1} + c_2\sqrt{x_2}` for one or two parts ``(c, x)``, exactly.

    >>> at_most_roots(8, (2, 2)), at_most_roots(9, (2, 2)), at_most_roots(9, (1, 1), (2, 1))
    (True, False, True)
    """
    squares = [surd(x) * (Fraction(c) ** 2) for c, x in parts]
    rest = surd(value) - sum(squares, surd(0))
    if len(squares) == 1 or rest <= 0:
        return rest <= 0
    first, second = squares
    return rest * rest <= first * second * 4


@cache
def _split_square(number: int) -> tuple[int, int]:
    """``number = outside^2 * inside`` with ``inside`` squarefree."""
    if number == 0:
        return 1, 0
    powers: Counter[int] = Counter()
    for prime, power in fmpz(number).factor():  # python-flint 0.9 may list one prime twice
        powers[int(prime)] += power
    outside = prod(prime ** (power // 2) for prime, power in powers.items())
    inside = prod(prime for prime, power in powers.items() if power % 2)
    return outside, inside


def _collected(sums: dict[int, Fraction]) -> Surd:
    return Surd(tuple(sorted((radicand, factor) for radicand, factor in sums.items() if factor and radicand)))
