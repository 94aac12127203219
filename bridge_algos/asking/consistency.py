r"""Check questions: a certificate is issued only after answers that could have contradicted the model.

The questions that decide need not show a wrong model. Three items preferred in a cycle are an example: two of their
pairs decide, and only the third pair tells. So once the goal is reached, questions follow whose answers the other
answers predict most surely; the certificate waits until LEAD more of them agree than not. After LAG more that do not
agree, predictions are made anew, with these answers in the fit, and LEAD_AGAIN is needed. Answers to check questions
count as all others do, in the likelihood and in the test of the model.

This is a heuristic, which gives the test of the model something to see; the guarantee does not rest on it. Of answers
that contradict a prediction with probability c > 1/2 each, :math:`((1 - c) / c)^{LEAD}` is the chance to pass before
the predictions are made anew, at most.
"""

from __future__ import annotations

import numpy as np
from scipy.special import expit

from bridge_algos.mdp import FloatArray, IntArray

LEAD, LAG, LEAD_AGAIN = 2, 4, 4
"""How many more answers must agree than not; after how many more that do not predictions are made anew; and the lead
that is needed from then on."""

NEARLY = 0.2
"""Of the pairs that are predicted this nearly as surely as the surest, one that was asked about least is chosen."""

FEW = 100
"""Items that check questions are chosen from, besides those that were shown."""

STEPS = 20
"""Of Newton's method, each of which changes no log odds by more than 2."""


class Consistency:
    """The check questions of one session.

    Args:
        pool: (M, d) features of the items that questions show.
        groups: (M,) items of equal features share a number.
        precision: of a normal prior on the weights, for predictions.
        fresh: whether the same pair asked again is a fresh draw.

    >>> pool = np.array([[0.0], [1.0], [2.0]])
    >>> check = Consistency(pool, np.arange(3), precision=0.1, fresh=True)
    >>> for _ in range(5):
    ...     check.tell(1, 0, 1)
    >>> check.prepare(reached=True)
    >>> check.question, check.passed
    ((0, 2), False)
    >>> for _ in range(2):
    ...     check.tell(0, 2, 0)
    >>> check.prepare(reached=True)
    >>> check.passed
    True
    """

    def __init__(self, pool: FloatArray, groups: IntArray, precision: float, fresh: bool) -> None:
        _, self._items = np.unique(groups, return_index=True)
        self._pool, self._groups, self._precision, self._fresh = pool, groups, precision, fresh
        count = len(self._items)
        self._known = set(np.linspace(0, count - 1, min(FEW, count)).astype(np.int64).tolist())
        self._place: dict[int, int] = {}
        self._won: dict[tuple[int, int], int] = {}
        self._skipped: set[tuple[int, int]] = set()
        self._odds: FloatArray | None = None
        self.question: tuple[int, int] | None = None
        self.agreed = self.contrary = self.lead = 0
        self.needed = LEAD

    @property
    def passed(self) -> bool:
        """Whether a certificate may be issued: enough answers agree, or nothing is left to ask."""
        return self._odds is not None and (self.lead >= self.needed or self.question is None)

    def tell(self, first: int, second: int, answer: int | None) -> None:
        """Count the answer to a question about items of the pool; it is a check question once predictions are made."""
        a, b = int(self._groups[first]), int(self._groups[second])
        self._known |= {a, b}
        if answer is None:
            self._skipped |= {(a, b), (b, a)}
            return
        won = (a, b) if answer else (b, a)
        self._won[won] = self._won.get(won, 0) + 1
        if self._odds is None or not {a, b} <= self._place.keys():
            return
        agrees = bool(self._odds[self._place[won[0]], self._place[won[1]]] > 0)
        self.agreed, self.contrary = self.agreed + agrees, self.contrary + (not agrees)
        self.lead += 1 if agrees else -1
        if self.lead <= -LAG:
            self.lead, self.needed, self._odds = 0, LEAD_AGAIN, None

    def prepare(self, reached: bool) -> None:
        """Choose the next check question, where the goal is reached; where it is not, predictions end."""
        if not reached:
            self._restart()
        elif not self.passed:
            if self._odds is None:
                self._odds = self._predicted()
            sure, times = np.abs(self._odds), self._counts()
            if not self._fresh:
                for a, b in (*self._won, *self._skipped):
                    sure[self._place[a], self._place[b]] = sure[self._place[b], self._place[a]] = 0.0
            sure = np.where(sure < NEARLY * sure.max(), 0.0, sure / (1e3 * (times + times.T) + 1))
            first, second = divmod(int(sure.argmax()), len(sure))
            items = self._items[list(self._place)]
            asked = int(items[first]), int(items[second])
            self.question = asked if sure[first, second] > 1e-9 else None

    def _restart(self) -> None:
        self.agreed = self.contrary = self.lead = 0
        self.needed, self.question, self._odds = LEAD, None, None

    def _counts(self) -> FloatArray:
        """(G, G) how often the first was preferred to the second."""
        won = np.zeros((len(self._place),) * 2)
        for (a, b), times in self._won.items():
            won[self._place[a], self._place[b]] = times
        return won

    def _predicted(self) -> FloatArray:
        """(G, G) for each pair the log odds that the answers to all other pairs make likely.

        Pairs that were never asked about serve. Where there are none, each pair is predicted without its own answers.
        """
        self._place = {kind: place for place, kind in enumerate(sorted(self._known))}
        kinds, won = self._pool[self._items[list(self._place)]], self._counts()
        new = (won + won.T == 0) & ~np.eye(len(kinds), dtype=bool)
        if new.any():
            mean, covariance = _fitted(kinds, won, self._precision)
            utilities, y = kinds @ mean, kinds @ np.linalg.cholesky(covariance)
            norms = np.vecdot(y, y)
            spread = np.maximum(norms[:, None] + norms[None] - 2 * (y @ y.T), 0.0)
            return np.where(new, (utilities[:, None] - utilities[None]) / np.sqrt(1 + np.pi * spread / 8), 0.0)
        odds = np.zeros_like(won)
        for i, j in zip(*np.triu_indices(len(kinds), 1), strict=True):
            rest = won.copy()
            rest[i, j] = rest[j, i] = 0.0
            mean, covariance = _fitted(kinds, rest, self._precision)
            x = kinds[i] - kinds[j]
            odds[i, j] = x @ mean / np.sqrt(1 + np.pi * (x @ covariance @ x) / 8)
        return np.asarray(odds - odds.T)


def _fitted(items: FloatArray, won: FloatArray, precision: float) -> tuple[FloatArray, FloatArray]:
    """The likeliest weights under a normal prior, by damped Newton steps, and the inverse curvature there."""
    first, second = np.nonzero(np.triu(won + won.T))
    x, ones, zeros = items[first] - items[second], won[first, second], won[second, first]
    mean = np.zeros(items.shape[1])
    for _ in range(STEPS):
        p = expit(x @ mean)
        curvature = (x.T * ((ones + zeros) * p * (1 - p))) @ x + precision * np.eye(len(mean))
        step = np.linalg.solve(curvature, x.T @ (ones - (ones + zeros) * p) - precision * mean)
        mean = mean + step * min(1.0, 2.0 / max(float(np.abs(x @ step).max(initial=0.0)), 1e-12))
    return mean, np.linalg.inv(curvature)
