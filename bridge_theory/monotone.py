"""Declared directions of a bound in its parameters, each with the reason that a reader can check."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Monotone:
    """How a bound moves when one parameter grows and the others stay: weakly in the given direction, everywhere."""

    direction: Literal["rises", "falls"]
    because: str


def rises(because: str) -> Monotone:
    """The bound does not decrease when the parameter grows.

    >>> rises("cosh is even and convex").direction
    'rises'
    """
    return Monotone("rises", because)


def falls(because: str) -> Monotone:
    """The bound does not increase when the parameter grows.

    >>> falls("log(x) / x falls for x > e").direction
    'falls'
    """
    return Monotone("falls", because)
