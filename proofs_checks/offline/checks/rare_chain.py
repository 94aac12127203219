"""T2 from below: a chain of 3002 steps, entered by a rare event, whose H^2 is more than 2.9615 times the sum.

State 0 is where the laws agree, state 1 the chain, and P ends in 2, Q in 3. The first step enters the chain with a
small probability. In the chain a path stays with probability 1 - e under P and (1 - e) t^2 under Q, and leaves, to
where the laws agree again, with e and e r^2; the last step parts for good. All of these are rational, and so are the
roots of the products, so that H^2 and sum_t E_P[h_t] follow by one pass from the end.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from typing import Any, TypeAlias

from bridge_theory.arithmetic import flint_balls
from proofs_checks.exact.laws import History, row_hellinger, squared_hellinger, stationary_policy, trajectory_law
from proofs_checks.exact.model import point
from proofs_checks.exact.strategies import Row
from proofs_checks.exact.surd import surd
from proofs_checks.offline.checks.trajectory_error import circle
from proofs_checks.outcome import Outcome, Tally

Step: TypeAlias = tuple[Fraction, Fraction]
"""How the root of the likelihood ratio moves when a path stays (t >= 1) and what it is multiplied by at an exit (r)."""

_ENTRY = (Fraction(1, 2000), Fraction(1002, 1000) / 2000)  # half the sines of P's and Q's angles: p = 1e-6, q = p r^2
_WEIGHT = Fraction(338, 1000)  # where the chain starts: the root of the likelihood ratio over the constant
_FALLING, _PARTING = 2000, 1000
_FAR = 100  # the parting part ends where the root of the likelihood ratio is 100
_BITS = 200


def rare_event_ratio(*, least: Fraction = Fraction(29615, 10000), kept: Fraction = Fraction(1)) -> Outcome:
    """H^2 > least * sum on a chain of 3002 steps, in balls; the recursion is that of the laws on short chains.

    ``kept`` is a mutant's: the share of the overlap of each step that its recursion carries on.
    """
    tally = Tally()
    for steps in (chain_steps(2, 1), chain_steps(1, 2)):
        tally.expect(by_recursion(steps, kept=kept) == by_laws(steps), "the recursion differs from the laws")
    with flint_balls.working_precision(_BITS):
        long = chain_steps(_FALLING, _PARTING)
        distance, total = by_recursion(long, flint_balls.ball, kept)
        tally.expect(bool(distance > flint_balls.ball(least) * total), f"the ratio is not above {least}")
        ratio = flint_balls.ends(distance / total)[0]
    return tally.outcome(f"a chain of {len(long) + 2} steps has ratio at least {ratio:.5f}")


@cache
def chain_steps(falling: int, parting: int) -> tuple[Step, ...]:
    """The steps of the chain: exits where the proof's inequality is nearly tight, then exits that Q never takes."""
    growth = _rounded(float(_WEIGHT) ** (-1 / falling))
    exits = [min(_rounded(r), Fraction(1)) for r in _best_exits(falling)]
    return (*((growth, r) for r in exits), *[(_rounded(_FAR ** (1 / parting)), Fraction(0))] * parting)


def _best_exits(falling: int) -> list[float]:
    """The exit that gains most in each step, by floats: that they are near the best is not claimed.

    Where (*) of the induction is tight, U = V + 1/2 and s = 1 + w V' solve s^2 - s (1 + 2U) + (1 - w)^2 = 0, and
    the exit is r = (1 - w) / s. The weight w falls from 1, where U = 0.
    """
    exits, u = [], 0.0
    shrink = float(_WEIGHT) ** (0.5 / falling)  # half a step
    w = 1.0
    for _ in range(falling):
        middle = w * shrink
        half = u + (_slope(w, u) - 1) * math.log(shrink)
        s = _slope(middle, half)
        exits.append((1 - middle) / s)
        w, u = middle * shrink, u + (s - 1) * 2 * math.log(shrink)
    return exits[::-1]


def _slope(w: float, u: float) -> float:
    return ((1 + 2 * u) + math.sqrt(max(0.0, (1 + 2 * u) ** 2 - 4 * (1 - w) ** 2))) / 2


def _rounded(x: float) -> Fraction:
    return Fraction(round(x * 10**6), 10**6)


def _exit(step: Step) -> Fraction:
    """The probability e of an exit under P: that for which Q's probabilities (1 - e) t^2 and e r^2 sum to 1."""
    t, r = step
    return (t**2 - 1) / (t**2 - r**2)


def by_recursion(
    steps: Sequence[Step], number: Callable[[Fraction], Any] = Fraction, kept: Fraction = Fraction(1)
) -> tuple[Any, Any]:
    """H^2 and sum_t E_P[h_t], from the end; ``number`` makes exact rationals or balls of the entries."""
    overlap, total = number(Fraction(0)), number(Fraction(1))  # the last step parts: h = 1
    for t, r in reversed(steps):
        e = _exit((t, r))
        stay, leave = (1 - e) * t, e * r
        overlap = number(kept * leave) + number(stay) * overlap
        total = number(1 - stay - leave) + number(1 - e) * total
    (p_in, p_out), (q_in, q_out) = map(circle, _ENTRY)
    enter, miss = p_in * q_in, p_out * q_out
    return number(1 - miss) - number(enter) * overlap, number(1 - miss - enter) + number(p_in**2) * total


def by_laws(steps: Sequence[Step]) -> tuple[Fraction, Fraction]:
    """The same two numbers from the trajectory laws themselves: their definition, for short chains."""
    length = len(steps) + 2

    def law(of_p: bool) -> Callable[[History], Row]:
        def row(history: History) -> Row:
            state, k = history[-2], len(history) // 2 - 1
            if k == 0:
                entry = circle(_ENTRY[0 if of_p else 1])[0] ** 2
                return (1 - entry, entry, Fraction(0), Fraction(0))
            if state != 1:
                return tuple(point(state, 4))
            if k == length - 1:
                return tuple(point(2 if of_p else 3, 4))
            t, r = steps[k - 1]
            leave = _exit((t, r)) * (1 if of_p else r**2)
            return (leave, 1 - leave, Fraction(0), Fraction(0))

        return row

    p, q = law(True), law(False)
    start, only = tuple(point(0, 4)), stationary_policy([(Fraction(1),)] * 4)
    total = surd(0)
    for t in range(1, length + 1):
        for history, mass in trajectory_law(start, only, p, t).items():
            total += row_hellinger(p(history), q(history)) * mass
    laws = [trajectory_law(start, only, kernel, length, arrival=True) for kernel in (p, q)]
    return squared_hellinger(*laws).rational(), total.rational()
