"""What a question is worth, and regret with the likelihood set: identities, and runs on the same logs as R4."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

import bridge_theory as theory
from proofs_checks.answers.checks.dual import certified_in_floats
from proofs_checks.answers.checks.logistic import FloatArray, evidence, fit
from proofs_checks.context import Context
from proofs_checks.coverage import Coverage
from proofs_checks.outcome import Outcome, together
from proofs_checks.smt import prove, reals

_DELTA = Fraction(1, 10)


def gain(*, sign: int = 1) -> Outcome:
    """v'A^-1 v - v'(A + s xx')^-1 v = s (x'A^-1 v)^2 / (1 + s x'A^-1 x): what a question with s = p(1-p) takes away."""
    import sympy

    from proofs_checks.symbolic import identity

    a, b, c, s, x1, x2, v1, v2 = sympy.symbols("a b c s x1 x2 v1 v2", positive=True)
    A, x, v = sympy.Matrix([[a, b], [b, c]]), sympy.Matrix([x1, x2]), sympy.Matrix([v1, v2])
    before, after = (v.T * A.inv() * v)[0], (v.T * (A + s * x * x.T).inv() * v)[0]
    rule = s * (x.T * A.inv() * v)[0] ** 2 / (1 + sign * s * (x.T * A.inv() * x)[0])
    return identity("two dimensions", sympy.together(before - after - rule), sympy.Integer(0))


def played_width(*, factor: int = 1) -> Outcome:
    """A round's regret is at most the widest pair's max - min over the set, half of it for each policy played.

    ``hi_i``, ``lo_i`` are the largest and smallest advantage of the best policy over the i-th one played over the set;
    membership of the played policies says lo_i <= 0; the pair played is the widest.
    """
    a1, a2, hi1, hi2, lo1, lo2, width = reals("a1 a2 hi1 hi2 lo1 lo2 width")
    return prove(
        "one round",
        [a1 <= hi1, a2 <= hi2, lo1 <= 0, lo2 <= 0, hi1 - lo1 <= width, hi2 - lo2 <= width, a1 >= 0, a2 >= 0],
        factor * (a1 + a2) / 2 <= width,
    )


def containment(*, sign: int = 1) -> Outcome:
    """The best policy is never eliminated: its true advantage is at least 0, hence so is the largest over the set."""
    truth, largest = reals("truth largest")
    return prove("containment", [truth >= 0, truth <= largest], sign * largest >= 0)


def regret(context: Context, *, share: float = 1.0) -> Outcome:
    """Realised regret against the likelihood set's bound on the same logs as R4's bound in hindsight, delta = 1/10."""
    runs, smaller = context.pick(quick=40, full=150), 0
    failures = 0
    for rng in context.rng().spawn(runs):
        realised, certified, ellipsoid = _run(rng)
        failures += realised > share * certified
        smaller += certified < ellipsoid
    outcome = Coverage(_DELTA, runs, failures).outcome(
        f"regret below its bound; the bound is below R4's in {smaller} of {runs} runs"
    )
    return together(outcome, Outcome(1, () if smaller > runs // 2 else ("R4's bound is smaller in most runs",)))


def _run(rng: np.random.Generator, rounds: int = 60, lam: float = 0.5) -> tuple[float, float, float]:
    """Regret of one run in two dimensions, its bound with the likelihood set, and R4's bound in hindsight."""
    B, W = 1.0, 2.5
    policies = rng.normal(size=(6, 2))
    policies = policies / np.maximum(1.0, np.linalg.norm(policies, axis=1, keepdims=True))
    w = rng.normal(size=2)
    w *= 2.0 / np.linalg.norm(w)
    x, played = np.zeros((0, 2)), np.zeros(2)
    for _ in range(rounds):
        i, j = rng.choice(6, 2, replace=False) if rng.random() < 0.3 else _likeliest(policies, fit(x, lam))
        difference = policies[i] - policies[j]
        answer = 1.0 if rng.random() < 1 / (1 + np.exp(-difference @ w)) else -1.0
        x = np.concatenate([x, answer * difference[None]])
        played += (policies[i] + policies[j]) / 2
    sums = rounds * policies - played
    m = fit(x, lam)
    level = float(evidence(x, m, lam)) + np.log(float(_DELTA))
    certified = max(certified_in_floats(x, v, level, W) for v in sums)
    return float((sums @ w).max()), certified, max(_ellipsoid(x, v, B, W, lam) for v in sums)


def _likeliest(policies: FloatArray, m: FloatArray) -> tuple[int, int]:
    order = np.argsort(policies @ m)
    return int(order[-1]), int(order[-2])


def _ellipsoid(x: FloatArray, v: FloatArray, B: float, W: float, lam: float) -> float:
    """R4's bound of one direction: <v, w> + rho |v| in the inverse data matrix, and never more than W |v|."""
    kappa = float(theory.kappa_differences.estimate(B=B, W=W))
    matrix = kappa * lam * np.eye(2) + x.T @ x
    w = fit(x, lam)
    w = w * min(1.0, W / max(float(np.linalg.norm(w)), 1e-12))
    residual = (1 / (1 + np.exp(x @ w))) @ x - lam * w
    radius = theory.confidence_radius_repaired.estimate(
        B=B, W=W, lam=lam, delta_w=float(_DELTA), residual=float(np.sqrt(residual @ np.linalg.solve(matrix, residual))),
        log_det_ratio=max(0.0, float(np.linalg.slogdet(matrix)[1] - 2 * np.log(kappa * lam))),
    )  # fmt: skip
    spread = float(np.sqrt(v @ np.linalg.solve(matrix, v)))
    return min(float(v @ w) + float(radius) * spread, W * float(np.linalg.norm(v)))
