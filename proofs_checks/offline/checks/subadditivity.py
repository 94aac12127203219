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

PIECES: Mapping[int, Mapping[int, Fraction]] = {
    2: {},
    3: {3: Fraction(17, 50), 4: Fraction(33, 160), 8: Fraction(4131, 6400)},
    4: {3: Fraction(16, 27)},
}
"""Coefficients a_k of the middle piece, by the constant c that they prove (2 is a mutant: it proves nothing)."""


def induction_step(*, constant: int = 3) -> Outcome:
    """H^2 <= constant * sum: V(1/c) = -1/c, V is C^1, V >= -w, w V' >= -1, and (*) on all nine pieces."""
    coefficients = PIECES[constant]
    corner = Fraction(1, constant)
    joints = Tally()
    joints.expect(_middle(coefficients, corner) == -corner, "V(1/c) is not -1/c")
    if coefficients:
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
            queries.append(prove(f"(*) for w {w_name}, w r {x_name}", [*w_range, *x_range, w > 0, x >= 0], goal))
    return together(joints.outcome("V meets at 1/c"), *queries)


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
    result = base
    for _ in range(exponent - 1):
        result = result * base
    return result


def _z3(number: Fraction) -> Any:
    import z3

    return z3.RealVal(f"{number.numerator}/{number.denominator}")
