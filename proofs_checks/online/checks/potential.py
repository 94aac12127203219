"""The elliptical potential (R3), the expected potential (R5) and what offline data can gain in it (R11)."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

import bridge_theory as theory
from proofs_checks.context import Context
from proofs_checks.coverage import Coverage
from proofs_checks.outcome import Outcome, Tally, together


def price_of_a_step(*, power: int = 2) -> Outcome:
    """u/log(1+u) rises: its derivative has the sign of log(1+u) - u/(1+u), which starts at 0 and rises."""
    import sympy

    from proofs_checks.smt import prove, reals
    from proofs_checks.symbolic import identity

    u = sympy.Symbol("u", positive=True)
    numerator = sympy.log(1 + u) - u / (1 + u)
    (x,) = reals("x")
    return together(
        identity("derivative", sympy.diff(u / sympy.log(1 + u), u), numerator / sympy.log(1 + u) ** 2),
        identity("numerator's derivative", sympy.diff(numerator, u), u / (1 + u) ** power),
        prove("it is positive", [x > 0], x / ((1 + x) * (1 + x)) > 0),
    )


def factor_two_range(*, edge: str = "2.512862417") -> Outcome:
    """c(a) <= 2 exactly for a <= 2.51286241...: certified on both sides, and c rises."""
    low = theory.potential_factor.enclosure(L=1, v=1 / (Fraction(edge)))
    high = theory.potential_factor.enclosure(L=1, v=1 / (Fraction(edge) + Fraction(1, 10**9)))
    tally = Tally()
    tally.expect(Fraction(low.upper) <= 2, f"c({edge}) = {low} exceeds 2")
    tally.expect(Fraction(high.lower) > 2, f"c just above {edge} is {high}")
    return tally.outcome(f"c(a) = 2 at a in [{edge}, {edge} + 1e-9]")


def determinant_recursion(context: Context, *, length: str = "1", slack: int = 1) -> Outcome:
    """On rational vectors: the product of 1 + |x_t|^2 is the ratio of determinants, and the sums obey their bounds."""
    from hypothesis import strategies as st

    from proofs_checks.exact.certify import within
    from proofs_checks.exact.every import on_every

    entry = st.fractions(-1, 1, max_denominator=4)
    instances = st.tuples(st.lists(st.tuples(entry, entry), min_size=1, max_size=6), st.sampled_from(["1/8", "1", "5"]))

    def holds(instance: tuple[list[tuple[Fraction, Fraction]], str]) -> bool:
        vectors, start = instance[0], Fraction(instance[1])
        squares, last = _squared_norms(vectors, start)
        product = Fraction(1)
        for square in squares:
            product *= 1 + square
        size = sum((x * x + y * y for x, y in vectors), Fraction(0))
        largest = Fraction(length) * Fraction(3, 2)  # at least the norm of every drawn vector when length is 1
        given: dict[str, Any] = {"v": start, "d": 2, "square_sum": size}
        return (
            slack * product == _determinant(last) / start**2
            and within(sum(squares, Fraction(0)), theory.elliptical_potential, L=largest, **given)
            and within(
                sum((min(s, Fraction(1)) for s in squares), Fraction(0)), theory.elliptical_potential_capped, **given
            )
        )

    return on_every("potential", instances, holds, context.pick(quick=60, full=300))


def one_step_equality(*, factor: str = "1") -> Outcome:
    """In one dimension and for one vector of norm L the potential is attained: no smaller bound is possible."""
    from proofs_checks.exact.certify import attained

    tally = Tally()
    for square in (Fraction(1, 2), Fraction(1), Fraction(40)):
        wanted = square / Fraction(factor)
        same = attained(wanted, theory.elliptical_potential, L=2, v=4 / square, d=1, square_sum=4)
        tally.expect(same, f"the bound is not {wanted}")
    return tally.outcome("T = d = 1")


def expected_potential(context: Context, *, scale: float = 1.0) -> Outcome:
    """sum |D_t|^2 in the inverse observed matrix is at most Psi_T for all T <= 60, with adaptively chosen means."""
    runs, rounds, B, W, lam, delta = context.pick(quick=300, full=2000), 60, 1.0, 1.0, 0.05, Fraction(1, 10)
    rng = context.rng()
    start = float(theory.kappa_differences.estimate(B=B, W=W)) * lam
    observed, total = np.full(runs, start), np.zeros(runs)
    failed = np.zeros(runs, dtype=bool)
    base = rng.choice([0.05, 0.3, 1.0], size=runs)
    for t in range(1, rounds + 1):
        chance = np.where(observed > start, base, np.maximum(base, 0.3))
        total += (2 * B * chance) ** 2 / observed
        observed += (2 * B) ** 2 * (rng.random(runs) < chance)
        bound = theory.expected_potential.estimate(B=B, W=W, lam=lam, d=1, T=t, delta_F=float(delta))
        failed |= total > scale * bound
    return Coverage(delta, runs, int(failed.sum())).outcome("expected potential below Psi_T in all rounds")


def logarithm_above_chord(*, factor: str = "1") -> Outcome:
    """log(1+x) >= x log 2 on [0, 1]: concave and equal at both ends, the step of R11."""
    import sympy

    from proofs_checks.symbolic import identity

    x, share = sympy.Symbol("x", nonnegative=True), Fraction(factor)
    gap = sympy.log(1 + x) - sympy.Rational(share) * x * sympy.log(2)
    return together(
        identity("equal at 0", gap.subs(x, 0), sympy.S.Zero),
        identity("equal at 1", gap.subs(x, 1), sympy.S.Zero),
        identity("concave", sympy.diff(gap, x, 2), -1 / (1 + x) ** 2),
    )


def floor_in_both_cases(*, share: str = "33/10") -> Outcome:
    """The floor of R11 in squares, for all settings: X = T D^2 >= 0, v = kappa lambda > 0, c >= 1, gamma^2 >= 4 W^2 v.

    The squared bound is 4 gamma^2 T c d L with L = log(1 + X/(d v)). For X <= d v, L d v >= X log 2, and for X >= d v,
    L >= log 2; the squared floors are (share)^2 T^2 W^2 D^2 = share^2 T W^2 X, and 4 gamma^2 d T log 2.
    """
    from bridge_theory.arithmetic.flint_balls import ball
    from proofs_checks.smt import prove, reals

    tally = Tally()
    tally.expect(bool(ball(2).log() >= ball(Fraction(69, 100))), "log 2 is below 69/100")
    chord, c, square, w2, v, log2, d, level = reals("chord c gamma2 W2 v log2 d L")
    factor = Fraction(share) ** 2
    common = [c >= 1, square >= 4 * w2 * v, w2 >= 0, v > 0, log2 >= Fraction(69, 100)]
    return together(
        tally.outcome("log 2"),
        # after division by T X: 4 gamma^2 c log2/v >= share^2 W^2, where c log2/v is chord
        prove("X <= d v", [*common, chord * v == c * log2], 4 * square * chord >= factor * w2),
        prove("X >= d v", [*common, d >= 1, level >= log2], 4 * square * c * d * level >= 4 * square * d * log2),
    )


def floor_of_the_log_bound(*, scale: int = 1) -> Outcome:
    """2 gamma sqrt(T c d log(1 + T D^2/(d v))) is at least the floor, on a box with d = v = 1 and gamma = 2W = 2.

    Both sides depend on d, v, gamma and W only through the scales that are fixed here and through c >= 1.
    """
    from bridge_theory.arithmetic.balls import BALLS
    from proofs_checks.balls import prove_positive

    one, two = BALLS.number(1), BALLS.number(2)

    def gap(T: Any, diameter: Any) -> Any:
        total = theory.elliptical_norm_sum(BALLS, L=diameter, v=one, d=one, T=T, square_sum=T * diameter**2)
        return 2 * two * total - scale * theory.elliptical_floor(BALLS, W=one, d=one, T=T, gamma=two, diameter=diameter)

    return prove_positive("bound - floor", gap, {"T": (1, 8), "diameter": ("1/2", 2)}, geometric=("T",), most=40_000)


def dimension_helps_not(*, sign: int = 1) -> Outcome:
    """d log(1 + x/d) rises with d: with y = x/d its derivative is log(1+y) - y/(1+y) > 0 (see ``price_of_a_step``)."""
    import sympy

    from proofs_checks.symbolic import identity

    d, x, y = sympy.symbols("d x y", positive=True)
    slope = sympy.diff(d * sympy.log(1 + x / d), d).subs(x, y * d)
    return identity("derivative in d", slope, sympy.log(1 + y) - sign * y / (1 + y))


Vector = tuple[Fraction, Fraction]
Matrix = tuple[Fraction, Fraction, Fraction]
"""A symmetric matrix by its entries 11, 12, 22."""


def _squared_norms(vectors: list[Vector], start: Fraction) -> tuple[list[Fraction], Matrix]:
    a, b, c = start, Fraction(0), start
    squares = []
    for x, y in vectors:
        squares.append((c * x * x - 2 * b * x * y + a * y * y) / (a * c - b * b))
        a, b, c = a + x * x, b + x * y, c + y * y
    return squares, (a, b, c)


def _determinant(matrix: Matrix) -> Fraction:
    return matrix[0] * matrix[2] - matrix[1] ** 2
