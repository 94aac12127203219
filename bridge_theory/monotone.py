"""Declared directions of a bound in its parameters, each with the reason that a reader can check."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal


@dataclass(frozen=True)
class Monotone:
    """How a bound moves when one parameter grows: weakly in one direction, where ``where`` holds of the others."""

    direction: Literal["rises", "falls"]
    because: str
    where: Callable[..., Any] | None = None

    def holds(self, values: Mapping[str, Any]) -> bool:
        """Whether the direction is claimed at these values of the other parameters."""
        if self.where is None:
            return True
        return bool(self.where(**{name: values[name] for name in inspect.signature(self.where).parameters}))


def rises(because: str, *, where: Callable[..., Any] | None = None) -> Monotone:
    """The bound does not decrease when the parameter grows; ``where`` restricts the other parameters, by name.

    >>> rises("cosh is even and convex").direction
    'rises'
    """
    return Monotone("rises", because, where)


def falls(because: str, *, where: Callable[..., Any] | None = None) -> Monotone:
    """The bound does not increase when the parameter grows; ``where`` restricts the other parameters, by name.

    >>> falls("log(x) / x falls for x > e").direction
    'falls'
    """
    return Monotone("falls", because, where)
