r"""How to write a formula.

A formula is one ordinary function over an arithmetic ``m`` with keyword-only parameters from the one table
``bridge_theory.parameters``, decorated by ``@bound`` (or ``@rate`` for an O-tilde statement)::

    @bound(
        title="offline confidence-set radius",
        symbol=r"\mathrm{Radius}",
        source="thm:tabular_confidence_set",        # the label in the paper, or "audit T9"
        group="offline", status="stated",
        trivial=1,                                   # or: lambda m, B, W, T: 2 * B * W * T
        spends=("delta",),                           # failure probabilities used up; total = their sum, or failure=...
        words="the expert lies within Hellinger distance {value} of the cloned policy",
        assumptions=("the expert is deterministic and stationary",),
        conditions=(requires(lambda n, H: n * H >= 2, "n H >= 2"),),
        monotone={"n": falls("every term does"), "delta": falls("log(1/delta) does")},
    )
    def offline_radius(m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, ...) -> Value:
        '''Docstring: statement, source, assumptions, arguments, returns, errors, doctest.'''
        return total(policy=..., transition=...)     # named terms, added; least(a=..., b=...) takes the smallest

Conventions over ``m``:

- ``+ - * /`` and ``x**2`` work on values; two Python integers must not meet (``1 / 2`` is a float): write ``x / 2`` or
  ``m.number(Fraction(1, 2))``. No float literals, ever. ``m.power(m.number(2), -S)`` where the exponent is a value.
- ``m.sqrt, m.log, m.log1p, m.exp, m.expm1, m.cosh, m.sin, m.arcsin, m.arccos, m.pi()``, and three that
  lose no digits: ``m.log1p_ratio(x, y)``, ``m.one_minus_root(x, n)``, ``m.power_near_one(x, n)``.
- ``m.min(...)``, ``m.max(...)`` (integers allowed among the arguments), ``m.ceil(x)``.
- Branches: ``m.if_at_most(x, y, lambda: then, lambda: otherwise)`` is ``then`` where ``x <= y``; lambdas, because the
  other branch may have no value. An undecided ball encloses both.
- Sums over tables: an array parameter (``array=True`` in the table, e.g. ``counts``) is only used inside
  ``m.sum(lambda N: ..., counts)`` or ``m.sum(lambda w, N: ..., weights, counts)``.
- ``m.log_binomial(a, b)``; an infimum that is attained at an integer: ``m.minimum_over_integers``.
- An infimum over a real ``epsilon``: every ``epsilon`` gives a valid bound, so write the closed-form minimiser if
  there is one, otherwise make ``epsilon`` a parameter.
- One formula uses another by calling it with ``m``: ``offline_radius(m, S=S, ...)``.
- Where the paper's text has no value:
  ``conditions=(undefined_unless(lambda N: N >= 2, "log log 1", repaired="bonus_radius"),)``.
  Predicates take parameters by name, as exact numbers or float arrays: use ``&`` and ``|``, not ``and`` and ``or``.
- What a user may leave out is filled in by ``bridge_theory.defaults`` alone, and the words say so. A formula about a
  deterministic stationary expert lists ``DETERMINISTIC``: then ``rows`` and ``S_reach`` may be ``S``, else ``S A``.
- Intermediate quantities of a theorem are parameters (``R1``, ``radius``, ``epsilon``); add a missing one to the table.
- A minimum ``trivial`` is what one knows without the theorem. ``status``: ``stated`` is the paper's text to the letter,
  ``repaired`` the nearest statement that is proved, ``sharp`` the best that is proved.
"""

from __future__ import annotations

from bridge_theory.arithmetic import Arithmetic, Value
from bridge_theory.bound import Bound, Rate, bound, rate
from bridge_theory.conditions import requires, undefined_unless
from bridge_theory.monotone import falls, rises
from bridge_theory.terms import least, total

__all__ = [
    "Arithmetic",
    "Bound",
    "Rate",
    "Value",
    "bound",
    "falls",
    "least",
    "rate",
    "requires",
    "rises",
    "total",
    "undefined_unless",
]
