"""Lower bounds of the evidence against the evidence itself: integrals in balls, determinants in rationals."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from math import prod
from typing import Any

import numpy as np
from flint import acb, arb

import bridge_theory as theory
from bridge_theory.arithmetic.flint_balls import Ball, ball, working_precision
from proofs_checks.answers.checks.logistic import dot, fit, rational
from proofs_checks.context import Context
from proofs_checks.exact.certify import at_most, value_of
from proofs_checks.exact.every import QUICK
from proofs_checks.outcome import Outcome, Tally

_FAR = 12  # standard deviations: what lies beyond is dropped on the safe side
_BITS = 80


def below_the_evidence(*, price: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """In one dimension: determinant bound <= Jaakkola-Jordan or E_q l - KL <= log evidence, each enclosed.

    The evidence is integrated over a bounded interval, which makes it smaller; E_q l likewise, which makes it larger.
    ``price`` multiplies the divergence.
    """
    rng, tally, gaps = context.rng(), Tally(), []
    for _ in range(context.pick(quick=4, full=16)):
        xs = [Fraction(int(rng.integers(-12, 13)), 4) for _ in range(int(rng.integers(3, 20)))]
        lam = Fraction(int(rng.integers(1, 16)), 4)
        m = rational(fit(np.array([[float(x)] for x in xs]), float(lam)))[0]  # near the best; any m is valid
        s = Fraction(int(rng.integers(2, 9)), 6) / (lam + dot(xs, xs) / 5)
        with working_precision(_BITS):
            whole = _log_evidence(xs, lam)
            divergence = ball(price) * _divergence(m, s, lam)
            exact = _expected(xs, m, s) - divergence
            quadratic = _jaakkola(xs, m, s) - divergence
            at_best = _determinant(xs, m, lam)
            best_s = 1 / (lam + dot(xs, xs) / 4)
            own = _expected(xs, m, best_s) - _divergence(m, best_s, lam)
        tally.expect(bool(exact <= whole), f"Q = {exact} exceeds the evidence {whole} for x = {xs}")
        tally.expect(bool(quadratic <= exact), f"Jaakkola-Jordan {quadratic} exceeds {exact}")
        tally.expect(bool(at_best <= own), f"the determinant bound {at_best} exceeds Q = {own}")
        gaps.append(float((whole - own).mid()))
    return tally.outcome(f"the Gaussian of the determinant bound loses {np.median(gaps):.2f} nats in the median")


def _integral(f: Callable[[acb, bool], acb], centre: Fraction, deviation: Ball) -> Ball:
    low, high = (acb(ball(centre) + sign * _FAR * deviation) for sign in (-1, 1))
    return acb.integral(lambda w, analytic: f(w, analytic), low, high).real


def _log_evidence(xs: list[Fraction], lam: Fraction) -> Ball:
    scale = (ball(lam) / (2 * arb.pi())).sqrt()

    def density(w: acb, _: bool) -> acb:
        answers = prod((1 + (-w * acb(ball(x))).exp() for x in xs), start=acb(1))
        return acb(scale) * (-w * w * acb(ball(lam)) / 2).exp() / answers

    return _integral(density, Fraction(0), 1 / ball(lam).sqrt()).log()


def _expected(xs: list[Fraction], m: Fraction, s: Fraction) -> Ball:
    """E_q l for q = N(m, s), from above: the tails are left out and every term is negative."""
    scale = 1 / (2 * arb.pi() * ball(s)).sqrt()

    def integrand(w: acb, analytic: bool) -> acb:
        losses = sum((1 + (-w * acb(ball(x))).exp()).log(analytic=analytic) for x in xs)
        return -losses * acb(scale) * (-((w - acb(ball(m))) ** 2) / (2 * acb(ball(s)))).exp()

    return _integral(integrand, m, ball(s).sqrt())


def _divergence(m: Fraction, s: Fraction, lam: Fraction) -> Ball:
    return (ball(lam * (s + m * m)) - 1 - ball(lam * s).log()) / 2


def _jaakkola(xs: list[Fraction], m: Fraction, s: Fraction) -> Ball:
    """E_q of the quadratic at the tangent xi^2 = E z^2, where its square term vanishes; xi is rounded."""
    total = ball(0)
    for x in xs:
        second = x * x * (m * m + s)
        xi = Fraction(float(second) ** 0.5)
        at_middle = value_of(theory.log_sigmoid_lower, margin=x * m, tangent=xi)
        factor = ball(Fraction(1, 8)) if xi == 0 else (ball(xi) / 2).tanh() / (4 * ball(xi))
        total += at_middle - factor * ball(x * x * s)
    return total


def _determinant(xs: list[Fraction], m: Fraction, lam: Fraction) -> Ball:
    loss = sum((((-ball(x * m)).exp() + 1).log() for x in xs), start=ball(0))
    growth = ball(1 + dot(xs, xs) / (4 * lam)).log()
    return -value_of(
        theory.evidence_loss_logdet, loss=lambda: loss, lam=lam, weight_norm=abs(m), log_det_growth=lambda: growth
    )


def determinants(*, dimension: int = 0, context: Context = QUICK) -> Outcome:
    """The closed-form width is at least the one of the observed determinant, exactly on generated questions.

    ``dimension`` overrides the dimension of the formula.
    """
    rng, tally = context.rng(), Tally()
    for _ in range(context.pick(quick=40, full=200)):
        d, t = int(rng.integers(1, 4)), int(rng.integers(1, 12))
        rows = rng.integers(-4, 5, (t, d))
        lam = Fraction(int(rng.integers(1, 9)), 4)
        gram = [
            [Fraction(int(i == j)) + Fraction(int(rows[:, i] @ rows[:, j])) / (4 * lam) for j in range(d)]
            for i in range(d)
        ]
        longest = max(1, *(int(row @ row) for row in rows))
        given: dict[str, Any] = {"W": Fraction(3), "lam": lam, "scales": 2, "delta": Fraction(1, 20)}
        size: dict[str, Any] = {"d": dimension or d, "t": t, "B": partial(_half_root, longest)}
        observed = {"log_det_growth": partial(_log_determinant, gram)}
        holds = at_most(
            partial(value_of, theory.likelihood_width_logdet, **observed, **given),
            partial(value_of, theory.likelihood_width, **size, **given),
        )
        tally.expect(holds, f"the determinant of {rows.tolist()} at lambda = {lam} exceeds its trace bound")
    return tally.outcome("log det against its trace bound, in balls on rational determinants")


def _half_root(square: int) -> Ball:
    return ball(square).sqrt() / 2


def _log_determinant(matrix: list[list[Fraction]]) -> Ball:
    return ball(_determinant_of(matrix)).log()


def _determinant_of(matrix: list[list[Fraction]]) -> Fraction:
    """By expansion along the first row."""
    if len(matrix) == 1:
        return matrix[0][0]
    minors = [[row[:j] + row[j + 1 :] for row in matrix[1:]] for j in range(len(matrix))]
    return sum(
        (
            (-1) ** j * entry * _determinant_of(minor)
            for j, (entry, minor) in enumerate(zip(matrix[0], minors, strict=True))
        ),
        Fraction(0),
    )
