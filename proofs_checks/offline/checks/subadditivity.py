"""T2's induction: a function V for which one step of the dynamic programme never gains, by small Z3 queries.

With w = BC weight, x = w r and everything multiplied by 2 w^2, the step inequality (*) of the proof reads

    2 w^2 V(x) <= 2 w^2 V(w) + w V'(w) (x^2 - w^2) + (x - w)^2,

a polynomial inequality on each product of the three pieces of V: -x up to 1/c, -1/2 + sum_k a_k (1 - x)^k up to 1, then
-1/2.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from proofs_checks.outcome import Outcome, Tally, together
from proofs_checks.smt import prove, reals

SIMPLE: Mapping[int, Fraction] = {3: Fraction(16, 27)}
"""Coefficients a_k of a middle piece that proves c = 4."""


def induction_step(*, constant: Fraction = Fraction(297, 100)) -> Outcome:
    """H^2 <= constant * sum: V(1/c) = -1/c, V is C^1, V >= -w, w V' >= -1, and (*) on all nine pieces."""
    coefficients = SIMPLE if constant == 4 else _joined(constant)
    corner = 1 / Fraction(constant)
    joints = Tally()
    joints.expect(_middle(coefficients, corner) == -corner, "V(1/c) is not -1/c")
    joints.expect(_middle_slope(coefficients, corner) == -1, "V' jumps at 1/c")
    x, w = reals("x w")
    queries = [
        prove("V >= -w in the middle", [w >= _z3(corner), w <= 1], _middle(coefficients, w) >= -w),
        prove("w V' >= -1 in the middle", [w >= _z3(corner), w <= 1], w * _middle_slope(coefficients, w) >= -1),
    ]
    for w_name, w_range, at_w, slope_w in _pieces(coefficients, w, corner):
        for x_name, x_range, at_x, _ in _pieces(coefficients, x, corner):
            if (w_name, x_name) == ("small", "medium"):
                queries += _small_to_medium(coefficients, x, w, corner)
                continue
            goal = 2 * w * w * at_x <= 2 * w * w * at_w + w * slope_w * (x * x - w * w) + (x - w) * (x - w)
            if (w_name, x_name) == ("medium", "medium"):
                queries += _medium_to_medium(coefficients, x, w, goal, corner)
                continue
            queries.append(prove(f"(*) for w {w_name}, w r {x_name}", [*w_range, *x_range, w > 0, x >= 0], goal))
    return together(joints.outcome("V meets at 1/c"), *queries)


def _joined(constant: Fraction) -> dict[int, Fraction]:
    """The middle piece with a_3 = 42/125 and a_4 = 3/20 whose a_6 and a_9 solve V(1/c) = -1/c and V'(1/c) = -1."""
    v = 1 - 1 / Fraction(constant)
    first = {3: Fraction(42, 125), 4: Fraction(3, 20)}
    height = Fraction(1, 2) - 1 / Fraction(constant) - sum(a * v**k for k, a in first.items())
    slope = 1 - sum(k * a * v ** (k - 1) for k, a in first.items())
    # a_6 v^6 + a_9 v^9 = height and 6 a_6 v^5 + 9 a_9 v^8 = slope
    return {**first, 6: (9 * height - v * slope) / (3 * v**6), 9: (v * slope - 6 * height) / (3 * v**9)}


def _medium_to_medium(
    coefficients: Mapping[int, Fraction], x: Any, w: Any, goal: Any, corner: Fraction
) -> list[Outcome]:
    """There right - left = (x - w)^2 Q, and Q rises in x where every a_k >= 0, so that x = 1/c is the worst case.

    With a = 1 - w and b = 1 - x, Q = 1 + w V'(w) - 2 w^2 sum_k a_k sum_{j <= k-2} (j + 1) a^j b^(k-2-j).
    """
    falling = Tally()
    falling.expect(all(a >= 0 for a in coefficients.values()), "a coefficient is negative, so that Q need not rise")
    medium = [w >= _z3(corner), w <= 1]
    quotient = _quotient(coefficients, w, x)
    gap = goal.arg(1) - goal.arg(0)
    return [
        falling.outcome("Q rises in w r"),
        prove("(*) for both medium: right - left is (x - w)^2 Q", medium, gap == (x - w) * (x - w) * quotient),
        prove("(*) for both medium: Q at w r = 1/c", medium, _quotient(coefficients, w, _z3(corner)) >= 0),
    ]


def _quotient(coefficients: Mapping[int, Fraction], w: Any, x: Any) -> Any:
    a, b = 1 - w, 1 - x
    curvature: Any = _z3(Fraction(0))
    for k, factor in coefficients.items():
        for j in range(k - 1):
            curvature = curvature + _z3(factor * (j + 1)) * _power(a, j) * _power(b, k - 2 - j)
    return 1 + w * _middle_slope(coefficients, w) - 2 * w * w * curvature


def _small_to_medium(coefficients: Mapping[int, Fraction], x: Any, w: Any, corner: Fraction) -> list[Outcome]:
    """There (right - left) / w^2 = -w - x^2/w + (x/w - 1)^2 - 2 V(x) falls in w, so that w = 1/c is the worst case."""
    edge, medium = _z3(corner), [x >= _z3(corner), x <= 1]
    falls = w * w * w + 2 * x * x - w * (x * x + 2 * x) >= 0
    at_edge = 2 * edge * edge * _middle(coefficients, x) <= -edge * edge * edge - edge * x * x + (x - edge) * (x - edge)
    return [
        prove("(*) for w small, w r medium: falls in w", [*medium, w > 0, w <= edge], falls),
        prove("(*) for w small, w r medium: at w = 1/c", medium, at_edge),
    ]


def _pieces(coefficients: Mapping[int, Fraction], u: Any, corner: Fraction) -> list[tuple[str, list[Any], Any, Any]]:
    half = _z3(Fraction(1, 2))
    return [
        ("small", [u <= _z3(corner)], -u, _z3(Fraction(-1))),
        ("medium", [u >= _z3(corner), u <= 1], _middle(coefficients, u), _middle_slope(coefficients, u)),
        ("large", [u >= 1], -half, _z3(Fraction(0))),
    ]


def _middle(coefficients: Mapping[int, Fraction], u: Any) -> Any:
    value: Any = Fraction(-1, 2) if isinstance(u, Fraction) else _z3(Fraction(-1, 2))
    for power, factor in coefficients.items():
        value = value + _like(factor, u) * _power(1 - u, power)
    return value


def _middle_slope(coefficients: Mapping[int, Fraction], u: Any) -> Any:
    value: Any = Fraction(0) if isinstance(u, Fraction) else _z3(Fraction(0))
    for power, factor in coefficients.items():
        value = value - _like(factor * power, u) * _power(1 - u, power - 1)
    return value


def _like(number: Fraction, u: Any) -> Any:
    return number if isinstance(u, Fraction) else _z3(number)


def _power(base: Any, exponent: int) -> Any:
    result = base if exponent else 1
    for _ in range(exponent - 1):
        result = result * base
    return result


def _z3(number: Fraction) -> Any:
    import z3

    return z3.RealVal(f"{number.numerator}/{number.denominator}")
