"""Without a model of utility: bets are fair, their mixture fails no more than delta, and cycles can have no winner."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import product
from math import factorial

import bridge_theory as theory
from bridge_theory.arithmetic.flint_balls import Ball, ball
from proofs_checks.answers.checks.games import Counts, worst_chance
from proofs_checks.context import Context
from proofs_checks.exact.certify import at_most, value_of
from proofs_checks.exact.every import QUICK
from proofs_checks.outcome import Outcome, Tally

CHANCES = tuple(Fraction(k, 12) for k in (1, 3, 5, 6, 8, 11))


def mixture(ones: int, zeros: int, p: Fraction, *, extra: int = 1) -> Fraction:
    """The uniform mixture of bets against the chance p after these answers: a martingale for ``extra`` = 1."""
    return Fraction(factorial(ones) * factorial(zeros), factorial(ones + zeros + extra)) / (p**ones * (1 - p) ** zeros)


def fair(*, extra: int = 1) -> Outcome:
    """Single bets and the uniform mixture keep their mean exactly, from every state, at every chance."""
    tally = Tally()
    for p in CHANCES:
        for stake in (-1 / (1 - p), Fraction(-1, 2), Fraction(1, 3), 1 / p):
            mean = p * (1 + stake * (1 - p)) + (1 - p) * (1 - stake * p)
            tally.expect(mean == 1, f"a bet of {stake} at {p} has mean {mean}")
        for ones, zeros in product(range(8), repeat=2):
            now = mixture(ones, zeros, p, extra=extra)
            later = p * mixture(ones + 1, zeros, p, extra=extra) + (1 - p) * mixture(ones, zeros + 1, p, extra=extra)
            tally.expect(later == now, f"the mixture at {ones}, {zeros} and {p} moves from {now} to {later}")
    return tally.outcome("bets and their mixture are martingales, exactly")


def ever_outside(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """Two pairs, any adaptive asker: some pair's chance ever leaves its closed-form interval, at most delta = 1/5.

    ``share`` multiplies the width.
    """
    delta, tally, worst = Fraction(1, 5), Tally(), Fraction(0)
    depth = context.pick(quick=12, full=20)
    for chances in (CHANCES[:2], CHANCES[2:4], CHANCES[4:]):

        def outside(counts: Counts, chances: tuple[Fraction, ...] = chances) -> bool:
            return any(_leaves(counts[2 * i], counts[2 * i + 1], p, share, delta) for i, p in enumerate(chances))

        found = worst_chance(chances, depth, outside)
        worst = max(worst, found)
        tally.expect(found <= delta, f"chances {chances} leave with probability {float(found):.4f}")
    return tally.outcome(f"the worst asker gets {float(worst / delta):.2f} of delta")


def _leaves(ones: int, zeros: int, p: Fraction, share: Fraction, delta: Fraction) -> bool:
    t = ones + zeros
    if t == 0:
        return False
    off = abs(Fraction(ones, t) - p) / share
    return not at_most(off, lambda: value_of(theory.preference_width, t=t, pairs=2, delta=delta))


def closed_form(*, offset: int = 1) -> Outcome:
    """The mixture is at least exp(t kl)/(t + 1), so that the interval of the mixture lies inside the closed form.

    (t + 1) C(t, s) p^s (1-p)^(t-s) <= t + 1 with p = s/t: one term of a binomial sum is at most 1.
    """
    tally = Tally()
    for ones, zeros in product(range(12), repeat=2):
        t = ones + zeros
        if t == 0:
            continue
        peak = Fraction(ones, t) ** ones * Fraction(zeros, t) ** zeros
        value = Fraction(factorial(ones) * factorial(zeros), factorial(t + 1))
        tally.expect(value * (t + offset) >= peak, f"the mixture is too small at {ones}, {zeros}")
    return tally.outcome("the mixture against exp(t kl)/(t + 1), exactly")


def pinsker(*, factor: int = 2) -> Outcome:
    """kl(q, p) >= 2(q - p)^2: value and slope in q vanish at p, the second derivative is 1/(q(1-q)) >= 4."""
    import sympy

    from proofs_checks.outcome import together
    from proofs_checks.smt import prove, reals
    from proofs_checks.symbolic import identity

    q, p = sympy.symbols("q p", positive=True)
    gap = q * sympy.log(q / p) + (1 - q) * sympy.log((1 - q) / (1 - p)) - factor * (q - p) ** 2
    (x,) = reals("x")
    return together(
        identity("value", sympy.simplify(gap.subs(q, p)), sympy.Integer(0)),
        identity("slope", sympy.simplify(sympy.diff(gap, q).subs(q, p)), sympy.Integer(0)),
        identity("second derivative", sympy.diff(gap, q, 2), 1 / (q * (1 - q)) - 2 * factor),
        prove("1/(q(1-q)) >= 4", [x > 0, x < 1], 2 * factor * x * (1 - x) <= 1),
    )


def cycle(*, least: Fraction = Fraction(61, 100)) -> Outcome:
    """Three candidates under one utility, each preferred to the next by .61: chances in balls.

    One always yields 3; one yields 1 or 4; one yields 0 or 7/2. With weights near the golden section all three chances
    are near .618, the most that three candidates allow when utilities lie far apart.
    """
    golden = Fraction(34, 55)
    laws = (
        ((Fraction(3), Fraction(1)),),
        ((Fraction(1), golden), (Fraction(4), 1 - golden)),
        ((Fraction(0), 1 - golden), (Fraction(7, 2), golden)),
    )
    tally = Tally()
    for i in range(3):
        pairs = list(product(laws[i], laws[(i + 1) % 3]))

        def chance(pairs: Sequence[tuple[tuple[Fraction, Fraction], ...]] = pairs) -> Ball:
            terms = (ball(p * q) / (1 + ball(20 * (b - a)).exp()) for (a, p), (b, q) in pairs)
            return sum(terms, start=ball(0))

        tally.expect(at_most(least, chance), f"candidate {i} is preferred to the next with a chance below {least}")
    return tally.outcome("a cycle of three under one utility, each preferred to the next with at least .61")
