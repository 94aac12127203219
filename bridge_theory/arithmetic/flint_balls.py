"""The one module that touches python-flint: ball construction, outward rounding, three-valued comparison.

Traps it hides: ``arb(0.1)`` is a binary number, so constants come from rationals; ``float(x.lower())`` may lie above
the lower end, so ends are rounded from their exact mantissas; comparisons of overlapping balls are false both ways; the
square root of a negative ball is not a number instead of an error; the working precision is global.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from typing import Any, TypeAlias

from flint import arb, ctx, fmpq, fmpz

Ball: TypeAlias = Any
"""A python-flint ``arb``: midpoint and radius, every operation rounded outward."""

_LONGEST_EXACT = 8192  # bits; a longer exact number takes more time than it is worth
_HUGEST_EXPONENT = 1100  # beyond it a binary exponent over- or underflows a float64 for certain


@contextmanager
def working_precision(bits: int) -> Iterator[None]:
    """Compute with ``bits`` binary digits inside the block and restore the previous precision afterwards.

    >>> with working_precision(200):
    ...     ball(2).sqrt().rel_accuracy_bits() > 190
    True
    """
    before = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = before


def ball(value: int | Fraction) -> Ball:
    """The smallest ball around an exact number at the working precision.

    >>> ball(Fraction(1, 20)) * 20
    [1.00000000000000 +/- ...]
    """
    return arb(value) if isinstance(value, int) else arb(fmpq(value.numerator, value.denominator))


def rational(value: int | Fraction) -> Any:
    """An exact number that mixes with balls: ``+ - * /`` among such numbers stay exact, with a ball they give a ball.

    >>> rational(Fraction(1, 10)) * 20, rational(Fraction(1, 10)) * ball(20)
    (2, [2.00000000000000 +/- ...])
    """
    return fmpq(value.numerator, value.denominator)


def as_ball(x: Any) -> Ball:
    """A ball around a value of the rigorous arithmetic, be it a ball already or an exact number."""
    return x if isinstance(x, arb) else ball(x) if isinstance(x, int | Fraction) else arb(x)


def as_fraction(x: Any) -> Fraction | None:
    """The exact number that a value of the rigorous arithmetic is, or None for a ball around several.

    >>> as_fraction(rational(3) / 2), as_fraction(ball(4).sqrt()), as_fraction(ball(2).sqrt())
    (Fraction(3, 2), Fraction(2, 1), None)
    """
    if isinstance(x, int | Fraction):
        return Fraction(x)
    if isinstance(x, fmpq):
        return Fraction(int(x.p), int(x.q))
    if not x.is_exact() or not x.is_finite():
        return None
    mantissa, exponent = _exact(x)
    return Fraction(mantissa) * Fraction(2) ** exponent if abs(exponent) <= _LONGEST_EXACT else None


def exact_root(x: Any, degree: Any) -> Any:
    """The root of an exact nonnegative number where it is rational, or None.

    >>> exact_root(rational(Fraction(9, 4)), 2), exact_root(rational(2), 2), exact_root(rational(27), rational(3))
    (3/2, None, 3)
    """
    power, order = as_fraction(x), as_fraction(degree)
    if power is None or order is None or order.denominator != 1 or power < 0:
        return None
    parts = [_whole_root(part, order.numerator) for part in (power.numerator, power.denominator)]
    return None if None in parts else rational(Fraction(*parts))  # type: ignore[arg-type]


def _whole_root(power: int, degree: int) -> int | None:
    if power <= 1 or degree == 1:
        return power
    if degree >= power.bit_length():  # 2 ** degree is larger
        return None
    root = math.isqrt(power) if degree == 2 else int(fmpz(power).root(degree))
    return root if root**degree == power else None


def exact_power(x: Any, exponent: Any) -> Any:
    """An exact number to a whole power, where the result is not too long to write down, or None.

    >>> exact_power(rational(2), rational(-3)), exact_power(rational(2), rational(10**9))
    (1/8, None)
    """
    base, power = as_fraction(x), as_fraction(exponent)
    if base is None or power is None or power.denominator != 1 or (base == 0 and power < 0):
        return None
    if base in (0, 1):
        return rational(1 if base == 1 or power == 0 else 0)
    bits = base.numerator.bit_length() + base.denominator.bit_length()
    return rational(base**power.numerator) if bits * abs(power) <= _LONGEST_EXACT else None


def box(lower: int | Fraction, upper: int | Fraction) -> Ball:
    """A ball that contains every real number from ``lower`` to ``upper``.

    >>> box(1, 3).contains(2)
    True
    """
    return ball(lower).union(ball(upper))


def everything() -> Ball:
    """The ball that contains every real number: nothing is known."""
    return arb(0, math.inf)


def pi_ball() -> Ball:
    """The number pi."""
    return arb.pi()


def ends(x: Any) -> tuple[float, float]:
    """Floats below and above every number of a ball (or an exact number), as close as float64 allows.

    >>> low, high = ends(ball(Fraction(1, 10)))
    >>> Fraction(low) <= Fraction(1, 10) <= Fraction(high), high - low < 1e-16
    (True, True)
    """
    x = as_ball(x)
    if x.is_nan() or not x.is_finite():
        return -math.inf, math.inf
    return _round_down(*_exact(x.lower())), 0.0 - _round_down(*_exact(-x.upper()))


def midpoint(x: Any) -> float:
    """A float near the middle of a ball; not certified, for starting a search."""
    return float(as_ball(x).mid())


def exact_integer(x: Any) -> int | None:
    """The integer this ball is exactly equal to, or None.

    >>> exact_integer(ball(7)), exact_integer(ball(Fraction(1, 3)))
    (7, None)
    """
    x = as_ball(x)
    if not (x.is_exact() and x.is_integer()):
        return None
    return int(x.unique_fmpz())


def accuracy_bits(x: Any) -> int:
    """How many leading bits of a ball are certain; an exact ball has as many as anyone wants."""
    x = as_ball(x)
    return int(x.rel_accuracy_bits()) if x.is_finite() else 0


def _exact(x: Ball) -> tuple[int, int]:
    mantissa, exponent = x.man_exp()
    return int(mantissa), int(exponent)


def _round_down(mantissa: int, exponent: int) -> float:
    size = mantissa.bit_length() + exponent
    if size > _HUGEST_EXPONENT:
        return math.nextafter(math.inf, 0.0) if mantissa > 0 else -math.inf
    if size < -_HUGEST_EXPONENT:
        return 0.0 if mantissa >= 0 else math.nextafter(0.0, -1.0)
    value = Fraction(mantissa) * Fraction(2) ** exponent
    try:
        nearest = float(value)
    except OverflowError:
        return math.nextafter(math.inf, 0.0) if value > 0 else -math.inf
    return nearest if Fraction(nearest) <= value else math.nextafter(nearest, -math.inf)
