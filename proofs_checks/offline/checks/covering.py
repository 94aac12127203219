"""T11: covers of the simplex in the one-sided logarithmic sense, and the transition error they give."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from itertools import combinations, product
from math import ceil, comb, log

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from bridge_theory import (
    transition_error_closed_form,
    transition_error_infimum,
    transition_error_repaired,
    transition_error_stated,
    transition_log_covering_closed_form,
    transition_log_covering_repaired,
    transition_log_covering_stated,
    transition_log_covering_two_states,
)
from bridge_theory.arithmetic.flint_balls import Ball, ball
from proofs_checks.balls import prove_positive
from proofs_checks.context import Context
from proofs_checks.exact.certify import at_most, attained, scaled, value_of
from proofs_checks.exact.every import QUICK, on_every
from proofs_checks.exact.strategies import Row, rows
from proofs_checks.outcome import Outcome, Tally, together
from proofs_checks.smt import prove, reals


@st.composite
def _targets(draw: DrawFn) -> tuple[Row, Fraction]:
    size = draw(st.integers(2, 5))
    return draw(rows(size)), Fraction(draw(st.integers(1, 12)), draw(st.integers(1, 12)))


def lattice_element(p: Row, growth: Fraction, extra: int) -> tuple[list[int], int]:
    """Numerators c_i >= ceil(m p_i) with sum M = m + K - 1 + extra, where m = ceil((K - 1)/growth)."""
    size = len(p)
    m = ceil((size - 1) / growth)
    numerators = [ceil(m * x) for x in p]
    numerators[0] += m + size - 1 + extra - sum(numerators)
    return numerators, m


def lattice_covers(*, extra: int = 0, context: Context = QUICK) -> Outcome:
    """Every p has a lattice point q with p <= (1 + growth) q in every coordinate (e^eps = 1 + growth)."""

    def holds(target: tuple[Row, Fraction]) -> bool:
        p, growth = target
        numerators, m = lattice_element(p, growth, extra)
        total = m + len(p) - 1
        exact = sum(numerators) == total and min(numerators) >= 0
        return exact and all(x <= (1 + growth) * Fraction(c, total) for x, c in zip(p, numerators, strict=True))

    return on_every("lattice cover", _targets(), holds, context.pick(quick=100, full=300))


def lattice_count(*, offset: int = 0) -> Outcome:
    """C(m + 2K - 2, K - 1) lattice points, by enumeration and by the formula of bridge_theory."""
    tally = Tally()
    for size, growth in product((2, 3, 4), (Fraction(5, 7), Fraction(7, 4), Fraction(7, 2))):
        m = ceil((size - 1) / growth)
        total = m + size - 1 + offset
        points = sum(sum(c) == total for c in product(range(total + 1), repeat=size))
        count = comb(m + 2 * size - 2, size - 1)
        tally.expect(points == count, f"{points} lattice points for K = {size}, growth {growth}, expected {count}")

        def scale(growth: Fraction = growth) -> Ball:
            return (1 + ball(growth)).log()

        def logarithm(count: int = count) -> Ball:
            return 2 * ball(count).log()

        same = attained(logarithm, transition_log_covering_repaired, S=size, rows=2, epsilon=scale)
        tally.expect(same, f"the formula differs from log {count} at K = {size}")
        below = at_most(
            logarithm, partial(value_of, transition_log_covering_closed_form, S=size, rows=2, epsilon=scale)
        )
        tally.expect(below, f"the closed form is below log {count} at K = {size}, growth {growth}")
    return tally.outcome("lattice counts")


def two_states(*, fewer: int = 0) -> Outcome:
    """K = 2: ceil(1/growth) intervals [1 - (1 + g)(1 - q), (1 + g) q] of length g cover [0, 1], and no fewer can."""
    tally = Tally()
    for growth in (Fraction(2, 7), Fraction(1, 3), Fraction(3, 5), Fraction(1), Fraction(5, 2)):
        number = ceil(1 / growth) - fewer
        ends = [min(Fraction(1), growth * (k + 1)) for k in range(number)]
        covered = Fraction(0)
        for end in ends:
            q = end / (1 + growth)
            tally.expect(1 - (1 + growth) * (1 - q) <= covered, f"a gap below {end} at growth {growth}")
            covered = end
        tally.expect(covered == 1 and (number - 1) * growth < 1, f"{number} intervals at growth {growth}")
        if 1 / growth != ceil(1 / growth):

            def scale(growth: Fraction = growth) -> Ball:
                return (1 + ball(growth)).log()

            def logarithm(number: int = number) -> Ball:
                return ball(number).log()

            same = attained(logarithm, transition_log_covering_two_states, S=2, rows=1, epsilon=scale)
            tally.expect(same, f"the formula differs at growth {growth}")
            stated = at_most(logarithm, partial(value_of, transition_log_covering_stated, S=2, A=1, epsilon=scale))
            tally.expect(stated, f"the paper's lemma fails for two states at growth {growth}")
    return tally.outcome("covers of two states")


def packing_bound(*, stretch: Fraction = Fraction(1)) -> Outcome:
    """Three states: points of denominator k need distinct elements once e^eps - 1 < 1/k, so N >= (k + 1)(k + 2)/2.

    One element covers p and p' only if the sum of max(p_i, p'_i) is at most e^eps; ``stretch`` widens the elements.
    """
    tally = Tally()
    for k in (2, 3, 5):
        growth = Fraction(99, 100 * k)
        corners = [(a, b) for a in range(k + 1) for b in range(k + 1 - a)]
        points = [(Fraction(a, k), Fraction(b, k), Fraction(k - a - b, k)) for a, b in corners]
        apart = all(
            sum(max(a, b) for a, b in zip(p, q, strict=True)) > 1 + stretch * growth for p, q in combinations(points, 2)
        )
        tally.expect(apart, f"two points of denominator {k} share an element")
        tally.expect(
            len(points) <= comb(ceil(2 / growth) + 4, 2), f"the lattice is smaller than the packing at k = {k}"
        )
    return tally.outcome("packings of the triangle")


def stirling_step(*, base: Fraction = Fraction(3)) -> Outcome:
    """(m + 2K - 2)/(K - 1) <= 1/g + 3 where m <= (K - 1)/g + 1: the closed form follows from C(a, b) <= (e a/b)^b."""
    m, k, g = reals("m k g")  # k = K - 1
    hypotheses = [k >= 1, g > 0, m * g <= k + g, m >= 0]
    number = f"{base.numerator}/{base.denominator}"
    import z3

    return prove("1/g + 3", hypotheses, (m + 2 * k) * g <= k * (1 + z3.RealVal(number) * g))


def corollary_tail(*, at: int = 68) -> Outcome:
    """2 log x >= log(x/2 + 3) + 2 for every x >= 68: at 68 by balls, beyond because the difference rises (z3)."""
    (x,) = reals("x")
    rises = prove("2/x > 1/(x + 6)", [x >= at], 2 * (x + 6) > x)

    def gap(x: Ball) -> Ball:
        return 2 * x.log() - (x / 2 + 3).log() - 2

    return together(rises, prove_positive("2 log x - log(x/2 + 3) - 2", gap, {"x": (at, at)}))


def _sixteen_logs(n: int) -> Ball:
    return 16 * ball(n).log()


def corollary_start(*, least: int = 68) -> Outcome:
    """4 S^2 A log(nH/delta)/n < 1 needs n >= 68 when S >= 2 and nH >= 2 (or delta <= 1/2): 16 log n >= n up to 67.

    The bound is at least 16 log(n)/n (and 16 log 2 at n = 1); log(n)/n falls from n = 3 on, so two ends decide.
    """
    tally = Tally()
    for n in range(2, least):
        tally.expect(at_most(n, partial(_sixteen_logs, n)), f"16 log({n}) < {n}")
    tally.expect(at_most(1, partial(_sixteen_logs, 2)), "n = 1")
    tally.expect(not at_most(least, partial(_sixteen_logs, least)), f"{least} is not the first")
    return tally.outcome(f"the bound is vacuous up to n = {least - 1}")


def closed_form_below_stated(*, factor: Fraction = Fraction(1)) -> Outcome:
    """Where R_2 = 4 S^2 A log(nH/delta)/n is below 1, the proved closed form and infimum are below it (balls)."""
    tally = Tally()
    for size, actions, horizon, delta in product(
        (2, 3, 8), (1, 4), (1, 10), (Fraction(1, 2), Fraction(1, 100), Fraction(99, 100))
    ):
        for n in (70, 200, 2000, 10**5):
            values = {"S": size, "H": horizon, "n": n}
            stated = partial(scaled, factor, transition_error_stated, A=actions, delta2=delta, **values)
            if at_most(partial(value_of, transition_error_stated, A=actions, delta2=delta, **values), 1):
                for formula in (transition_error_closed_form, transition_error_repaired):
                    proved = partial(value_of, formula, rows=size * actions, delta=delta, **values)
                    tally.expect(at_most(proved, stated), f"{formula.name} at {values}, A = {actions}")
    return tally.outcome("both proved forms on a grid")


def infimum_is_attained(*, constant: int = 6) -> Outcome:
    """The paper's infimum over eps equals its value where eps^2 + H eps = 6 D H/n, and no other eps does better."""
    tally = Tally()
    for size, actions, horizon, n in product((2, 4), (1, 3), (1, 7), (50, 5000)):
        dimension, confidence = size * actions * (size - 1), log(10)

        def objective(
            eps: float, d: int = dimension, h: int = horizon, n: int = n, confidence: float = confidence
        ) -> float:
            return constant * (log(2) + d * log(h / eps + 1) + confidence) / n + eps

        stated = float(transition_error_infimum.estimate(S=size, A=actions, H=horizon, n=n, delta=0.1))
        grid = [objective(10.0 ** (k / 200)) for k in range(-1200, 1200)]
        tally.expect(bool(min(grid) >= stated * (1 - 1e-9)), f"a grid point is below the infimum at n = {n}")
        tally.expect(bool(min(grid) <= stated * (1 + 1e-3)), f"the infimum is not approached at n = {n}")
    return tally.outcome("the infimum against a grid of 2,400 scales")


def covering_number_grid(*, slack: float = 1e-9) -> Outcome:
    """The repaired error is the minimum over the lattice of 2 log(N/delta)/n + 2 eps, by brute force over k."""
    tally = Tally()
    for size, rows_, horizon, n, delta in product((2, 5), (2, 20), (1, 8), (40, 300), (0.05,)):
        values = [
            2 * rows_ * log(comb(k + 2 * size - 2, size - 1)) / n + 2 * horizon * log(1 + (size - 1) / k)
            for k in range(1, 6000)
        ]
        expected = min(values) + 2 * log(1 / delta) / n
        value = float(transition_error_repaired.estimate(S=size, rows=rows_, H=horizon, n=n, delta=delta))
        tally.expect(bool(abs(value - expected) <= slack * expected), f"{value} instead of {expected}")
    return tally.outcome("brute force over the lattice")


def dimension_is_below(*, power: int = 2) -> Outcome:
    """D = S A (S - 1) <= S^2 A and D >= 2 for S >= 2: the corollary's constants."""
    s, a = reals("S A")
    return prove("S A (S - 1) <= S^2 A", [s >= 2, a >= 1], s * a * (s - 1) <= (s**power if power > 1 else s) * a)
