"""Inequalities about the logistic loss for all real arguments: derivations that SymPy and Z3 run.

The pattern of a derivation: value and slope of a difference vanish where both sides touch, and its second derivative
has one sign everywhere; the sign becomes a polynomial inequality in exponentials, which Z3 proves.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from itertools import product
from typing import Any

import sympy

import bridge_theory as theory
from bridge_theory.arithmetic.flint_balls import Ball, ball
from bridge_theory.arithmetic.symbols import SYMBOLS
from proofs_checks.exact.certify import at_most, scaled, value_of
from proofs_checks.outcome import Outcome, Tally, together
from proofs_checks.smt import prove, reals
from proofs_checks.symbolic import identity

_Z, _Y = sympy.symbols("z y", real=True)
_R = sympy.Symbol("r", positive=True)


def _loss(z: Any) -> Any:
    return sympy.log(1 + sympy.exp(-z))


def _curvature(z: Any) -> Any:
    return sympy.exp(z) / (1 + sympy.exp(z)) ** 2


def convex_loss(*, sign: int = 1) -> Outcome:
    """The loss has second derivative e^z/(1 + e^z)^2 > 0, so that log sigma lies below each of its tangents."""
    (a,) = reals("a")
    return together(
        identity("second derivative of the loss", sympy.diff(_loss(_Z), _Z, 2), sign * _curvature(_Z)),
        prove("a/(1 + a)^2 is positive for a = e^z", [a > 0], a > 0 * (1 + a) * (1 + a)),
    )


def quarter_curvature(*, constant: int = 4) -> Outcome:
    """(1 + a)^2/4 - a = (1 - a)^2/4 >= 0: the curvature of the loss is at most 1/4."""
    (a,) = reals("a")
    return together(
        identity("second derivative of the loss", sympy.diff(_loss(_Z), _Z, 2), _curvature(_Z)),
        prove("a/(1 + a)^2 <= 1/4", [a > 0], constant * a <= (1 + a) * (1 + a)),
    )


def price_of_a_direction(*, half: str = "1/2") -> Outcome:
    """One eigenvalue a of X'X/4: a s/2 + KL(N(m, s) || N(0, 1/lambda)) = lambda m^2/2 + log(1 + a/lambda)/2.

    Here s = 1/(a + lambda); expectations lose at most a s/2 by the curvature bound.
    """
    a, lam = sympy.symbols("a lam", positive=True)
    m = sympy.Symbol("m", real=True)
    s = 1 / (a + lam)
    divergence = (lam * s + lam * m**2 - 1 - sympy.log(lam * s)) / 2
    total = lam * m**2 / 2 + sympy.Rational(half) * sympy.log(1 + a / lam)
    return identity("one direction", sympy.expand_log(a * s / 2 + divergence - total, force=True), sympy.Integer(0))


def tangent_of_the_logarithm(*, sign: int = 1) -> Outcome:
    """log x <= x - 1: value and slope agree at 1, the second derivative is -1/x^2."""
    x = sympy.Symbol("x", positive=True)
    gap = x - 1 - sympy.log(x)
    (y,) = reals("y")
    return together(
        identity("value", gap.subs(x, 1), sympy.Integer(0)),
        identity("slope", sympy.diff(gap, x).subs(x, 1), sympy.Integer(0)),
        identity("second derivative", sympy.diff(gap, x, 2), sign / x**2),
        prove("1/x^2 is positive", [y > 0], 1 / (y * y) > 0),
    )


def jaakkola_jordan(*, constant: int = 4) -> Outcome:
    """-log 2cosh(sqrt(u)/2) is convex in u = z^2, and the bound of bridge_theory is z/2 plus its tangent at xi^2."""
    u, x, xi = sympy.symbols("u x xi", positive=True)
    even = -sympy.log(2 * sympy.cosh(sympy.sqrt(u) / 2))
    slope = -sympy.tanh(sympy.sqrt(u) / 2) / (constant * sympy.sqrt(u))
    falling = sympy.diff(sympy.tanh(x) / x, x) * x**2 * sympy.cosh(x) ** 2
    rest = sympy.sinh(2 * x) - 2 * x
    stated = -_loss(xi) + (_Z - xi) / 2 + slope.subs(u, xi**2) * (_Z**2 - xi**2)
    (y,) = reals("y")
    return together(
        identity("1/sigma(z)", 1 + sympy.exp(-_Z), sympy.exp(-_Z / 2) * 2 * sympy.cosh(_Z / 2)),
        identity("its slope in u", sympy.diff(even, u), slope),
        identity("tanh(x)/x falls: its slope", falling, -rest / 2),
        identity("sinh(2x) - 2x at 0", rest.subs(x, 0), sympy.Integer(0)),
        identity("its slope is a square", sympy.diff(rest, x), 4 * sympy.sinh(x) ** 2),
        prove("squares", [y > 0], 4 * y * y > 0),
        identity("the formula", theory.log_sigmoid_lower(SYMBOLS, margin=_Z, tangent=xi), stated),
    )


def jaakkola_jordan_at_points(*, shift: Fraction = Fraction(0)) -> Outcome:
    """The formula lies below log sigma at rational points, those where both touch included, in balls."""
    tally = Tally()
    for i, j in product(range(-24, 25), range(17)):
        z, xi = Fraction(i, 2), Fraction(j, 2)
        below = at_most(partial(_quadratic, z, xi, shift), partial(_log_sigmoid, z))
        tally.expect(below, f"the bound exceeds log sigma at z = {z}, xi = {xi}")
    return tally.outcome("below log sigma on a grid, equal where it touches")


def _quadratic(z: Fraction, xi: Fraction, shift: Fraction) -> Ball:
    return value_of(theory.log_sigmoid_lower, margin=z, tangent=xi) + ball(shift)


def _log_sigmoid(z: Fraction) -> Ball:
    return -(ball(-z).exp() + 1).log()


def curvature_inequality(*, power: int = 2) -> Outcome:
    """loss(z+y) - loss(z) - loss'(z) y - sigma'(z)(e^-|y| + |y| - 1) touches 0 at y = 0 and is convex in |y|.

    Convex, because sigma'(z+y) >= sigma'(z) e^-|y|: with a = e^z > 0 and q = e^|y| >= 1 this is a q^2 (1 + a)^2 >=
    a (1 + a q)^2 for y > 0 and a q^2 (1 + a)^2 >= a (q + a)^2 for y < 0.
    """
    a, q = reals("a q")
    parts = []
    for sign in (1, -1):
        step = sympy.Symbol("s", nonnegative=True)
        rest = _curvature(_Z) * (sympy.exp(-step) + step - 1)
        gap = _loss(_Z + sign * step) - _loss(_Z) - sympy.diff(_loss(_Z), _Z) * sign * step - rest
        second = _curvature(_Z + sign * step) - _curvature(_Z) * sympy.exp(-step)
        parts += [
            identity(f"value at 0, side {sign}", gap.subs(step, 0), sympy.Integer(0)),
            identity(f"slope at 0, side {sign}", sympy.diff(gap, step).subs(step, 0), sympy.Integer(0)),
            identity(f"second derivative, side {sign}", sympy.diff(gap, step, 2), second),
        ]
    wider = (1 + a) * (1 + a) * (q * q if power == 2 else q)
    return together(
        *parts,
        prove("y > 0", [a > 0, q >= 1], wider >= (1 + a * q) * (1 + a * q)),
        prove("y < 0", [a > 0, q >= 1], wider >= (q + a) * (q + a)),
    )


def factor_falls(*, sign: int = 1) -> Outcome:
    """2(e^-r + r - 1)/r^2 falls: r^3/2 times its slope is h = 2 - r - (r + 2)e^-r, and h(0) = h'(0) = 0, h'' < 0."""
    factor = theory.curvature_factor(SYMBOLS, reach=_R)
    h = 2 - _R - (_R + 2) * sympy.exp(-_R)
    y, decay = reals("y e")
    return together(
        identity("the formula", factor, 2 * (sympy.exp(-_R) + _R - 1) / _R**2),
        identity("slope", sympy.diff(factor, _R) * _R**3 / 2, h),
        identity("h at 0", h.subs(_R, 0), sympy.Integer(0)),
        identity("slope of h at 0", sympy.diff(h, _R).subs(_R, 0), sympy.Integer(0)),
        identity("second derivative of h", sympy.diff(h, _R, 2), -sign * _R * sympy.exp(-_R)),
        prove("r e^-r is positive", [y > 0, decay > 0], y * decay > 0),
    )


def curvature_at_points(*, share: Fraction = Fraction(1)) -> Outcome:
    """The inequality with the factor of bridge_theory at rational points, in balls; ``share`` multiplies the factor."""
    tally = Tally()
    for i, j, k in product(range(-6, 7), range(1, 9), range(-4, 5)):
        z, r = Fraction(i), Fraction(j, 2)
        y = r * k / 4
        tally.expect(
            at_most(partial(_log_sigmoid, z + y), partial(_above, z, r, y, share)),
            f"the loss is lower at z = {z}, y = {y}",
        )
    return tally.outcome("the loss lies above its quadratic on a grid")


def _above(z: Fraction, r: Fraction, y: Fraction, share: Fraction) -> Ball:
    """Minus the quadratic that lies below the loss: it lies above log sigma(z + y)."""
    slope, curvature = 1 / (ball(z).exp() + 1), 1 / (ball(z).exp() + ball(-z).exp() + 2)
    quadratic = curvature * scaled(share, theory.curvature_factor, reach=r) * ball(y * y / 2)
    return _log_sigmoid(z) + slope * ball(y) - quadratic
