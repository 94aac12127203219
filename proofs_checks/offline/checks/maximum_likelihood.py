"""T6: tails of the maximum-likelihood error, by enumeration of every sample."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import partial
from math import factorial, prod

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from bridge_theory import (
    mle_covering_repaired,
    mle_finite_repaired,
    mle_finite_sharp,
    mle_misspecified_repaired,
    policy_error_corollary,
    policy_error_finite,
    policy_error_sharp,
    policy_error_stated,
)
from bridge_theory.arithmetic.flint_balls import Ball, ball
from proofs_checks.context import Context
from proofs_checks.exact.certify import Number, at_most, attained, scaled, value_of, within
from proofs_checks.exact.every import QUICK, on_every
from proofs_checks.exact.laws import row_hellinger
from proofs_checks.exact.strategies import Row, rows
from proofs_checks.exact.surd import Surd, root, surd
from proofs_checks.outcome import Outcome, Tally
from proofs_checks.smt import prove, reals

Counts = tuple[int, ...]


@st.composite
def _classes(draw: DrawFn) -> tuple[list[Row], int]:
    size = draw(st.integers(2, 3))
    laws = draw(st.lists(rows(size, (0, 1, 2, 3)), min_size=2, max_size=4))
    return laws, draw(st.integers(1, 4))


def samples(size: int, n: int) -> Iterator[Counts]:
    """All count vectors of n draws from ``size`` outcomes."""
    if size == 1:
        yield (n,)
        return
    for first in range(n + 1):
        for rest in samples(size - 1, n - first):
            yield (first, *rest)


def likelihood(law: Row, counts: Counts) -> Fraction:
    """The likelihood of one sample with these counts."""
    return prod((p**c for p, c in zip(law, counts, strict=True)), start=Fraction(1))


def probability(law: Row, counts: Counts) -> Fraction:
    """The probability of these counts."""
    ways = factorial(sum(counts)) // prod(factorial(c) for c in counts)
    return ways * likelihood(law, counts)


def finite_class(*, others: int = 1, context: Context = QUICK) -> Outcome:
    """P(some maximiser has H^2 >= R) <= (|G| - 1)(1 - R)^n at every attained R > 0, for the worst tie-break."""

    def holds(instance: tuple[list[Row], int]) -> bool:
        laws, n = instance
        truth, errors = laws[0], [row_hellinger(law, laws[0]) for law in laws]
        worst: list[tuple[Surd, Fraction]] = []
        for counts in samples(len(truth), n):
            chance = probability(truth, counts)
            if chance:
                values = [likelihood(law, counts) for law in laws]
                best = max(values)
                tied = [error for value, error in zip(values, errors, strict=True) if value == best]
                worst.append((max(tied), chance))
        for radius in errors:
            if radius > 0:
                tail = sum((p for error, p in worst if error >= radius), Fraction(0))
                if surd(tail) > _power(1 - radius, n) * (len(laws) - others):
                    return False
        return True

    return on_every("tail of the maximum-likelihood error", _classes(), holds, context.pick(quick=60, full=200))


def _power(value: Surd, n: int) -> Surd:
    result = surd(1)
    for _ in range(n):
        result = result * value
    return result


def finite_formulas(*, others: int = 1) -> Outcome:
    """(|G| - 1)(1 - R)^n = delta at the sharp formula, which is below the repaired one."""
    tally = Tally()
    for size in (2, 3, 17):
        for n in (1, 4, 25):
            stay = Fraction(2, 5)
            delta = (size - others) * stay**n
            if 0 < delta < 1:
                values = {"n": n, "class_size": size, "delta": delta}
                tally.expect(attained(1 - stay, mle_finite_sharp, **values), f"sharp at {values}")
                tally.expect(within(1 - stay, mle_finite_repaired, **values), f"repaired at {values}")
                below = at_most(
                    partial(value_of, mle_finite_repaired, **values),
                    partial(value_of, policy_error_finite, **values),
                )
                tally.expect(below, f"the paper's finite-class bound is below the repaired one at {values}")
    return tally.outcome("formulas of the finite class")


def _worst_error(candidates: Sequence[Row], truth: Row, counts: Counts) -> Surd:
    values = [likelihood(law, counts) for law in candidates]
    best = max(values)
    return max(row_hellinger(law, truth) for law, value in zip(candidates, values, strict=True) if value == best)


def covered_class(*, shrink: Fraction = Fraction(1)) -> Outcome:
    """T6(ii) on coins: P(H^2 > 2 log(N/delta)/n + 2 eps) <= delta, for the worst maximiser, by exact binomial sums."""
    tally = Tally()
    truth: Row = (Fraction(1, 2), Fraction(1, 2))
    coins = [(Fraction(k, 40), Fraction(40 - k, 40)) for k in range(1, 40)]
    centres = [(Fraction(k, 20), Fraction(20 - k, 20)) for k in range(1, 20)]
    ratio = max(min(max(a / b for a, b in zip(g, c, strict=True)) for c in centres) for g in coins)

    def scale() -> Ball:
        return ball(ratio).log()

    def size() -> Ball:
        return ball(len(centres)).log()

    for n, delta in ((30, Fraction(1, 2)), (60, Fraction(1, 2)), (60, Fraction(1, 10))):
        failure = _failure(
            coins,
            truth,
            n,
            partial(scaled, shrink, mle_covering_repaired, n=n, delta=delta, log_covering=size, epsilon=scale),
        )
        tally.expect(failure <= delta, f"the error exceeds the bound with probability {float(failure):.3g} > {delta}")
    return tally.outcome("coins with a cover of 19")


def _failure(candidates: Sequence[Row], truth: Row, n: int, limit: Number) -> Fraction:
    total = Fraction(0)
    for counts in samples(2, n):
        if not at_most(_worst_error(candidates, truth, counts), limit):
            total += probability(truth, counts)
    return total


def misspecified_class(*, shrink: Fraction = Fraction(1)) -> Outcome:
    """T6(iii) on coins that exclude the truth: chi^2 of the nearest one enters, by exact binomial sums."""
    tally = Tally()
    truth: Row = (Fraction(1, 2), Fraction(1, 2))
    coins = [(Fraction(k, 20), Fraction(20 - k, 20)) for k in (2, 4, 13, 17)]
    chi2 = min(sum(t * t / g for t, g in zip(truth, coin, strict=True)) - 1 for coin in coins)

    def size() -> Ball:
        return ball(len(coins)).log()

    for n, delta in ((40, Fraction(1, 2)), (80, Fraction(1, 4))):
        failure = _failure(
            coins,
            truth,
            n,
            partial(
                scaled, shrink, mle_misspecified_repaired, n=n, delta=delta, log_covering=size, epsilon=0, chi2=chi2
            ),
        )
        tally.expect(failure <= delta, f"the error exceeds the bound with probability {float(failure):.3g} > {delta}")
    return tally.outcome("four coins without the truth")


def paper_constants_are_safe(*, sixth: Fraction = Fraction(1)) -> Outcome:
    """S log 2 + log(1/delta) <= c S log(A/delta) for A >= 2 and c = 4 or 6: both of the paper's policy errors hold."""
    tally = Tally()
    for size in (1, 2, 5, 20):
        for actions in (2, 4):
            for delta in (Fraction(1, 100), Fraction(1, 2), Fraction(999, 1000)):
                for n in (1, 50):
                    values = {"S": size, "n": n}
                    for formula, key in ((policy_error_stated, "delta1"), (policy_error_corollary, "delta")):
                        below = at_most(
                            partial(value_of, policy_error_sharp, delta=delta, **values),
                            partial(scaled, sixth, formula, A=actions, **{key: delta}, **values),
                        )
                        tally.expect(below, f"{formula.name} at S = {size}, A = {actions}, delta = {delta}, n = {n}")
    return tally.outcome("the paper's policy errors exceed the sharp one")


