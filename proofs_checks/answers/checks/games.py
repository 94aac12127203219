"""Games of questions and answers in rational arithmetic: every asker and every stopping rule at once.

Odds of an answer are products of whole numbers, so that utilities are logarithms of rationals and a Bradley-Terry
teacher answers with rational chances. What happens depends on the counts of answers alone, so that the worst asker is
found by a dynamic programme over counts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import factorial, prod

Counts = tuple[int, ...]
"""Answers 1 and 0 to the first question, then to the second, and so on."""


@dataclass(frozen=True)
class Game:
    """Weights as odds of each feature, questions and candidates as whole-number features, all with a prior.

    The odds of an answer 1 to question ``x`` under weights ``r`` are ``prod r_j ** x_j``.
    """

    weights: tuple[tuple[Fraction, ...], ...]
    questions: tuple[tuple[int, ...], ...]
    policies: tuple[tuple[int, ...], ...]

    def odds(self, k: int, features: tuple[int, ...]) -> Fraction:
        """The exponential of the utility of the features under weights ``k``."""
        return prod((r**power for r, power in zip(self.weights[k], features, strict=True)), start=Fraction(1))

    def chance(self, k: int, question: int) -> Fraction:
        """The probability of the answer 1 under weights ``k``."""
        odds = self.odds(k, self.questions[question])
        return odds / (1 + odds)

    def likelihood(self, k: int, counts: Counts) -> Fraction:
        """The probability of these answers, in any one order, under weights ``k``."""
        pairs = ((self.chance(k, x), counts[2 * x], counts[2 * x + 1]) for x in range(len(self.questions)))
        return prod((p**ones * (1 - p) ** zeros for p, ones, zeros in pairs), start=Fraction(1))

    def mixture(self, counts: Counts) -> Fraction:
        """The evidence under the uniform prior on the weights."""
        total = sum((self.likelihood(k, counts) for k in range(len(self.weights))), Fraction(0))
        return total / len(self.weights)

    def best(self, counts: Counts) -> Fraction:
        """The largest likelihood, which is what a choice after the answers takes for the evidence."""
        return max(self.likelihood(k, counts) for k in range(len(self.weights)))


GAME = Game(
    weights=tuple(
        tuple(map(Fraction, row)) for row in (("1", "1"), ("4", "1"), ("1/3", "3"), ("3", "1/4"), ("1/2", "1/2"))
    ),
    questions=((1, 0), (1, 1)),
    policies=((0, 0), (1, 0), (0, 1), (1, -1)),
)
"""Five weight vectors, two questions and four candidates in two dimensions."""


def states(game: Game, depth: int) -> Iterator[Counts]:
    """All counts of fewer than ``depth`` answers."""

    def extend(slots: int, left: int) -> Iterator[Counts]:
        if slots == 0:
            yield ()
            return
        for used in range(left + 1):
            yield from ((used, *rest) for rest in extend(slots - 1, left - used))

    return extend(2 * len(game.questions), depth - 1)


def answered(counts: Counts, question: int, answer: int) -> Counts:
    """The counts after one more answer."""
    place = 2 * question + (1 - answer)
    return (*counts[:place], counts[place] + 1, *counts[place + 1 :])


def worst_chance(chances: tuple[Fraction, ...], depth: int, bad: Callable[[Counts], bool]) -> Fraction:
    """The largest probability with which any asker ever reaches bad counts within ``depth`` answers.

    >>> worst_chance((Fraction(1, 3),), 2, lambda counts: counts[1] == 2)
    Fraction(4, 9)
    """

    @cache
    def value(counts: Counts) -> Fraction:
        if bad(counts):
            return Fraction(1)
        if sum(counts) == depth:
            return Fraction(0)
        return max(
            p * value(answered(counts, x, 1)) + (1 - p) * value(answered(counts, x, 0)) for x, p in enumerate(chances)
        )

    return value((0,) * (2 * len(chances)))


def tables(counts: Counts) -> Fraction:
    """What a forecaster with one table of answers a question (Laplace's rule) gave these answers."""
    pairs = zip(counts[::2], counts[1::2], strict=True)
    return prod(
        (Fraction(factorial(ones) * factorial(zeros), factorial(ones + zeros + 1)) for ones, zeros in pairs),
        start=Fraction(1),
    )
