"""Floats, symbols and balls are three readings of one formula: they agree at random points of every formula."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st
from points import draw_point

from bridge_theory.arithmetic import flint_balls
from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.arithmetic.symbols import SYMBOLS
from bridge_theory.catalog import FORMULAS
from bridge_theory.enclosure import ball_arguments
from bridge_theory.parameters import parameter
from bridge_theory.symbolic import symbol_for

# a ball computed with 49 bits knows how far rounding can carry a 53-bit computation, cancellation included; the four
# bits of difference are for NumPy's log and exp, which may be off by a few units in the last place
_BITS_BELOW_FLOAT64 = 49
_UNDERFLOW = 1e-300  # below it float64 loses digits


@pytest.mark.parametrize("name", FORMULAS)
@given(data=st.data())
def test_ball_contains_the_float(name: str, data: st.DataObject) -> None:
    formula = FORMULAS[name]
    point = draw_point(data, formula)
    estimate = float(formula.estimate(**point))
    with flint_balls.working_precision(_BITS_BELOW_FLOAT64):
        ball = flint_balls.as_ball(formula(BALLS, **ball_arguments(formula.exact_arguments(point))))
        # the true value is within one radius of the midpoint, and the float within one radius of the true value, or
        # within its own last bit where the ball is exact
        reach = 2 * ball.rad() + abs(ball.mid()) * arb(2) ** -52
        assert arb(ball.mid(), reach).contains(arb(estimate)) or abs(ball) < _UNDERFLOW


@pytest.mark.parametrize("name", FORMULAS)
@settings(max_examples=2)
@given(data=st.data())
def test_ball_agrees_with_thirty_digits_of_the_symbols(name: str, data: st.DataObject) -> None:
    formula = FORMULAS[name]
    point = draw_point(data, formula)
    exact = formula.exact_arguments(point)
    # tables have no symbol to substitute, and at S = 1 or H = 1 branches must be taken exactly
    inside = {key: value for key, value in exact.items() if parameter(key).array or key in ("S", "H")}
    rest = {symbol_for(key): SYMBOLS.number(value) for key, value in exact.items() if key not in inside}
    digits = (SYMBOLS.number(0) + formula.expression(**inside)).evalf(35, subs=rest)
    with flint_balls.working_precision(400):
        ball = flint_balls.as_ball(formula(BALLS, **ball_arguments(exact)))
        distance = abs(ball - arb(str(digits)))
        assert distance <= abs(ball) * arb("1e-28") or distance <= arb("1e-60")


@pytest.mark.parametrize("name", FORMULAS)
@settings(max_examples=3)
@given(data=st.data())
def test_estimates_broadcast(name: str, data: st.DataObject) -> None:
    formula = FORMULAS[name]
    first, second = draw_point(data, formula), draw_point(data, formula)
    tables = {key: value for key, value in first.items() if parameter(key).array}
    second |= tables
    alone = np.array([formula.estimate(**first), formula.estimate(**second)])
    columns = {key: tables[key] if key in tables else np.array([first[key], second[key]]) for key in first}
    together = np.broadcast_to(formula.estimate(**columns), 2)
    np.testing.assert_allclose(together, alone, rtol=1e-13)
