"""Trajectory laws in exact rationals, for the checks: by the recursion, and by enumerating every trajectory.

Square roots of rationals are rational only for perfect squares; with equal dynamics and deterministic policies every
root that occurs is one. Where a root is irrational the functions refuse, they never round.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import product
from math import isqrt

from bridge_theory.errors import InputError

Kernel = Sequence[Sequence[Sequence[Fraction]]]
"""P(s'|s, a) as nested sequences [s][a][s'] of Fractions."""
ExactPolicy = Sequence[Sequence[Fraction]]
"""pi(a|s) as nested sequences [s][a] of Fractions."""


def exact_sqrt(value: Fraction) -> Fraction:
    """The square root of a rational square.

    >>> exact_sqrt(Fraction(9, 25))
    Fraction(3, 5)
    """
    numerator, denominator = isqrt(value.numerator), isqrt(value.denominator)
    if numerator**2 != value.numerator or denominator**2 != value.denominator:
        raise InputError(f"the square root of {value} is not rational; choose an instance whose roots are.")
    return Fraction(numerator, denominator)


def exact_bhattacharyya(
    initial: Sequence[Fraction], horizon: int, kernels: tuple[Kernel, Kernel], policies: tuple[ExactPolicy, ExactPolicy]
) -> Fraction:
    """BC between the laws (kernels[i], policies[i]), i = 0, 1, with a common initial law, by the recursion."""
    states = range(len(initial))
    actions = range(len(policies[0][0]))
    roots = [[exact_sqrt(policies[0][s][a] * policies[1][s][a]) for a in actions] for s in states]
    x = list(initial)
    for _ in range(horizon - 1):
        x = [
            sum(
                (
                    x[s] * roots[s][a] * exact_sqrt(kernels[0][s][a][p] * kernels[1][s][a][p])
                    for s in states
                    for a in actions
                ),
                Fraction(0),
            )
            for p in states
        ]
    return sum((x[s] * roots[s][a] for s in states for a in actions), Fraction(0))


def trajectory_law(
    initial: Sequence[Fraction], horizon: int, kernel: Kernel, policy: ExactPolicy
) -> dict[tuple[int, ...], Fraction]:
    """The whole law of (s_1, a_1, ..., s_H, a_H) as a dictionary of its positive probabilities."""
    law: dict[tuple[int, ...], Fraction]
    law = {(s, a): p * policy[s][a] for s, p in enumerate(initial) for a in range(len(policy[s])) if p * policy[s][a]}
    for _ in range(horizon - 1):
        law = {
            (*path, s, a): mass * kernel[path[-2]][path[-1]][s] * policy[s][a]
            for (path, mass), s in product(law.items(), range(len(initial)))
            for a in range(len(policy[s]))
            if kernel[path[-2]][path[-1]][s] * policy[s][a]
        }
    return law


def enumerated_bhattacharyya(law1: dict[tuple[int, ...], Fraction], law2: dict[tuple[int, ...], Fraction]) -> Fraction:
    """BC of two finite laws by the definition, sum over trajectories of sqrt(P Q)."""
    return sum((exact_sqrt(mass * law2[path]) for path, mass in law1.items() if path in law2), Fraction(0))
