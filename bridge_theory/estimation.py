"""The float64 reading of a formula: fast where rounding does no harm, by balls where it might."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.arithmetic.protocol import FloatArray
from bridge_theory.arithmetic.tracked import TRACKED, Tracked, inexact
from bridge_theory.enclosure import Enclosure, ball_arguments, enclose
from bridge_theory.parameters import Stored, parameter, to_exact

if TYPE_CHECKING:
    from bridge_theory.conditions import Condition
    from bridge_theory.formula import Formula

_TRUSTED = 1e-11  # the relative error up to which a float is taken as it is
_SMALLEST_NORMAL = 2.0**-1022  # below it float64 has fewer digits, and what is lost there is not told apart from 0
_EXACT_INTEGERS = 2**53
_BLOCK = 2**14  # points of a long row that are worked on at a time


def estimated(formula: Formula, values: Mapping[str, object], floats: Mapping[str, FloatArray]) -> Any:
    """The value in float64, right to ten digits: infinite where the true value is, nan where there is none.

    Below 1e-307, where float64 itself has fewer digits, it may be 0.

    Points at which the running error analysis finds more than rounding noise are evaluated in balls, at the exact
    numbers that were given. Arguments: a formula, what the user passed, and the same as validated float64.
    """
    tracked = {name: _tracked(name, values[name], floats[name]) for name in floats}
    with np.errstate(all="ignore"):  # branches that are not taken may overflow
        at, off = _in_blocks(formula, tracked)
        trusted = np.isfinite(at) & (off <= _TRUSTED * np.abs(at) + _SMALLEST_NORMAL)
    if np.all(trusted):
        return at
    scalars = [name for name in floats if not parameter(name).array]
    shape = np.broadcast_shapes(np.shape(at), *(np.shape(floats[name]) for name in scalars))
    result = np.array(np.broadcast_to(at, shape), dtype=np.float64)
    exact = exact_points(values, floats)
    for index in zip(*np.nonzero(np.atleast_1d(~np.broadcast_to(trusted, shape))), strict=True):
        place = index if shape else ()
        point = {name: _at(exact[name], name, shape, place) for name in exact}
        result[place] = _nearest(enclose(lambda point=point: formula(BALLS, **ball_arguments(point))))  # type: ignore[misc]
    return result[()]


def _in_blocks(formula: Formula, tracked: Mapping[str, Tracked]) -> tuple[Any, Any]:
    """The formula's floats and their errors; long rows of points are worked on in blocks that fit into the cache."""
    shapes = {np.shape(item.at) for item in tracked.values()} - {()}
    length = next(iter(shapes))[0] if len(shapes) == 1 and len(next(iter(shapes))) == 1 else 0
    if length <= _BLOCK or any(parameter(name).array for name in tracked):
        return _parts(formula(TRACKED, **tracked))
    at, off = np.empty(length), np.empty(length)
    for start in range(0, length, _BLOCK):
        block = slice(start, start + _BLOCK)
        part = {name: Tracked(_sliced(item.at, block), _sliced(item.off, block)) for name, item in tracked.items()}
        at[block], off[block] = _parts(formula(TRACKED, **part))
    return at, off


def _parts(outcome: Any) -> tuple[Any, Any]:
    return (outcome.at, outcome.off) if isinstance(outcome, Tracked) else (outcome, 0.0)


def _sliced(values: Any, block: slice) -> Any:
    return values if np.ndim(values) == 0 else values[block]


def certainly_holds(condition: Condition, values: Mapping[str, object], floats: Mapping[str, FloatArray]) -> bool:
    """Whether floats that know their error are enough to see that a condition on scalars holds at every point."""
    if any(parameter(name).array for name in condition.parameters):
        return False
    with np.errstate(all="ignore"):
        tracked = {name: _tracked(name, values[name], floats[name]) for name in condition.parameters}
        return bool(np.all(condition.holds(**tracked)))


def exact_points(values: Mapping[str, object], floats: Mapping[str, FloatArray]) -> dict[str, Any]:
    """What was passed as exact numbers: scalars, object arrays of them, and tuples for array parameters."""
    return {name: _exact(name, value, floats[name]) for name, value in values.items()}


def _exact(name: str, value: object, floats: FloatArray) -> Any:
    if parameter(name).array:
        return parameter(name).exact(value)  # type: ignore[arg-type]
    if np.ndim(floats) == 0:
        return to_exact(name, value[()] if isinstance(value, np.ndarray) else value)
    if parameter(name).domain.integer and np.all(floats <= _EXACT_INTEGERS):
        return floats.astype(np.int64).astype(object)
    return np.frompyfunc(lambda entry: to_exact(name, entry), 1, 1)(np.asarray(value, dtype=object))


def _at(exact: Any, name: str, shape: tuple[int, ...], place: tuple[Any, ...]) -> Stored:
    if parameter(name).array or not isinstance(exact, np.ndarray):
        return exact  # type: ignore[no-any-return]
    return np.broadcast_to(exact, shape)[place]  # type: ignore[no-any-return]


def _tracked(name: str, value: object, floats: FloatArray) -> Tracked:
    """The floats with their distance from what was passed: 0 for floats and for integers that float64 holds."""
    kind = np.asarray(value).dtype.kind
    if kind in "fb" or (kind in "iu" and np.all(np.abs(floats) <= _EXACT_INTEGERS)):
        return Tracked(floats)
    if np.ndim(floats) == 0:
        return inexact(floats, to_exact(name, value))
    exact = [to_exact(name, entry) for entry in np.asarray(value, dtype=object).ravel().tolist()]
    off = [inexact(at, number).off for at, number in zip(np.ravel(floats).tolist(), exact, strict=True)]
    return Tracked(floats, np.reshape(off, np.shape(floats)))


def _nearest(enclosure: Enclosure) -> float:
    lower, upper = enclosure.lower, enclosure.upper
    if math.isinf(lower) or math.isinf(upper):
        return math.nan if math.isinf(lower) and math.isinf(upper) else lower if math.isinf(lower) else upper
    if not enclosure.narrow and Fraction(upper) - Fraction(lower) > Fraction(_TRUSTED) * abs(Fraction(lower)):
        return math.nan
    return enclosure.middle
