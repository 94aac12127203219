"""Named parts of a formula, so that a bound can say which of its terms dominates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Literal

from bridge_theory.arithmetic import Arithmetic, Value


@dataclass(frozen=True)
class Terms:
    """What a formula returns when its parts have names; combined by addition or by taking the smallest."""

    combine: Literal["sum", "min"]
    parts: Mapping[str, Value]


def total(**parts: Value) -> Terms:
    """The sum of named parts.

    Source: this package. Arguments: values of one arithmetic. Returns ``Terms``. Errors: none.

    >>> total(policy=1.0, transition=2.0).combine
    'sum'
    """
    return Terms("sum", parts)


def least(**parts: Value) -> Terms:
    """The smallest of named parts, each of which is a bound on its own.

    Source: this package. Arguments: values of one arithmetic. Returns ``Terms``. Errors: none.

    >>> least(trivial=2.0, elliptical=1.0).combine
    'min'
    """
    return Terms("min", parts)


def combined(m: Arithmetic, outcome: Value) -> Value:
    """The one number that a formula's outcome stands for."""
    if not isinstance(outcome, Terms):
        return outcome
    values = outcome.parts.values()
    return reduce(add, values) if outcome.combine == "sum" else m.min(*values)
