"""Observed and expected data matrices: the supermartingale of R5, the constants of R9, the budget of C.6."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

import bridge_theory as theory
from proofs_checks.context import Context
from proofs_checks.coverage import Coverage
from proofs_checks.outcome import Outcome, Tally, together

_DELTA = Fraction(1, 10)


def exponential_moment(*, slope: int = 1) -> Outcome:
    """e^-z <= 1 - (1 - 1/e) z on [0, 1] by concavity of the difference, and 1 - y <= e^-y by its convexity."""
    import sympy

    from proofs_checks.balls import prove_positive
    from proofs_checks.symbolic import identity

    z = sympy.Symbol("z", real=True)
    chord = 1 - slope * (1 - sympy.exp(-1)) * z - sympy.exp(-z)
    tangent = sympy.exp(-z) - 1 + z
    return together(
        identity("zero at 0", chord.subs(z, 0), sympy.S.Zero),
        identity("zero at 1", chord.subs(z, 1), sympy.S.Zero),
        identity("second derivative of the chord's gap", sympy.diff(chord, z, 2), -sympy.exp(-z)),
        identity("zero at 0, with slope 0", tangent.subs(z, 0) + sympy.diff(tangent, z).subs(z, 0), sympy.S.Zero),
        identity("second derivative of the tangent's gap", sympy.diff(tangent, z, 2), sympy.exp(-z)),
        prove_positive("e^-z", lambda z: (-z).exp(), {"z": (0, 1)}),
    )


def means_are_dominated(context: Context, *, factor: float = 1.0, log_factor: float = 1.0) -> Outcome:
    """sum of E_{t-1} Z_t <= e/(e-1) (sum of Z_t + log(1/delta)) for all T, for Z with adaptively chosen means."""
    runs, rounds = context.pick(quick=400, full=3000), 400
    rng, c = context.rng(), factor * math.e / (math.e - 1)
    means, seen = np.zeros(runs), np.zeros(runs)
    failed = np.zeros(runs, dtype=bool)
    base = 10.0 ** rng.uniform(-2, 0, runs)
    for _ in range(rounds):
        # half of the runs raise the stakes when they are behind
        chance = np.where(np.arange(runs) % 2, base, np.where(means > seen, 0.5, 0.02))
        means += chance
        seen += rng.random(runs) < chance
        failed |= means > c * (seen + log_factor * np.log(1 / float(_DELTA)))
    return Coverage(_DELTA, runs, int(failed.sum())).outcome("conditional means below e/(e-1) (sum + log 1/delta)")


def expected_matrix_is_covered(context: Context, *, scale: float = 1.0) -> Outcome:
    """In one dimension: the expected data matrix is at most 2 V_t + 27 B^2 d log((1+2T)/delta) for all t <= T."""
    runs, rounds, B = context.pick(quick=400, full=2000), 300, 0.5
    rng = context.rng()
    expected, observed = np.zeros(runs), np.zeros(runs)
    failed = np.zeros(runs, dtype=bool)
    chance = rng.choice([0.02, 0.1, 0.5], size=runs)
    at_one = {"lam": 1, "d": 1, "t": 1, "T": rounds, "delta_w": 0.5, "delta_V": float(_DELTA)}
    width = float(theory.norm_relation.estimate(B=B, W=1, **at_one))
    confidence = float(np.sqrt(8) * theory.kappa_differences.estimate(B=B, W=1))
    confidence *= float(theory.beta_repaired.estimate(B=B, W=1, lam=1, d=1, t=1, K=1, delta_w=0.5))
    shift = scale * ((width - confidence) / 2) ** 2
    for _ in range(rounds):
        expected += (2 * B * chance) ** 2
        observed += (2 * B) ** 2 * (rng.random(runs) < chance)
        failed |= expected > 2 * scale * observed + shift
    return Coverage(_DELTA, runs, int(failed.sum())).outcome(
        "expected matrix below twice the observed one plus a shift"
    )


def rounded_constants(*, constant: int = 27) -> Outcome:
    """e/(e-1) <= 2, and 4c (d log(1+2T) + log 1/delta) + 8 (1+c) <= 27 d log((1+2T)/delta)."""
    from bridge_theory.arithmetic.flint_balls import ball
    from proofs_checks.balls import Box, prove_positive
    from proofs_checks.smt import prove, reals

    c = 1 / (1 - ball(-1).exp())
    tally = Tally()
    tally.expect(bool(c <= 2), "e/(e-1) exceeds 2")
    tally.expect(bool((constant - 4 * c) * ball(3).log() >= 8 * (1 + c)), f"{constant} is too small at T = d = 1")
    d, growth, chance, share, least = reals("d growth chance c log3")
    split = prove(
        "sharp below rounded for all d, T, delta",
        [
            d >= 1, chance >= 0, growth >= least, least > 0, share > 0,  # growth = log(1+2T), chance = log(1/delta)
            (constant - 4 * share) * least >= 8 * (1 + share), constant - 4 * share >= 0,
        ],
        4 * share * (d * growth + chance) + 8 * (1 + share) <= constant * d * (growth + chance),
    )  # fmt: skip
    box: Box = {"d": (1, 20), "T": (1, 10**6), "delta_V": ("1/1000", "1/2")}
    return together(
        tally.outcome("constants"), split, prove_positive("rounded - sharp", _gap, box, geometric=("d", "T"))
    )


def _gap(d, T, delta_V):  # type: ignore[no-untyped-def]
    from bridge_theory.arithmetic.balls import BALLS

    one, half = BALLS.number(1), BALLS.number(Fraction(1, 2))
    rest = {"B": one, "W": one, "lam": one, "d": d, "t": one, "T": T, "delta_w": half, "delta_V": delta_V}
    return theory.norm_relation(BALLS, **rest) - theory.norm_relation_sharp(BALLS, **rest)


def net_budget(*, by_round: bool = False) -> Outcome:
    """With delta / (8 l^3) for the bonuses of round l, anew for every t, more than delta is spent."""
    spent, rounds = Fraction(0), 6
    for t in range(2, rounds + 1):
        spent += sum((Fraction(2, 8 * (t if by_round else step) ** 3) for step in range(1, t)), Fraction(0))
    tally = Tally()
    tally.expect(spent > 1, f"only {float(spent):.3f} delta is spent on rounds up to {rounds}")
    return tally.outcome(f"{float(spent):.3f} delta is spent on the rounds up to {rounds}")


def doubling(*, factor: int = 2) -> Outcome:
    """(a + b)^2 <= 2 a^2 + 2 b^2, twice: the estimated matrix is at most twice the true one plus the squared errors."""
    from proofs_checks.smt import prove, reals

    a, b, e_1, e_2 = reals("a b e_1 e_2")
    return together(
        prove("two terms", [], (a + b) * (a + b) <= factor * (a * a + b * b)),
        prove(
            "both policies",
            [e_1 >= 0, e_2 >= 0, b <= e_1 + e_2, b >= -(e_1 + e_2)],
            (a + b) * (a + b) <= factor * a * a + 2 * factor * (e_1 * e_1 + e_2 * e_2),
        ),
    )
