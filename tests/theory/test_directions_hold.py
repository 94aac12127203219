"""Every declared direction holds between random pairs of points, by certified enclosures."""

from __future__ import annotations

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from points import draw_point, numbers

from bridge_theory.bound import Bound
from bridge_theory.catalog import all_bounds
from bridge_theory.errors import InputError

_DIRECTIONS = [(bound, name) for bound in all_bounds() for name in bound.monotone]


@pytest.mark.parametrize(("bound", "name"), _DIRECTIONS, ids=[f"{bound.name}-{name}" for bound, name in _DIRECTIONS])
@settings(max_examples=8)
@given(data=st.data())
def test_direction(bound: Bound, name: str, data: st.DataObject) -> None:
    point = draw_point(data, bound)
    other = {**point, name: data.draw(numbers(name))}
    low, high = sorted((point, other), key=lambda values: values[name])
    assume(bound.monotone[name].holds(low))
    try:
        at_low, at_high = bound.enclosure(**low), bound.enclosure(**high)
    except InputError:
        assume(False)
    if bound.monotone[name].direction == "falls":
        at_low, at_high = at_high, at_low
    assert at_low.lower <= at_high.upper
