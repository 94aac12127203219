r"""Events with a stated failure probability, simulated and judged by exact binomial tails.

A correct statement fails in a run with probability at most delta. The check is failed when the number of failures in
``trials`` independent runs is one that a correct statement reaches with probability below ``FALSE_ALARM``; that
probability is computed in rational arithmetic. Beside it stand the Clopper-Pearson limits of the failure probability:
the statement counts as *covered* when the upper limit does not exceed delta.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import comb

import numpy as np

from proofs_checks.outcome import Outcome

FALSE_ALARM = Fraction(1, 10**6)
"""A correct statement fails its check with a probability below this, and the confidence limits err with this one."""

_GRID = 2**14


@dataclass(frozen=True)
class Coverage:
    """How often an event failed in independent runs, against the failure probability that was claimed.

    >>> seen = Coverage(Fraction(1, 10), trials=200, failures=0)
    >>> seen.covered, seen.threshold, seen.false_alarm < FALSE_ALARM
    (True, 43, True)
    """

    claimed: Fraction
    trials: int
    failures: int

    @cached_property
    def threshold(self) -> int:
        """The largest number of failures that passes."""
        tail, passing = Fraction(1), -1
        while tail >= FALSE_ALARM:
            passing += 1
            tail -= _mass(self.trials, passing, self.claimed)
        return passing

    @property
    def false_alarm(self) -> Fraction:
        """The largest probability with which a correct statement fails the check."""
        return 1 - cumulative(self.trials, self.threshold, self.claimed)

    @property
    def passes(self) -> bool:
        return self.failures <= self.threshold

    @cached_property
    def upper(self) -> Fraction:
        """Clopper-Pearson upper limit of the failure probability, rounded up."""
        if self.failures == self.trials:
            return Fraction(1)
        grid = _first(lambda i: cumulative(self.trials, self.failures, Fraction(i, _GRID)) <= FALSE_ALARM)
        return Fraction(grid, _GRID)

    @cached_property
    def lower(self) -> Fraction:
        """Clopper-Pearson lower limit of the failure probability, rounded down."""
        if self.failures == 0:
            return Fraction(0)
        grid = _first(lambda i: 1 - cumulative(self.trials, self.failures - 1, Fraction(i, _GRID)) > FALSE_ALARM)
        return Fraction(grid - 1, _GRID)

    @property
    def covered(self) -> bool:
        """Whether the confidence interval excludes failure probabilities above the claimed one."""
        return self.upper <= self.claimed

    def power(self, failure: Fraction) -> float:
        """The probability that a statement that really fails this often is caught."""
        return float(1 - cumulative(self.trials, self.threshold, failure))

    def outcome(self, name: str) -> Outcome:
        """The verdict with its numbers."""
        numbers = (
            f"{self.failures} failures in {self.trials} runs, claimed {float(self.claimed):g}, "
            f"Clopper-Pearson [{float(self.lower):.3g}, {float(self.upper):.3g}], more than {self.threshold} would "
            f"refute it (false alarm {float(self.false_alarm):.1e})"
        )
        if not self.passes:
            return Outcome(self.trials, (f"{name}: fails too often: {numbers}",))
        return Outcome(self.trials, details=f"{name}: {'covered' if self.covered else 'not contradicted'}: {numbers}")


def simulate(
    name: str, fails: Callable[[np.random.Generator], bool], claimed: Fraction, trials: int, seed: int
) -> Outcome:
    """Run an event independently ``trials`` times and judge it; the same seed gives the same verdict.

    >>> simulate("coin", lambda rng: rng.random() < 0.02, Fraction(1, 10), trials=200, seed=0).holds
    True
    >>> simulate("coin", lambda rng: rng.random() < 0.5, Fraction(1, 10), trials=200, seed=0).holds
    False
    """
    streams = np.random.default_rng(seed).spawn(trials)
    return Coverage(claimed, trials, sum(bool(fails(rng)) for rng in streams)).outcome(name)


def cumulative(trials: int, failures: int, chance: Fraction) -> Fraction:
    """P(Binomial(trials, chance) <= failures), exactly.

    >>> cumulative(2, 1, Fraction(1, 2))
    Fraction(3, 4)
    """
    p, q, base = chance.numerator, chance.denominator - chance.numerator, chance.denominator
    total, power = 0, q ** (trials - failures) if failures < trials else 1
    for k in range(min(failures, trials), -1, -1):
        total += comb(trials, k) * p**k * power
        power *= q
    return Fraction(total, base**trials)


def _mass(trials: int, k: int, chance: Fraction) -> Fraction:
    return comb(trials, k) * chance**k * (1 - chance) ** (trials - k)


def _first(holds: Callable[[int], bool]) -> int:
    """The smallest grid index from which a monotone property holds."""
    low, high = 0, _GRID
    while low < high:
        middle = (low + high) // 2
        if holds(middle):
            high = middle
        else:
            low = middle + 1
    return low
