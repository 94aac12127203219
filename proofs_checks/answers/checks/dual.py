"""The dual certificate: weak duality by machine, balls on instances, and an independent convex solver."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

import bridge_theory as theory
from bridge_theory.arithmetic.flint_balls import Ball, ball, working_precision
from proofs_checks.answers.checks.logistic import (
    Answers,
    FloatArray,
    Vector,
    dot,
    evidence,
    fit,
    random_answers,
    rational,
)
from proofs_checks.context import Context
from proofs_checks.exact.certify import at_most, value_of
from proofs_checks.exact.every import QUICK
from proofs_checks.outcome import Outcome, Tally
from proofs_checks.smt import prove, reals

DELTA = Fraction(1, 20)


def weak_duality(*, sign: int = 1, cones: bool = True) -> Outcome:
    """From concavity, the threshold, the ball and the cones: <v, w> <= c (l0 - g w0 - Q + log 1/delta) + W |v + c g|.

    ``vw`` stands for <v, w>, ``kw`` for the cone's <k, w> >= 0 with multiplier ``mu``, ``gw`` for <grad, w>.
    """
    vw, kw, gw, gw0, lw, l0, level, c, mu, cap = reals("vw kw gw gw0 lw l0 level c mu cap")
    return prove(
        "weak duality",
        [
            sign * c >= 0, mu >= 0, kw >= 0 if cones else kw <= 0,
            lw >= level,  # w lies in the likelihood set
            lw <= l0 + gw - gw0,  # concavity of the log-likelihood
            vw + mu * kw + c * gw <= cap,  # Cauchy and Schwarz within the ball
        ],
        vw <= c * (l0 - gw0 - level) + cap,
    )  # fmt: skip


def cauchy_schwarz(*, factor: int = 1) -> Outcome:
    """<u, w> <= W |u| for |w| <= W, in two dimensions, to which any pair of vectors belongs."""
    a, b, x, y, W, n = reals("a b x y W n")
    return prove(
        "the ball",
        [W > 0, n >= 0, n * n == a * a + b * b, x * x + y * y <= factor * W * W],
        (a * x + b * y) * (a * x + b * y) <= W * W * n * n,
    )


@dataclass(frozen=True)
class Instance:
    """Rational answers, a direction, cones, a ball and a threshold, with a float copy."""

    answers: Answers
    v: Vector
    cones: tuple[Vector, ...]
    W: Fraction
    evidence_loss: Fraction


def instances(rng: np.random.Generator, count: int) -> Iterator[Instance]:
    """Random problems in three dimensions; the evidence is that of the determinant bound, rounded down."""
    for _ in range(count):
        answers, w = random_answers(rng, int(rng.integers(6, 25)), 3)
        x = answers.floats()
        lam, W = 0.5, Fraction(3)
        q = evidence(x, fit(x, lam), lam)
        v = rational(rng.normal(size=3))
        cones = [k if dot(k, w) >= 0 else tuple(-e for e in k) for k in (rational(rng.normal(size=3)) for _ in "ab")]
        yield Instance(answers, v, tuple(cones), W, Fraction(int(np.ceil(-float(q) * 64)), 64))


def certificate(problem: Instance, w0: Vector, c: Fraction, mu: Vector, share: Fraction = Fraction(1)) -> Ball:
    """The bound of bridge_theory at the point w0, in balls."""
    gradient = problem.answers.gradient(w0)
    direction = [
        ball(problem.v[j] + sum((m * k[j] for m, k in zip(mu, problem.cones, strict=True)), Fraction(0)))
        + ball(c) * gradient[j]
        for j in range(3)
    ]
    norm = sum((u * u for u in direction), start=ball(0)).sqrt()
    slope = sum((g * ball(e) for g, e in zip(gradient, w0, strict=True)), start=ball(0))
    return value_of(
        theory.dual_certificate, multiplier=c, loss=lambda: -problem.answers.log_likelihood(w0), slope=lambda: slope,
        evidence_loss=problem.evidence_loss, scales=1, W=share * problem.W, dual_norm=lambda: norm, delta=DELTA,
    )  # fmt: skip


def points_are_below(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """Random points certainly inside set, ball and cones stay below random certificates, good and bad, in balls."""
    rng, tally = context.rng(), Tally()
    for problem in instances(rng, context.pick(quick=6, full=25)):
        inside = [w for w in _candidates(problem, rng) if _certainly_inside(problem, w)]
        top = max(inside, key=lambda w: dot(problem.v, w), default=None)
        if top is None:
            continue
        for _ in range(6):
            w0 = rational(rng.normal(size=3) * rng.choice((0.5, 2.0, 6.0)))
            c = Fraction(int(rng.integers(0, 40)), 16)
            mu = tuple(Fraction(int(rng.integers(0, 3)), 8) for _ in problem.cones)
            holds = at_most(dot(problem.v, top), partial(certificate, problem, w0, c, mu, share))
            tally.expect(holds, f"{float(dot(problem.v, top)):.4f} exceeds the certificate at w0 = {w0}, c = {c}")
    return tally.outcome("points of the set against certificates at arbitrary w0, c and mu")


def _candidates(problem: Instance, rng: np.random.Generator) -> Iterator[Vector]:
    middle = fit(problem.answers.floats(), 0.5)
    for _ in range(60):
        yield rational(middle + rng.normal(size=3) * rng.choice((0.3, 1.0, 2.0)))


def _certainly_inside(problem: Instance, w: Vector) -> bool:
    if dot(w, w) > problem.W**2 or any(dot(k, w) < 0 for k in problem.cones):
        return False
    with working_precision(96):
        return bool(problem.answers.log_likelihood(w) >= ball(-problem.evidence_loss) + ball(DELTA).log())


def against_solver(*, sign: int = 1, context: Context = QUICK) -> Outcome:
    """An independent convex solver's maximum is not above the certificate, which is tight at its optimum.

    Its dual variables give c and mu, its primal point is w0.
    """
    rng, tally, excess = context.rng(), Tally(), []
    for problem in instances(rng, context.pick(quick=4, full=20)):
        solved = _solved(problem)
        if solved is None:
            continue
        value, w0, c, mu = solved
        bound = float(certificate(problem, rational(w0, 2**40), *_multipliers(sign * c, mu)).mid())
        excess.append(bound - value)
        tally.expect(bound >= value - 1e-6, f"the certificate {bound} is below the solver's maximum {value}")
        tally.expect(bound <= value + 1e-3 * (1 + abs(value)), f"the certificate {bound} is far above {value}")
    return tally.outcome(f"median excess over the solver {np.median(excess):.1e}" if excess else "nothing solved")


def _multipliers(c: float, mu: FloatArray) -> tuple[Fraction, Vector]:
    return Fraction(c), tuple(Fraction(max(float(m), 0.0)) for m in mu)


def _solved(problem: Instance) -> tuple[float, FloatArray, float, FloatArray] | None:
    import cvxpy as cp

    x, v = problem.answers.floats(), np.array([float(e) for e in problem.v])
    w = cp.Variable(3)
    level = -float(problem.evidence_loss) + float(np.log(float(DELTA)))
    inside: list[Any] = [-cp.sum(cp.logistic(-x @ w)) >= level, cp.norm(w) <= float(problem.W)]
    inside += [np.array([float(e) for e in k]) @ w >= 0 for k in problem.cones]
    task = cp.Problem(cp.Maximize(v @ w), inside)
    task.solve(solver=cp.CLARABEL)
    if task.status != cp.OPTIMAL:
        return None
    duals = [float(np.ravel(constraint.dual_value)[0]) for constraint in inside]
    return float(task.value), np.asarray(w.value), abs(duals[0]), np.abs(duals[2:])


def share_gained(*, factor: int = 1) -> Outcome:
    """a <= rho g and a + g > 0 give g >= (a + g)/(1 + rho): a is what is missing, g what is gained."""
    a, g, rho = reals("a g rho")
    return prove("share gained", [rho > 0, a >= 0, a + g > 0, a <= rho * g], (1 + rho) * g >= factor * (a + g))


def confinement(*, inside: bool = True) -> Outcome:
    """Along a ray from a point of the set, a concave function below 0 at distance r stays below 0 beyond.

    ``f0`` at the middle, ``fr`` at distance r, ``fs`` at distance s > r: concavity puts fr above the chord.
    """
    f0, fr, fs, r, s = reals("f0 fr fs r s")
    return prove(
        "beyond r",
        [r > 0, s > r, fr < 0, s * fr >= (s - r) * f0 + r * fs, *([f0 >= 0] if inside else [])],
        fs < 0,
    )


def confinement_needs_its_middle(*, answers: int = 100) -> Outcome:
    """For a middle outside the set the text's condition holds with all of the set elsewhere: in one dimension.

    The question x = 1 is answered 1 a hundred times, prior precision 1/4, delta = 1/20, evidence from m = 4. At the
    middle 0 and r = 1/2, b + |grad| r - r^2 lambda_min/2 < 0 although b < 0, and the set begins beyond r.
    """
    r, lam, m, tally = Fraction(1, 2), Fraction(1, 4), 4, Tally()

    def threshold() -> Ball:
        evidence_loss = value_of(
            theory.evidence_loss_logdet, loss=lambda: _lost(answers, m), lam=lam, weight_norm=m,
            log_det_growth=lambda: (ball(1) + ball(answers / (4 * lam))).log(),
        )  # fmt: skip
        return value_of(theory.likelihood_threshold, evidence_loss=lambda: evidence_loss, scales=1, delta=DELTA)

    def margin() -> Ball:
        curvature = answers * value_of(theory.curvature_factor, reach=r) / 4
        return threshold() - _lost(answers, 0) + ball(answers * r / 2) - curvature * ball(r * r / 2)

    tally.expect(at_most(margin, 0), "the condition of the text does not hold here")
    tally.expect(at_most(threshold, lambda: _lost(answers, r)), "the set begins within r of the middle")
    tally.expect(at_most(lambda: _lost(answers, m), threshold), "the set does not hold the weights m")
    return tally.outcome("the condition holds at a middle outside the set, and all of the set is farther than r")


def _lost(answers: int, w: Fraction | int) -> Ball:
    return answers * ((-ball(w)).exp() + 1).log()


def certified_in_floats(x: FloatArray, v: FloatArray, level: float, W: float) -> float:
    """A certificate of one direction: the smallest over a few multipliers, each with its own fit; valid for any fit."""
    c = np.geomspace(1e-3, 30, 24)
    w0 = _fits(x, v, c, W)
    g = (1 / (1 + np.exp(w0 @ x.T))) @ x
    lost = np.logaddexp(0, -(w0 @ x.T)).sum(axis=1)
    values = c * (-lost - (g * w0).sum(axis=1) - level) + W * np.linalg.norm(v + c[:, None] * g, axis=1)
    return min(float(values.min()), W * float(np.linalg.norm(v)))


def _fits(x: FloatArray, v: FloatArray, c: FloatArray, W: float, steps: int = 15) -> FloatArray:
    """Roughly the maximisers of <v, w> + c l(w) in the ball, by Newton steps with a small ridge and projection."""
    w, ridge = np.zeros((len(c), len(v))), 1e-3
    for _ in range(steps):
        p = 1 / (1 + np.exp(w @ x.T))
        gradient = v / c[:, None] + p @ x - ridge * w
        hessian = np.einsum("kt,ti,tj->kij", np.maximum(p * (1 - p), 0.02), x, x) + ridge * np.eye(len(v))
        w = w + np.linalg.solve(hessian, gradient[..., None])[..., 0]
        w = w * np.minimum(1.0, W / np.maximum(np.linalg.norm(w, axis=1, keepdims=True), 1e-12))
    return w
