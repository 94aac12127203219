r"""Ask and tell without a model of utility, for few items (companion G10).

:math:`p(i, j)` is the probability that a fresh draw of item i is preferred to a fresh draw of item j, shown in random
order. Nothing ties these numbers to each other: each pair has its own confidence sequence, at delta / (number of
pairs), see :mod:`bridge_algos.asking.stakes`.

>>> import numpy as np
>>> rng = np.random.default_rng(0)
>>> session = PairwiseSession(3, eps=0.2, delta=0.05, rng=rng)
>>> while not session.done:
...     question = session.ask()
...     session.tell(question, int(rng.random() < 0.9) if question.first < question.second else int(rng.random() < 0.1))
>>> session.recommended, session.certified
(0, True)
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log
from typing import Any

import numpy as np

from bridge_algos.asking.no_model_certificate import PairwiseCertificate
from bridge_algos.asking.stakes import excluded, lower_bound
from bridge_algos.mdp import FloatArray
from bridge_theory.errors import InputError

MOST_ITEMS = 50
"""Items that are compared, at most: every pair is asked about."""


@dataclass(frozen=True)
class PairQuestion:
    """Is a fresh draw of the first item better than one of the second?

    Args:
        number: 0, 1, ... in the order in which answers count.
        first, second: items, in random order.
    """

    number: int
    first: int
    second: int


class PairwiseSession:
    """One session without a model of utility, with one delta.

    Args:
        items: K, how many candidates or items; a question draws two of them afresh.
        eps: in (0, 1/2).
        delta: failure probability of the session.
        rng: the source of all randomness.

    Raises:
        InputError: for values out of range.
    """

    def __init__(self, items: int, eps: float, delta: float, rng: np.random.Generator) -> None:
        if isinstance(items, bool) or not isinstance(items, int | np.integer) or not 1 <= items <= MOST_ITEMS:
            raise InputError(
                f"items must be a whole number from 1 to {MOST_ITEMS}, got {items!r}; without a model every pair is "
                "asked about."
            )
        if not 0 < eps < 0.5:
            raise InputError(f"eps must lie strictly between 0 and 1/2, got {eps}.")
        if not 0 < delta < 1:
            raise InputError(f"delta must lie strictly between 0 and 1, got {delta}.")
        self.items, self.eps, self.delta, self.rng = int(items), float(eps), float(delta), rng
        self.won = np.zeros((self.items, self.items))
        self.level = log(max(self.items * (self.items - 1) / 2, 1) / self.delta)
        self.history: list[tuple[int, int, int | None]] = []
        self.contradiction: str | None = None
        self._fine = np.eye(self.items, dtype=bool)
        self._loses = np.zeros((self.items, self.items), dtype=bool)
        self._pending: PairQuestion | None = None

    @property
    def certified(self) -> bool:
        """Whether an item is known to be preferred to every other with probability at least 1/2 - eps."""
        return not self.contradicted and bool(self._fine.all(axis=1).any())

    @property
    def no_winner(self) -> bool:
        """Whether every item is known to lose to another one, beyond eps."""
        return not self.contradicted and bool(self._loses.any(axis=1).all())

    @property
    def contradicted(self) -> bool:
        """Whether the answers contradict that preferences stay the same; nothing is certified from then on."""
        return self.contradiction is not None

    @property
    def done(self) -> bool:
        """Whether there is nothing more to ask."""
        return self.contradicted or self.certified or self.no_winner

    @property
    def recommended(self) -> int:
        """The item that is certified, or else the one whose worst comparison looks best."""
        complete = self._fine.all(axis=1)
        worst = np.where(np.eye(self.items, dtype=bool), 1.0, self._shares()).min(axis=1)
        return int(np.where(complete, 2.0, np.where(self._loses.any(axis=1), worst - 1, worst)).argmax())

    def ask(self) -> PairQuestion:
        """The next question; the same one until it is told.

        The item asked about has the best prospects of winning, and its opponent is the most dangerous one.

        Raises:
            InputError: when nothing is left to ask.
        """
        if self.done:
            raise InputError(f"nothing is left to ask. {self.certificate.sentence}")
        if self._pending is None:
            n = self.won + self.won.T
            radius = np.sqrt(log(2 + len(self.history)) / (2 * n + 2))
            open_ = ~self._fine
            highest = np.where(open_, self._shares() + radius, np.inf).min(axis=1)
            item = self._any_of_the_best(np.where(self._loses.any(axis=1), -np.inf, highest))
            rival = self._any_of_the_best(np.where(open_[item], radius[item] - self._shares()[item], -np.inf))
            first, second = (item, rival) if self.rng.random() < 0.5 else (rival, item)
            self._pending = PairQuestion(len(self.history), first, second)
        return self._pending

    def tell(self, question: PairQuestion, answer: int | None) -> None:
        """Record the answer to the pending question: 1, the first is better; 0, the second; None, no answer.

        Raises:
            InputError: for another answer, or a question that is not the pending one.
        """
        if question is not self._pending:
            raise InputError("tell() takes the question that ask() gave last, once; ask again.")
        if answer is not None and (isinstance(answer, bool | float) or answer not in (0, 1)):
            raise InputError(f"the answer must be 1 (the first is better), 0 (the second) or None, got {answer!r}.")
        self._pending = None
        self.history.append((question.first, question.second, None if answer is None else int(answer)))
        if answer is None:
            return
        pair = (question.first, question.second) if answer else (question.second, question.first)
        self.won[pair] += 1
        for i, j in (pair, pair[::-1]):
            self._decide(i, j)

    @property
    def certificate(self) -> PairwiseCertificate:
        """What is certified now."""
        answers = int(self.won.sum())
        own = self.recommended
        others = [j for j in range(self.items) if j != own]
        least = min((lower_bound(self.won[own, j], self.won[j, own], self.level) for j in others), default=1.0)
        return PairwiseCertificate(
            certified=self.certified,
            no_winner=self.no_winner,
            recommended=own,
            least=max(least, 0.5 - self.eps) if self.certified and others else least,
            eps=self.eps,
            failure_probability=self.delta,
            answers=answers,
            skipped=len(self.history) - answers,
            items=self.items,
            contradiction=self.contradiction,
        )

    def record(self) -> dict[str, Any]:
        """What :meth:`restore` needs to go on later, as plain values for JSON."""
        history = [list(row) for row in self.history]
        return {"setting": self._setting(), "history": history, "generator": self.rng.bit_generator.state}

    def restore(self, record: dict[str, Any]) -> None:
        """Go on where a session with the same arguments stopped.

        Raises:
            InputError: for a record of another setting, or when this session has already asked.
        """
        if self.history:
            raise InputError("restore() must be called before the first question.")
        if not isinstance(record, dict) or record.get("setting") != self._setting():
            raise InputError("the record must come from a session with the same arguments; this one differs.")
        for first, second, answer in record["history"]:
            self._pending = PairQuestion(len(self.history), int(first), int(second))
            self.tell(self._pending, answer)
        self.rng.bit_generator.state = record["generator"]

    def _setting(self) -> dict[str, Any]:
        return {"model": "none", "items": self.items, "eps": self.eps, "delta": self.delta}

    def _shares(self) -> FloatArray:
        """(K, K) smoothed shares of answers for the row's item."""
        return np.asarray((self.won + 1) / (self.won + self.won.T + 2))

    def _any_of_the_best(self, scores: FloatArray) -> int:
        return int(self.rng.choice(np.flatnonzero(scores == scores.max())))

    def _decide(self, i: int, j: int) -> None:
        """Note which side of 1/2 - eps the probability p(i, j) is surely on."""
        threshold = 0.5 - self.eps
        won, lost = float(self.won[i, j]), float(self.won[j, i])
        if not excluded(threshold, won, lost, self.level):
            return
        (self._fine if won > threshold * (won + lost) else self._loses)[i, j] = True
        if self._fine[i, j] and self._loses[i, j]:
            self.contradiction = (
                f"these answers contradict that preferences stay the same: item {i} was preferred to item {j} with "
                f"probability above {threshold:.4g}, and later below; with steady preferences this happens with "
                f"probability at most {self.delta:g}"
            )
