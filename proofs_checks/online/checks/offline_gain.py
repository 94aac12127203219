"""What offline data buy for every algorithm (R8), and coverage (R10), in exact arithmetic."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from math import comb
from typing import Any

import bridge_theory as theory
from proofs_checks.context import Context
from proofs_checks.outcome import Outcome, Tally, together


def deterministic_laws(context: Context, *, power: int = 1) -> Outcome:
    """For deterministic policies TV = H^2 = the probability to visit a state where they differ."""
    from proofs_checks.exact import strategies
    from proofs_checks.exact.every import on_every
    from proofs_checks.exact.laws import probability_of_hitting, squared_hellinger, total_variation

    def holds(pair: Any) -> bool:
        first, second = pair.model.law(pair.expert), pair.model.law(pair.clone)
        differ = [s for s in range(pair.model.n_states) if pair.expert[s] != pair.clone[s]]
        hit = probability_of_hitting(first, differ, pair.model.horizon)
        return bool(total_variation(first, second) == hit**power and squared_hellinger(first, second) == hit)

    return on_every("deterministic policies", strategies.pairs(), holds, context.pick(quick=40, full=200))


def transfer_between_kernels(context: Context, *, factor: Fraction | int = 1) -> Outcome:
    """|TV(P^pi, P^pi') - TV(Q^pi, Q^pi')| is at most TV(P^pi', Q^pi') and at most TV(P^pi, Q^pi), for all policies."""
    from hypothesis import strategies as st

    from proofs_checks.exact import strategies
    from proofs_checks.exact.every import on_every
    from proofs_checks.exact.laws import total_variation

    @st.composite
    def instances(draw: Any) -> Any:
        pair = draw(strategies.pairs())
        return pair, draw(strategies.choices(pair.model)), draw(strategies.choices(pair.model))

    def holds(instance: Any) -> bool:
        pair, one, two = instance
        p1, p2, q1, q2 = (world.law(policy) for world, policy in product((pair.model, pair.estimate), (one, two)))
        gap = abs(total_variation(p1, p2) - total_variation(q1, q2))
        return bool(gap <= factor * min(total_variation(p2, q2), total_variation(p1, q1)))

    return on_every("total variation transfers", instances(), holds, context.pick(quick=40, full=200))


def version_space(*, share: Fraction | int = 1) -> Outcome:
    """One state in which the clone may err, visited with probability q: P(unseen and q > bound) <= delta, exactly.

    The version space errs in a set of unseen states; for a single state the failure probability is (1-q)^n.
    """
    tally = Tally()
    for n, q in product((1, 5, 40), (Fraction(1, 100), Fraction(1, 10), Fraction(1, 2))):
        unseen = (1 - q) ** n
        for S, A in ((1, 2), (3, 4)):
            delta = unseen - unseen / 1000 if unseen < 1 else Fraction(1, 2)
            for bound in (
                theory.delta_n_version_space.enclosure(S=S, A=A, n=n, delta_off=delta),
                theory.delta_n_version_space_sharp.enclosure(S=S, n=n, delta_off=delta),
            ):
                # the state is unseen with probability just above delta, so the bound must not be below q
                tally.expect(share * Fraction(bound.upper) >= q or q > 1, f"n = {n}, q = {q}: bound {bound} below q")
        failing = theory.exact_recovery_failure.enclosure(S_reach=1, n=n, gamma_min=q)
        tally.expect(Fraction(failing.upper) * share >= unseen, f"n = {n}, q = {q}: {failing} below {unseen}")
    return tally.outcome("one hidden state, nine (n, q)")


def chernoff(context: Context, *, rate: int = 8) -> Outcome:
    """P(Binomial(n, gamma) < n gamma / 2) <= exp(-n gamma / 8), by exact binomial sums."""
    tally = Tally()
    for n in range(1, context.pick(quick=40, full=150)):
        for gamma in (Fraction(1, 20), Fraction(1, 5), Fraction(1, 2), Fraction(19, 20)):
            most = -(-n * gamma // 2) - 1  # the largest count below n gamma / 2
            tail = sum((comb(n, k) * gamma**k * (1 - gamma) ** (n - k) for k in range(int(most) + 1)), Fraction(0))
            bound = theory.coverage_failure.enclosure(S_reach=1, n=n, gamma_min=gamma).upper ** (8 / rate)
            tally.expect(tail <= Fraction(bound), f"n = {n}, gamma = {gamma}: {float(tail):.3g} above {bound}")
    return tally.outcome("exact binomial tails")


def covered_bonus(*, offset: int = 0) -> Outcome:
    """On the coverage event a covered pair costs at most 4 eta sqrt(2U/(n gamma)), others at most 2 eta each."""
    from proofs_checks.smt import prove, reals

    eta, count, root, bonus, log_term, half = reals("eta count root bonus log_term half")
    return prove(
        "covered pair",
        [
            eta > 0, log_term >= 0, half > 0, count >= half, root >= 0, bonus >= 0,
            bonus * bonus * count == 16 * eta * eta * log_term,  # xi without its cap
            root * root * half == log_term,  # sqrt(2U/(n gamma)) with half = n gamma / 2
        ],
        bonus <= (4 - offset) * eta * root,
    )  # fmt: skip


def trivial_regime(*, beyond: int = 1, least: int = 1) -> Outcome:
    """B W x <= Gamma sqrt(x/d) for 0 <= x = T S / n <= d, where Gamma = (W sqrt(kappa B) + W B) d L with L >= 1."""
    from proofs_checks.smt import prove, reals

    x, d, root, product, curved, logarithm = reals("x d root product curved logarithm")
    chord = prove("x <= sqrt(dx)", [d >= 1, x >= 0, x <= beyond * d, root >= 0, root * root == d * x], x <= root)
    # d sqrt(x/d) = sqrt(dx)
    scale = prove(
        "BWx <= Gamma sqrt(x/d)",
        [x >= 0, x <= root, product >= 0, curved >= 0, logarithm >= least],
        product * x <= (curved + product) * logarithm * root,
    )
    return together(chord, scale)


def growth_of_the_first_term(*, constant: str = "1") -> Outcome:
    """For 0 < x = T/n <= 1, sqrt(T log(1+x)) is between 0.83 and 1 times T/sqrt(n), the order of the trivial bound.

    log(1+x) - k x is concave and 0 at 0. With k = constant its slope at 0 is 0, so it falls below; with k = 0.83^2 it
    is positive at 1, so that it is above on the whole interval.
    """
    import sympy

    from bridge_theory.arithmetic.flint_balls import ball
    from proofs_checks.symbolic import identity

    x = sympy.Symbol("x", nonnegative=True)
    gap = sympy.log(1 + x) - sympy.Rational(constant) * x
    tally = Tally()
    tally.expect(bool(ball(2).log() - ball(Fraction(83, 100)) ** 2 > 0), "log 2 is below 0.83^2")
    return together(
        identity("zero at 0", gap.subs(x, 0), sympy.S.Zero),
        identity("slope 0 at 0", sympy.diff(gap, x).subs(x, 0), sympy.S.Zero),
        identity("concave", sympy.diff(gap, x, 2), -1 / (1 + x) ** 2),
        tally.outcome("log(1+x) is above 0.83^2 x at 1"),
    )