def constants_by_logarithms(*, constant: int = 4) -> Outcome:
    """With a = log A >= b = log 2 > 0 and l = log(1/delta) > 0: S b + l <= constant S (a + l) for S >= 1."""
    size, a, b, logarithm = reals("S a b l")
    hypotheses = [size >= 1, b > 0, a >= b, logarithm > 0]
    return prove(
        "S log 2 + log(1/delta) <= c S log(A/delta)",
        hypotheses,
        size * b + logarithm <= constant * size * (a + logarithm),
    )


def finite_class_constants(*, constant: int = 6) -> Outcome:
    """With b = log(|G| - 1) <= c = log(2 |G|), c > 0, l = log(1/delta) >= 0: b + l <= constant (c + l)."""
    b, c, logarithm = reals("b c l")
    hypotheses = [b <= c, c > 0, logarithm >= 0]
    return prove("the paper's finite-class constant", hypotheses, b + logarithm <= constant * (c + logarithm))


def union_step(*, limit: Fraction = Fraction(1)) -> Outcome:
    """2 A^S/delta <= (A/delta)^S exactly when delta^(S-1) <= 1/2: the corollary's step, in integers."""
    tally = Tally()
    for size in (1, 2, 3, 5):
        for actions in (1, 2, 4):
            for k in range(1, 40):
                delta = Fraction(k, 40)
                step = 2 * actions**size / delta <= (actions / delta) ** size
                tally.expect(step == (2 * delta ** (size - 1) <= limit), f"S = {size}, A = {actions}, delta = {delta}")
    return tally.outcome("the corollary's step")


def renyi_identity(*, order: int = 2, context: Context = QUICK) -> Outcome:
    """-n log E_{g*} exp((1/2) log(g/g*)) = (n/2) D_{1/2}: both are -n log BC on common supports."""

    def holds(instance: tuple[list[Row], int]) -> bool:
        laws, _ = instance
        g, truth = laws[1], laws[0]
        mean = sum((root(q / p) * p for q, p in zip(g, truth, strict=True) if p), surd(0))
        renyi_integral = sum((root(q * p) * Fraction(2, order) for q, p in zip(g, truth, strict=True)), surd(0))
        return mean == renyi_integral == 1 - row_hellinger(g, truth)

    return on_every("Renyi divergence of order 1/2", _classes(), holds, context.pick(quick=40, full=120))


def exponential_inequality(*, factor: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """P(sum X_t < sum -log E e^{-X_t} - log(1/delta)) <= delta for X_t = log(p/q)/2: Markov on an exact martingale.

    Enumerates n draws; exp(-sum X)/prod E e^{-X} must have mean 1, so its mass above 1/delta is at most delta.
    """

    def holds(instance: tuple[list[Row], int]) -> bool:
        laws, n = instance
        truth, other = laws[0], laws[1]
        overlap = 1 - row_hellinger(truth, other)
        if overlap == 0:
            return True
        mean = surd(0)
        for counts in samples(len(truth), n):
            chance = probability(truth, counts)
            if chance:
                mean += root(likelihood(other, counts) / likelihood(truth, counts)) * chance
        return mean == _power(overlap * factor, n)

    return on_every("exponential martingale", _classes(), holds, context.pick(quick=40, full=120))
