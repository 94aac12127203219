"""Entries of a session's record, each with its type, shape and range made sure of, or refused in one sentence."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from bridge_theory.errors import InputError
from proofs_checks.verify.enclosed import FloatArray
from proofs_checks.verify.features import IntArray

MOST = 10**7
"""Entries that a table may hold."""


def part(entries: Mapping[str, Any], name: str) -> dict[str, Any]:
    """A JSON object inside the record."""
    value = entries.get(name)
    if not isinstance(value, dict):
        raise InputError(f"{name} is {reprlib.repr(value)}, expected a JSON object.")
    return value


def text(entries: Mapping[str, Any], name: str) -> str:
    """A text."""
    value = entries.get(name)
    if not isinstance(value, str):
        raise InputError(f"{name} is {reprlib.repr(value)}, expected a text.")
    return value


def truth(entries: Mapping[str, Any], name: str) -> bool:
    """True or false."""
    value = entries.get(name)
    if not isinstance(value, bool):
        raise InputError(f"{name} is {reprlib.repr(value)}, expected true or false.")
    return value


def whole(entries: Mapping[str, Any], name: str, least: int = 0) -> int:
    """A whole number of ordinary size."""
    value = entries.get(name)
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= 10**9:
        raise InputError(f"{name} is {reprlib.repr(value)}, expected a whole number of at least {least}.")
    return value


def number(entries: Mapping[str, Any], name: str, low: float, high: float) -> float:
    """A finite number of a range."""
    value = entries.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise InputError(f"{name} is {reprlib.repr(value)}, expected a number from {low:g} to {high:g}.")
    return float(value)


def vector(value: Any, name: str, length: int) -> FloatArray:
    """A list of finite numbers."""
    good = isinstance(value, list) and len(value) == length
    if not good or any(isinstance(x, bool) or not isinstance(x, int | float) or not abs(x) <= 1e9 for x in value):
        raise InputError(f"{name} is {reprlib.repr(value)}, expected {length} finite numbers.")
    return np.array(value, dtype=np.float64)


def table(value: Any, name: str, width: int, choices: int) -> IntArray:
    """A list of at least one row of ``width`` whole numbers in 0..choices - 1."""
    if not isinstance(value, list) or not 0 < len(value) * width <= MOST:
        raise InputError(f"{name} is {reprlib.repr(value)}, expected a list of rows.")
    for row in value:
        if not isinstance(row, list) or len(row) != width or any(type(x) is not int for x in row):
            raise InputError(f"{name} has the row {reprlib.repr(row)}, expected {width} whole numbers.")
        if min(row) < 0 or max(row) >= choices:
            raise InputError(f"{name} has the row {reprlib.repr(row)}, expected numbers in 0..{choices - 1}.")
    return np.array(value, dtype=np.int64)


def close(name: str, found: float, expected: float, relative: float = 1e-9) -> None:
    """Refuse a number that is not what it must be, up to rounding."""
    if not abs(found - expected) <= relative * abs(expected):
        raise InputError(f"{name} is {found!r}, expected {expected!r}: the record contradicts itself.")


def same(name: str, found: Any, expected: Any) -> None:
    """Refuse an entry that is not what the rest of the record makes it."""
    if type(found) is not type(expected) or found != expected:
        raise InputError(f"{name} is {found!r}, expected {expected!r}: the record contradicts itself.")
