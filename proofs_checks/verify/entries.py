"""Entries of a log, each read with its type, shape and range made sure of, or refused in one sentence."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge_theory.errors import InputError
from proofs_checks.verify.enclosed import FloatArray
from proofs_checks.verify.features import IntArray


def _shaped(
    arrays: Mapping[str, NDArray[Any]], name: str, shape: tuple[str | int, ...], size: Mapping[str, int]
) -> NDArray[Any]:
    if name not in arrays:
        raise InputError(f"the log lacks {name}; store it again with 'bridge-rl run --log'.")
    array = arrays[name]
    wanted = tuple(size.get(entry) if isinstance(entry, str) else entry for entry in shape)
    fits = array.ndim == len(shape) and array.size > 0
    if not fits or any(w is not None and w != n for w, n in zip(wanted, array.shape, strict=True)):
        words = ", ".join(str(entry if w is None else w) for entry, w in zip(shape, wanted, strict=True))
        raise InputError(f"the log's {name} has shape {array.shape}, expected ({words}).")
    return array


def floats(
    arrays: Mapping[str, NDArray[Any]],
    name: str,
    shape: tuple[str | int, ...],
    size: Mapping[str, int],
    missing: bool = False,
) -> FloatArray:
    """An array of finite float64.

    Args:
        shape: of each axis its length, or a letter: then ``size`` may fix the length, else any will do.
        missing: whether NaN is allowed too.
    """
    array = _shaped(arrays, name, shape, size)
    if array.dtype != np.float64:
        raise InputError(f"the log's {name} holds {array.dtype}, expected float64.")
    if not (np.isfinite(array) | (missing & np.isnan(array))).all() or (np.abs(np.nan_to_num(array)) > 1e100).any():
        raise InputError(f"the log's {name} holds entries that are not finite numbers of ordinary size.")
    return array


def integers(
    arrays: Mapping[str, NDArray[Any]], name: str, shape: tuple[str | int, ...], size: Mapping[str, int], choices: int
) -> IntArray:
    """An array of int64 in 0..choices - 1, of a shape as for :func:`floats`."""
    array = _shaped(arrays, name, shape, size)
    if array.dtype != np.int64:
        raise InputError(f"the log's {name} holds {array.dtype}, expected int64.")
    if array.min() < 0 or array.max() >= choices:
        raise InputError(f"the log's {name} holds {array.min()}..{array.max()}, expected 0..{choices - 1}.")
    return array


def check_probabilities(name: str, rows: FloatArray) -> None:
    """Refuse rows that are not probability vectors, up to the rounding that an MDP allows."""
    if rows.min() < 0 or np.abs(rows.sum(axis=-1) - 1).max() > 1e-9:
        raise InputError(f"the log's {name} holds rows that are not probability vectors.")


def json_object(header: Mapping[str, Any], name: str) -> dict[str, Any]:
    """A JSON object of the header."""
    value = header.get(name)
    if not isinstance(value, dict):
        raise InputError(f"the log's {name} is {reprlib.repr(value)}, expected a JSON object.")
    return value


def text(config: Mapping[str, Any], name: str) -> str:
    """A text of the configuration."""
    value = config.get(name)
    if not isinstance(value, str):
        raise InputError(f"the log's {name} is {reprlib.repr(value)}, expected a text.")
    return value


def count(entries: Mapping[str, Any], name: str, least: int = 1) -> int:
    """A whole number of ordinary size."""
    value = entries.get(name)
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= 10**9:
        raise InputError(f"the log's {name} is {reprlib.repr(value)}, expected a whole number of at least {least}.")
    return value


def number(entries: Mapping[str, Any], name: str, low: float = 1e-9, high: float = 1e9) -> Fraction:
    """A number, exactly."""
    value = entries.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise InputError(f"the log's {name} is {reprlib.repr(value)}, expected a number from {low:g} to {high:g}.")
    return Fraction(value)
