"""The answers as what the likelihood sees: distinct differences of features with counts of answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from bridge_theory.errors import InputError
from proofs_checks.asking_checker.entries import MOST
from proofs_checks.verify.enclosed import FloatArray
from proofs_checks.verify.features import IntArray


@dataclass(frozen=True, eq=False)
class Log:
    """Questions that were answered, in order.

    Args:
        differences: (m, d) distinct x, whole numbers, one orientation each.
        rows: (T,) which of them each question showed.
        answers: (T,) 1 or 0, in that orientation.
        skipped: questions without an answer.
        pairs, said: (T, 2) items of the pool, and (T,) answers, as they are written.
    """

    differences: IntArray
    rows: IntArray
    answers: IntArray
    skipped: int
    pairs: IntArray
    said: IntArray

    @property
    def x(self) -> FloatArray:
        """(m, d) the differences as floats, exactly."""
        return self.differences.astype(np.float64)

    def counts(self, until: int | None = None) -> tuple[IntArray, IntArray]:
        """(m,) how often the first ``until`` answers were 1, and 0."""
        rows, answers = self.rows[:until], self.answers[:until]
        ones = np.bincount(rows[answers == 1], minlength=len(self.differences))
        return ones, np.bincount(rows[answers == 0], minlength=len(self.differences))


def read_log(questions: Any, pool: IntArray, person: bool) -> Log:
    """The log of a list of [first, second, answer].

    Args:
        pool: (M, d) features of the trajectories.
        person: whether the same pair must not be asked twice.

    Raises:
        InputError: for a malformed question, trajectories of equal features, or a pair asked again.
    """
    if not isinstance(questions, list) or len(questions) > MOST:
        raise InputError("questions must be a list of [first, second, answer].")
    for number, row in enumerate(questions):
        good = isinstance(row, list) and len(row) == 3 and type(row[0]) is type(row[1]) is int
        good = good and all(0 <= item < len(pool) for item in row[:2])
        if not good or not (row[2] is None or (type(row[2]) is int and row[2] in (0, 1))):
            raise InputError(f"question {number} must be [first, second, answer] with indices of the pool.")
    pairs = np.array([row[:2] for row in questions], dtype=np.int64).reshape(-1, 2)
    x = pool[pairs[:, 0]] - pool[pairs[:, 1]]
    if len(x) and not x.any(axis=1).all():
        raise InputError(f"question {int(np.flatnonzero(~x.any(axis=1))[0])} compares equal features.")
    if person and len(np.unique(np.sort(pairs, axis=1), axis=0)) < len(pairs):
        raise InputError("a pair was asked twice of a person, who remembers: the second answer is no fresh draw.")
    answered = np.array([row[2] is not None for row in questions], dtype=bool)
    answers = np.array([row[2] for row in questions if row[2] is not None], dtype=np.int64)
    return _distinct(x[answered], answers, int((~answered).sum()), pairs[answered])


def _distinct(x: IntArray, answers: IntArray, skipped: int, pairs: IntArray) -> Log:
    if not len(x):
        return Log(x, np.zeros(0, dtype=np.int64), answers, skipped, pairs, answers)
    leading = np.take_along_axis(x, (x != 0).argmax(axis=1)[:, None], axis=1)[:, 0]
    turned = leading < 0
    differences, rows = np.unique(np.where(turned[:, None], -x, x), axis=0, return_inverse=True)
    return Log(differences, rows.ravel(), np.where(turned, 1 - answers, answers), skipped, pairs, answers)
