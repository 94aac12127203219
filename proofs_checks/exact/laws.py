r"""Trajectory laws by enumeration, and the distances between them, straight from the definitions.

A history is the tuple ``(s_1, a_1, s_2, a_2, ...)``; policies and kernels are functions of it, so that stationary,
time-dependent and history-dependent ones are enumerated by the same few lines.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import product
from operator import itemgetter
from typing import Any

from bridge_theory.arithmetic.flint_balls import Ball, ball
from proofs_checks.exact.surd import Surd, root, surd

Row = Sequence[Fraction]
History = tuple[int, ...]
Law = Mapping[History, Fraction]
Choice = Callable[[History], Row]
"""A policy (what follows a history that ends in a state) or a kernel (what follows one that ends in an action)."""


def deterministic(actions: Sequence[int], n_actions: int) -> Choice:
    """The stationary policy that plays ``actions[s]`` in state s."""
    rows = [tuple(Fraction(a == chosen) for a in range(n_actions)) for chosen in actions]
    return lambda history: rows[history[-1]]


def stationary_policy(table: Sequence[Row]) -> Choice:
    """The policy with rows ``table[s]``."""
    return lambda history: table[history[-1]]


def stationary_kernel(table: Sequence[Sequence[Row]]) -> Choice:
    """The kernel with rows ``table[s][a]``."""
    return lambda history: table[history[-2]][history[-1]]


def trajectory_law(initial: Row, policy: Choice, kernel: Choice, horizon: int, *, arrival: bool = False) -> Law:
    """The law of ``(s_1, a_1, ..., s_H, a_H)``, with ``s_{H+1}`` behind it if ``arrival``; positive entries only."""
    law: dict[History, Fraction] = {(s,): p for s, p in enumerate(initial) if p}
    for step in range(horizon):
        law = _extended(law, policy)
        if step < horizon - 1 or arrival:
            law = _extended(law, kernel)
    return law


def _extended(law: Law, choice: Choice) -> dict[History, Fraction]:
    return {(*h, x): mass * p for h, mass in law.items() for x, p in enumerate(choice(h)) if p}


def bhattacharyya(first: Mapping[Any, Fraction], second: Mapping[Any, Fraction]) -> Surd:
    """BC = sum of sqrt(P Q), exactly."""
    return sum((root(p * second[x]) for x, p in first.items() if x in second), surd(0))


def squared_hellinger(first: Mapping[Any, Fraction], second: Mapping[Any, Fraction]) -> Surd:
    """H^2 = 1 - BC, exactly."""
    return 1 - bhattacharyya(first, second)


def row_hellinger(first: Row, second: Row) -> Surd:
    """H^2 of two probability vectors."""
    return squared_hellinger(dict(enumerate(first)), dict(enumerate(second)))


def total_variation(first: Mapping[Any, Fraction], second: Mapping[Any, Fraction]) -> Fraction:
    """TV = half the sum of |P - Q|."""
    zero = Fraction(0)
    return sum((abs(first.get(x, zero) - second.get(x, zero)) for x in {*first, *second}), zero) / 2


def kl_divergence(first: Mapping[Any, Fraction], second: Mapping[Any, Fraction]) -> Ball:
    """KL(P || Q) in nats as a ball; P must be absolutely continuous with respect to Q."""
    return sum((ball(p) * ball(p / second[x]).log() for x, p in first.items() if p), start=ball(0))


def row_kl(first: Row, second: Row) -> Ball:
    """KL of two probability vectors."""
    return kl_divergence(dict(enumerate(first)), dict(enumerate(second)))


def marginal(law: Law, key: Callable[[History], Any]) -> dict[Any, Fraction]:
    """The law of ``key(history)``."""
    sums: dict[Any, Fraction] = {}
    for history, mass in law.items():
        sums[key(history)] = sums.get(key(history), Fraction(0)) + mass
    return sums


def occupancies(law: Law, horizon: int) -> list[dict[Any, Fraction]]:
    """d_t(s, a) for t = 1, ..., H as dictionaries of their positive entries, keyed ``(s, a)``."""
    return [marginal(law, itemgetter(slice(2 * t, 2 * t + 2))) for t in range(horizon)]


def probability_of_hitting(law: Law, states: Collection[int], horizon: int) -> Fraction:
    """The probability that one of ``s_1, ..., s_H`` lies in ``states``."""
    return sum((p for h, p in law.items() if any(h[2 * t] in states for t in range(horizon))), Fraction(0))


def deterministic_policies(n_states: int, n_actions: int) -> Iterator[tuple[int, ...]]:
    """All A^S deterministic stationary policies."""
    return product(range(n_actions), repeat=n_states)
