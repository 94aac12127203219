"""Attacks on a statement: an endless stream of attempts, of which the best within a time budget is kept."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from proofs_checks.counterexample import Relation


@dataclass(frozen=True)
class Attempt:
    """One instance that was tried.

    Attributes:
        score: how near it comes to a violation, for showing progress: 1 is equality, more would be a violation.
        data: the instance as JSON data for the evaluator; empty where it is not worth keeping.
    """

    score: float
    data: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Search:
    """How to attack one inequality.

    Attributes:
        words: the statement under attack, LaTeX between dollars.
        kind: evaluator that certifies a violation of ``left relation right`` (LaTeX of the sides).
        attempts: from a generator of random numbers, an endless stream of attempts; it yields at least twice a second,
            also when nothing has improved.
    """

    words: str
    kind: str
    left: str
    relation: Relation
    right: str
    attempts: Callable[[np.random.Generator], Iterator[Attempt]]
