"""The values a solver may try, indexed by integers: whole numbers, or every float64 of a domain in order."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from bridge_theory.parameters import Domain, Exact

LARGEST_INTEGER = 10**24
LARGEST_REAL = 1e100


@dataclass(frozen=True)
class Grid:
    """Indices ``first..last`` and the exact number each of them stands for, increasing."""

    first: int
    last: int
    number: Callable[[int], Exact]


def integer_grid(domain: Domain) -> Grid:
    """The whole numbers of a domain, up to 10^24 where it has no end.

    >>> grid = integer_grid(Domain(1, integer=True))
    >>> grid.number(grid.first), grid.last == LARGEST_INTEGER
    (1, True)
    """
    return Grid(int(domain.low), LARGEST_INTEGER if domain.high is None else int(domain.high), lambda index: index)


def float_grid(domain: Domain) -> Grid:
    """Every float64 of a domain in order, up to 1e100 where it has no end.

    >>> grid = float_grid(Domain(0, 1, opens=(True, True)))
    >>> float(grid.number(grid.last)), float(grid.number(grid.last + 1))
    (0.9999999999999999, 1.0)
    >>> [float(float_grid(Domain(-1, 1)).number(index)) for index in (-1, 0, 1)]
    [-5e-324, 0.0, 5e-324]
    """
    high = LARGEST_REAL if domain.high is None else float(domain.high)
    low = float(domain.low)
    first = math.nextafter(low, math.inf) if domain.opens[0] else low
    last = math.nextafter(high, 0.0) if domain.opens[1] else high
    return Grid(_bits(first), _bits(last), _number)


def _bits(value: float) -> int:
    # nonnegative floats are ordered as their bit patterns, and a negative one mirrors its opposite
    pattern = int(struct.unpack("<q", struct.pack("<d", abs(value)))[0])
    return -pattern if value < 0 else pattern


def _number(bits: int) -> Exact:
    value = Fraction(struct.unpack("<d", struct.pack("<q", abs(bits)))[0])
    signed = -value if bits < 0 else value
    return signed.numerator if signed.denominator == 1 else signed
