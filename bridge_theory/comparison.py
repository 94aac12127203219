"""Is one expression at most another? Decided in balls at exact numbers, so that a condition never hangs on rounding."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.arithmetic.protocol import Value
from bridge_theory.arithmetic.tracked import TRACKED, Tracked
from bridge_theory.enclosure import ball_arguments, enclose
from bridge_theory.errors import InputError
from bridge_theory.parameters import Exact, to_exact


def at_most(sides: Callable[..., tuple[Value, Value]], **points: Any) -> Any:
    """Whether the first of ``sides(m, **point)`` is at most the second, for exact numbers or object arrays of them.

    Of floats that know their error it tells whether it certainly is. Returns a truth value or an array of them.
    Errors: ``InputError`` where the highest precision does not tell.

    >>> from fractions import Fraction
    >>> at_most(lambda m, x: (x, m.exp(m.number(-1))), x=Fraction(3, 8))
    False
    """
    if any(isinstance(point, Tracked) for point in points.values()):
        left, right = sides(TRACKED, **points)
        return left <= right  # certainly

    def difference(point: Mapping[str, Exact]) -> Value:
        left, right = sides(BALLS, **ball_arguments(point))
        return left - right

    def holds(*point: object) -> bool:
        exact = {name: to_exact(name, value) for name, value in zip(points, point, strict=True)}
        gap = enclose(lambda: difference(exact))
        if gap.lower > 0 or gap.upper <= 0:
            return gap.upper <= 0
        raise InputError("a condition is too close to its threshold to be decided; move a parameter away from it")

    decided = np.frompyfunc(holds, len(points), 1)(*points.values())
    return decided if isinstance(decided, np.ndarray) else bool(decided)
