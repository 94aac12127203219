"""When a formula may be evaluated: requirements of a theorem, and points where the paper's text has no value."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bridge_theory.errors import InputError, UndefinedInPaperError
from bridge_theory.parameters import show


@dataclass(frozen=True)
class Condition:
    """``holds`` takes some of the formula's parameters by name: exact numbers, object arrays of them, or tuples.

    It compares by ``<=``, ``>=`` or ``==`` and negates nothing, because it is first tried on floats that know their
    error, where a comparison holds if it certainly does; where one does not, the exact numbers decide.
    """

    holds: Callable[..., Any]
    text: str
    repaired: str | None = None

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the parameters that it takes."""
        return tuple(inspect.signature(self.holds).parameters)

    def check(self, name: str, given: Mapping[str, object]) -> None:
        """Raise the error of this condition if any of the given points violates it."""
        chosen = {key: given[key] for key in self.parameters}
        if np.all(self.holds(**chosen)):
            return
        point = ", ".join(f"{key} = {_shown(value)}" for key, value in chosen.items())
        if self.repaired is None:
            raise InputError(f"{name} at {point}: it requires {self.text}")
        raise UndefinedInPaperError(
            f"{name} at {point}: the paper's text has no value there ({self.text}); use {self.repaired} instead"
        )


def requires(holds: Callable[..., Any], text: str) -> Condition:
    """A hypothesis of the statement, checkable from the parameters; violated, it raises ``InputError``.

    >>> requires(lambda S: S >= 2, "at least two states").check("example", {"S": 3})
    """
    return Condition(holds, text)


def undefined_unless(holds: Callable[..., Any], reason: str, *, repaired: str) -> Condition:
    """A point where the paper's formula has no value; reached, it raises ``UndefinedInPaperError`` naming the repair.

    >>> undefined_unless(lambda S: S >= 2, "log 0", repaired="other").check("example", {"S": 2})
    """
    return Condition(holds, reason, repaired)


def _shown(value: object) -> str:
    if isinstance(value, np.ndarray) and value.size > 1:
        return f"{value.size} values from {show(value.min())} to {show(value.max())}"
    return show(value.item() if isinstance(value, np.ndarray) else value)  # type: ignore[arg-type]
