"""Random points in the domain of any formula: what the property tests draw from."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from hypothesis import assume
from hypothesis import strategies as st

from bridge_theory.errors import InputError
from bridge_theory.formula import Formula
from bridge_theory.parameters import Parameter, parameter

# beyond these the symbols take seconds (binomials) or every interpretation overflows (cosh)
_LARGEST = {"S": 12, "A": 8, "H": 40, "rows": 60, "d": 30, "unvisited": 12, "B": 4, "W": 4, "eta": 8}
_LARGEST_COUNT = 10**7
_CELLS = 4

ANSWERS: dict[str, Any] = {
    "loss": 5, "weight_norm": "0.5", "log_det_growth": 3, "evidence_loss": 9, "scales": 2, "margin": 1, "tangent": 2,
    "multiplier": "0.25", "slope": 1, "dual_norm": "0.125", "advantage": "0.5", "shortfall": "0.125", "slack": 4,
    "gradient_norm": 1, "reach": 1, "least_curvature": 2, "ridge": 1, "newton_norm": 1, "forecasters": 2,
    "rollouts": 200, "sample_variance": "0.25", "spread": 1, "candidates": 16, "error_norm": "0.125", "look": 2,
    "ellipsoid_radius": 3, "feature_reach": 1, "pairs": 3, "information": "0.125",
}  # fmt: skip
"""A value of every parameter that only the formulas about answers take."""


def _number(row: Parameter) -> st.SearchStrategy[Any]:
    low, high = row.domain.low, row.domain.high
    if row.domain.integer:
        cap = _LARGEST.get(row.name, _LARGEST_COUNT)
        top = cap if high is None else min(cap, int(high))
        small = st.integers(int(low), min(top, int(low) + 5))
        return small | st.integers(int(low), top)
    cap = _LARGEST.get(row.name, 1000)
    top = float(cap if high is None else min(cap, high))
    # multiples of 2^-20 are the same number for all three interpretations
    steps = st.integers(0, int(top * 2**20)).map(lambda k: k / 2**20)
    fine = st.integers(-20, 0).map(lambda k: 2.0**k).map(lambda x: x * top)
    signed = (steps | fine).flatmap(lambda x: st.sampled_from((x, -x))) if low < 0 else steps | fine
    return signed.filter(lambda x: row.domain.contains(Fraction(x)))


def numbers(name: str) -> st.SearchStrategy[Any]:
    """Values of one parameter; arrays have a fixed small number of cells."""
    row = parameter(name)
    if not row.array:
        return _number(row)
    return st.lists(_number(row), min_size=_CELLS, max_size=_CELLS)


def draw_point(data: st.DataObject, formula: Formula) -> dict[str, Any]:
    """A point at which the formula is defined."""
    point = {name: data.draw(numbers(name), label=name) for name in formula.parameters}
    try:
        formula.exact_arguments(point)
    except InputError:
        assume(False)
    return point
