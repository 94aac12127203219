"""Points on the whole declared domain of any formula, corners included: what its float reading is held to."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any

from bridge_theory.errors import InputError
from bridge_theory.formula import Formula
from bridge_theory.parameters import COUNT, POSITIVE_INTEGER, Parameter, parameter

_LARGEST = {"n": 10**18, "T": 10**18, "t": 10**18, "H": 10**6, "N": 10**18, "counts": 10**18, "visits": 10**18}
_LARGEST_SIZE = 10**9  # states, actions, dimensions and the like
_CORNERS = (0, 1e-300, 1e-17, 1e-12, 0.25, 0.5, 1, 1 - 1e-12, 2, 4, 1e300)
_CELLS = 3


def _draw(row: Parameter, rng: random.Random) -> Any:
    return [_one(row, rng) for _ in range(_CELLS)] if row.array else _one(row, rng)


def _one(row: Parameter, rng: random.Random) -> Any:
    domain = row.domain
    if domain in (POSITIVE_INTEGER, COUNT):
        largest = _LARGEST.get(row.name, _LARGEST_SIZE)
        corners = [corner for corner in (0, 1, 2, largest) if domain.contains(corner)]
        return rng.choice(corners) if rng.random() < 0.4 else round(largest ** rng.random())
    if rng.random() < 0.4:
        return rng.choice([corner for corner in _CORNERS if domain.contains(corner)])
    if domain.high == 1:
        value = 10.0 ** -(rng.random() * rng.choice((2, 18, 300)))
        return value if rng.random() < 0.7 or not domain.contains(1 - value) else 1 - value
    return 10.0 ** (rng.choice((2, 6, 150)) * rng.uniform(-1, 1))


def extreme_points(formula: Formula, count: int) -> Iterator[dict[str, Any]]:
    """At most ``count`` points at which the formula is defined, always the same ones."""
    rng = random.Random(formula.name)
    for _ in range(20 * count):
        point = {name: _draw(parameter(name), rng) for name in formula.parameters}
        for smaller, larger in (("unvisited", "S"), ("singletons", "n"), ("t", "T")):
            if smaller in point and larger in point and rng.random() < 0.8:
                point[smaller] = min(point[smaller], point[larger])
        if formula.name == "transition_log_covering_two_states":
            point["S"] = 2
        try:
            formula.exact_arguments(point)
        except InputError:
            continue
        yield point
        count -= 1
        if count == 0:
            return
