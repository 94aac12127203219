"""A finite MDP in rationals, readable from and writable to JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from bridge_theory.errors import InputError
from proofs_checks.exact.laws import Choice, Law, Row, deterministic, stationary_kernel, trajectory_law

Kernel = tuple[tuple[tuple[Fraction, ...], ...], ...]


@dataclass(frozen=True)
class Model:
    """Initial law, kernel ``kernel[s][a][s']`` and horizon (pairs in a trajectory), all exact."""

    initial: tuple[Fraction, ...]
    kernel: Kernel
    horizon: int

    @property
    def n_states(self) -> int:
        return len(self.initial)

    @property
    def n_actions(self) -> int:
        return len(self.kernel[0])

    def under(self, kernel: Kernel) -> Model:
        """The same first state and horizon with another kernel."""
        return Model(self.initial, kernel, self.horizon)

    def law(self, policy: Choice | Sequence[int], *, arrival: bool = False) -> Law:
        """The law of a trajectory; a sequence of actions is a deterministic stationary policy."""
        choice = policy if callable(policy) else deterministic(policy, self.n_actions)
        return trajectory_law(self.initial, choice, stationary_kernel(self.kernel), self.horizon, arrival=arrival)


def fractions_of(values: Sequence[Any]) -> tuple[Fraction, ...]:
    """Strings such as ``"1/3"`` and integers as exact numbers."""
    return tuple(Fraction(value) for value in values)


def probability_row(values: Sequence[Any]) -> tuple[Fraction, ...]:
    """A row of exact probabilities; refused unless it is one."""
    row = fractions_of(values)
    if sum(row) != 1 or min(row) < 0:
        raise InputError(f"{[str(p) for p in row]} is no probability vector; expected nonnegative entries of sum 1.")
    return row


def kernel_of(table: Sequence[Sequence[Sequence[Any]]]) -> Kernel:
    """A kernel from nested lists of strings or integers."""
    return tuple(tuple(probability_row(row) for row in rows) for rows in table)


def point(index: int, size: int) -> Row:
    """The probability vector that is 1 at ``index``."""
    return tuple(Fraction(i == index) for i in range(size))
