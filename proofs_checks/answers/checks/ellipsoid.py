"""The ellipsoid around the likelihood set: the square completed, and enclosure in balls on random sets."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

import bridge_theory as theory
from bridge_theory.arithmetic.flint_balls import Ball, ball, ends, working_precision
from proofs_checks.answers.checks.logistic import Answers, Vector, dot, evidence, fit, random_answers, rational
from proofs_checks.context import Context
from proofs_checks.exact.certify import value_of
from proofs_checks.exact.every import QUICK
from proofs_checks.outcome import Outcome, Tally

DELTA = Fraction(1, 20)
_BITS = 128


def completed_square(*, factor: int = 2) -> Outcome:
    """(1/2) D'AD + u'D <= b + eta/2 (W^2 - |w^|^2) is |D + A^-1 u|_A^2 <= 2b + eta(W^2 - |w^|^2) + |u|^2_A^-1."""
    import sympy

    from bridge_theory.arithmetic.symbols import SYMBOLS
    from proofs_checks.symbolic import identity

    a11, a12, a22, u1, u2, d1, d2, b = sympy.symbols("a11 a12 a22 u1 u2 d1 d2 b", real=True)
    eta, W, n, newton = sympy.symbols("eta W n newton", positive=True)
    A, u, step = sympy.Matrix([[a11, a12], [a12, a22]]), sympy.Matrix([u1, u2]), sympy.Matrix([d1, d2])
    squared = (u.T * A.inv() * u)[0]
    moved = step + A.inv() * u
    formula = theory.ellipsoid_radius_squared(SYMBOLS, slack=b, ridge=eta, W=W, weight_norm=n, newton_norm=newton).subs(
        newton**2, squared
    )
    before = b + eta / 2 * (W**2 - n**2) - (step.T * A * step)[0] / 2 - (u.T * step)[0]
    after = formula - (moved.T * A * moved)[0]
    return identity("both sides", sympy.simplify(factor * before - after), sympy.Integer(0))


def encloses(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """Points certainly inside the likelihood set and the ball lie inside the ellipsoid of four passes, in balls."""
    rng, tally, radii = context.rng(), Tally(), []
    for _ in range(context.pick(quick=6, full=24)):
        answers, _ = random_answers(rng, int(rng.integers(5, 40)), 2)
        x, lam, W = answers.floats(), 0.25, Fraction(4)
        middle = rational(fit(x, lam) * min(1.0, 3.5 / max(1e-9, float(np.linalg.norm(fit(x, lam))))))
        level = Fraction(int(np.floor(64 * (float(evidence(x, fit(x, lam), lam)) + float(np.log(float(DELTA)))))), 64)
        with working_precision(_BITS):
            squared, matrix, centre = ellipsoid(answers, middle, Fraction(1, 8), W, level)
            for w in _boundary(answers, middle, level, W, rng):
                offset = [ball(entry) - c for entry, c in zip(w, centre, strict=True)]
                distance = _form(matrix, offset)
                tally.expect(bool(distance <= ball(share) * squared), f"{w} lies outside, {distance} > {squared}")
        radii.append(float(squared.mid()) ** 0.5)
    return tally.outcome(f"every point of every set lies inside; median rho {np.median(radii):.1f}")


Matrix = tuple[Ball, Ball, Ball]
"""The entries 11, 12, 22 of a symmetric matrix."""


def ellipsoid(
    answers: Answers, middle: Vector, eta: Fraction, W: Fraction, level: Fraction, passes: int = 4
) -> tuple[Ball, Matrix, list[Ball]]:
    """rho^2, A and the centre by the statement's rule, in balls; ``level`` is the threshold of the log-likelihood."""
    reaches = [abs(dot(x, middle)) + W * _at_least_norm(x) for x in answers.oriented]
    u = [-g + ball(eta * w) for g, w in zip(answers.gradient(middle), middle, strict=True)]
    slack = answers.log_likelihood(middle) - ball(level)
    for _ in range(passes):
        weights = [_curvature(dot(x, middle), r) for x, r in zip(answers.oriented, reaches, strict=True)]
        matrix = _matrix(answers, weights, eta)
        inverse = _inverse(matrix)
        newton = _form(inverse, u).sqrt()
        squared = value_of(
            theory.ellipsoid_radius_squared, slack=lambda: slack, ridge=eta, W=W,
            weight_norm=lambda: ball(dot(middle, middle)).sqrt(), newton_norm=lambda newton=newton: newton,
        )  # fmt: skip
        step = _applied(inverse, u)
        centre = [ball(w) - s for w, s in zip(middle, step, strict=True)]
        reaches = [
            min(old, _upper(abs(_inner(x, step)) + (squared.max(ball(0)) * _form(inverse, list(map(ball, x)))).sqrt()))
            for x, old in zip(answers.oriented, reaches, strict=True)
        ]
    return squared, matrix, centre


def _curvature(z: Fraction, reach: Fraction) -> Fraction:
    """sigma'(z) times the factor of the reach, rounded down."""
    slope = 1 / (ball(z).exp() + ball(-z).exp() + 2)
    factor = value_of(theory.curvature_factor, reach=reach) if reach else ball(1)
    return Fraction(max(0.0, ends(slope * factor)[0]))


def _at_least_norm(x: Vector) -> Fraction:
    return _upper(ball(dot(x, x)).sqrt())


def _upper(value: Ball) -> Fraction:
    return Fraction(ends(value)[1])


def _matrix(answers: Answers, weights: list[Fraction], eta: Fraction) -> Matrix:
    def entry(i: int, j: int) -> Ball:
        total = sum((c * x[i] * x[j] for c, x in zip(weights, answers.oriented, strict=True)), Fraction(0))
        return ball(total + (eta if i == j else 0))

    return entry(0, 0), entry(0, 1), entry(1, 1)


def _inverse(matrix: Matrix) -> Matrix:
    a, b, c = matrix
    determinant = a * c - b * b
    return c / determinant, -b / determinant, a / determinant


def _applied(matrix: Matrix, v: list[Ball]) -> list[Ball]:
    a, b, c = matrix
    return [a * v[0] + b * v[1], b * v[0] + c * v[1]]


def _form(matrix: Matrix, v: list[Ball]) -> Ball:
    applied = _applied(matrix, v)
    return v[0] * applied[0] + v[1] * applied[1]


def _inner(x: Vector, v: list[Ball]) -> Ball:
    return ball(x[0]) * v[0] + ball(x[1]) * v[1]


def _boundary(answers: Answers, middle: Vector, level: Fraction, W: Fraction, rng: np.random.Generator) -> list[Vector]:
    """Points as far out as the set and the ball certainly reach, in random directions from the middle."""
    found = []
    for direction in rng.normal(size=(12, 2)):
        low, high = 0.0, 2 * float(W)
        for _ in range(12):
            reach = (low + high) / 2
            point = _along(middle, direction, reach)
            inside = dot(point, point) <= W * W and answers.log_likelihood(point) >= ball(level)
            low, high = (reach, high) if inside else (low, reach)
        point = _along(middle, direction, low)
        if dot(point, point) <= W * W and answers.log_likelihood(point) >= ball(level):
            found.append(point)
    return found


def _along(middle: Vector, direction: np.ndarray, reach: float) -> Vector:
    unit = direction / np.linalg.norm(direction)
    return rational(np.array([float(entry) for entry in middle]) + reach * unit, 2**16)
