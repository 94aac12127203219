"""Ratios that grow without bound along a family, so that no hidden constant saves a statement of order."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from proofs_checks.outcome import Outcome, Tally


def _weights_vanish(sp: Any, T: Any, order: Any) -> Any:
    # one state, two actions, n = 22, B = 1/2, delta = 1/20, lambda = 1/8, W = 1/sqrt(T): 4 <= kappa <= 5. Both actions
    # stay for all T, as gamma_t >= 4 kappa sqrt(log 20) > 27 and 2W sqrt(kappa lambda + T) < 3: the regret is WT/2
    return T / 2 / ((sp.sqrt(sp.Rational(5, 2)) + sp.Rational(1, 2)) * sp.log(5 * T / 2) * sp.sqrt(order))


RATIOS: Mapping[str, Callable[[Any, Any], Any]] = {
    "known rate": lambda sp, x: _weights_vanish(sp, x, sp.log(1 + x / 22)),
    "large horizon": lambda sp, x: _weights_vanish(sp, x, sp.log(x)),
    "term 2": lambda sp, x: 2 * (sp.sqrt(x) - 1) / sp.log(1 + 10**6 * (sp.log(x) + x) / 4),
    "simplified rate": lambda sp, x: x ** sp.Rational(-1, 4) / (sp.sqrt(sp.log(1 + 100 / x)) + 1 / sp.sqrt(x)),
    "drift sum": lambda sp, x: x / 2 / sp.log(x),
    # S = 5, A = 4, H = 8, delta = 1/20: sqrt(n) times the radius is at least beta
    "offline radius": lambda sp, x: sp.sqrt(400 * sp.log(320 * x)),
    # T B/(kappa delta) = 1 + 1/x, so that Gamma is a constant times log(1 + 1/x), while the first round costs BW
    "vanishing scale": lambda sp, x: 1 / sp.log(1 + 1 / x),
    "squared bonuses": lambda sp, x: 4 * (x - 1) / (4 * sp.log(x)),
}
"""A lower bound on the ratio of both sides (for term 2: of their squares), in the variable of the family."""


def unbounded(*, family: str, divided: int = 0) -> Outcome:
    """The ratio of a family, divided by its variable to the power ``divided``, tends to infinity."""
    import sympy

    x = sympy.Symbol("x", positive=True)
    limit = sympy.limit(RATIOS[family](sympy, x) / x**divided, x, sympy.oo)
    tally = Tally()
    tally.expect(bool(limit == sympy.oo), f"the ratio of the family {family!r} tends to {limit}")
    return tally.outcome(f"{family}: the ratio tends to infinity")
