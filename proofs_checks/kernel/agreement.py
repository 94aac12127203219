"""That floats and generated definitions agree: at two points each, to twelve digits, by the tactic ``interval``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from fractions import Fraction
from functools import cache
from typing import Any

from bridge_theory.arithmetic.balls import Balls
from bridge_theory.arithmetic.coq_terms import CoqTerms
from bridge_theory.arithmetic.flint_balls import as_ball, working_precision
from bridge_theory.arithmetic.protocol import Value
from bridge_theory.catalog import FORMULAS
from bridge_theory.enclosure import ball_arguments
from bridge_theory.formula import Formula
from bridge_theory.parameters import parameter

_FILES = 4
_DIGITS = Fraction(1, 10**12)
POINTS: tuple[Mapping[str, Any], ...] = (
    {
        "S": 2, "A": 3, "H": 4, "d": 2, "B": 1, "W": "1/2", "n": 50, "T": 20, "t": 5, "gamma_min": "1/10", "rows": 6,
        "unvisited": 1, "counts": [4, 7], "visits": [3, 5], "occupancy_hat": ["1/2", "1/4"],
        "row_errors": ["1/10", "1/20"], "singletons": 3, "R": "1/10", "R1": "1/20", "R2": "1/30", "radius": "1/2",
        "mass": "1/9", "class_size": 8, "log_covering": 3, "epsilon": "1/2", "chi2": "1/7", "C": 2, "kl": "1/3",
        "exit_mass": "1/5", "ratio": "1/4", "lam": 1, "K": 2, "N": 9, "eta": 2, "occupancy": ["3/2", "1/2"],
        "log_det_ratio": 3, "residual": "1/10", "gamma": 2, "L": 1, "v": 1, "square_sum": 5, "norm_sum": 3,
        "width_sum": 4, "bonus_sum": 2, "potential": 2, "bonus_square_sum": 3, "true_bonus": "1/2", "optimism": "1/3",
        "norm": "3/2", "diameter": "2/3", "Delta_n": "1/6", "S_reach": 2, "uncovered": 1, "loss": 5,
        "weight_norm": "1/2", "log_det_growth": 3, "evidence_loss": 9, "scales": 2, "margin": 1, "tangent": 2,
        "multiplier": "1/4", "slope": 1, "dual_norm": "1/8", "advantage": "1/2", "shortfall": "1/8", "slack": 4,
        "gradient_norm": 1, "reach": 1, "least_curvature": 2, "ridge": 1, "newton_norm": 1, "forecasters": 2,
        "rollouts": 200, "sample_variance": "1/4", "spread": 1, "candidates": 16, "error_norm": "1/8", "look": 2,
        "ellipsoid_radius": 3, "feature_reach": 1, "pairs": 3, "information": "1/8",
    },
    {
        "S": 3, "A": 2, "H": 3, "d": 3, "B": "3/4", "W": 1, "n": 80, "T": 30, "t": 7, "gamma_min": "1/5", "rows": 3,
        "unvisited": 2, "counts": [2, 3], "visits": [2, 6], "occupancy_hat": ["1/3", "1/3"],
        "row_errors": ["1/5", "1/8"], "singletons": 5, "R": "1/4", "R1": "1/10", "R2": "1/8", "radius": "1/3",
        "mass": "1/16", "class_size": 5, "log_covering": 2, "epsilon": "1/3", "chi2": "1/9", "C": 3, "kl": "1/2",
        "exit_mass": "1/8", "ratio": "1/3", "lam": 2, "K": 3, "N": 12, "eta": 1, "occupancy": ["2/3", "4/3"],
        "log_det_ratio": 2, "residual": "1/5", "gamma": 3, "L": 2, "v": 2, "square_sum": 7, "norm_sum": 2,
        "width_sum": 3, "bonus_sum": 1, "potential": 3, "bonus_square_sum": 2, "true_bonus": "1/4", "optimism": "1/2",
        "norm": "5/2", "diameter": "1/3", "Delta_n": "1/7", "S_reach": 3, "uncovered": 2, "loss": 4,
        "weight_norm": "1/3", "log_det_growth": 2, "evidence_loss": 7, "scales": 3, "margin": -1, "tangent": 1,
        "multiplier": "1/2", "slope": "1/2", "dual_norm": "1/4", "advantage": "1/3", "shortfall": "1/4", "slack": 2,
        "gradient_norm": "1/2", "reach": 2, "least_curvature": 3, "ridge": 2, "newton_norm": "1/2", "forecasters": 3,
        "rollouts": 100, "sample_variance": "1/8", "spread": 2, "candidates": 8, "error_norm": "1/4", "look": 3,
        "ellipsoid_radius": 2, "feature_reach": 2, "pairs": 6, "information": "1/4",
    },
)  # fmt: skip
"""A value of each parameter but the failure probabilities, which are 1/20 and 1/10."""

ELSEWHERE: Mapping[str, Mapping[str, Any]] = {"transition_log_covering_two_states": {"S": 2, "epsilon": "1/3"}}
"""Formulas that are not defined at one of the points, and what they take instead."""

_HEAD = """From Interval Require Import Tactic.
Require Import Reals List Lra Lia ZArith.
Require Import Bridge.Arithmetic Bridge.Formulas.
Import ListNotations.
Open Scope R_scope.

Ltac compared := first [lra | interval with (i_prec 80) | field_simplify; lra | split; field_simplify; lra].
Ltac integer x :=
  match x with
  | INR ?n => constr:(Z.of_nat n)
  | IZR ?z => z
  | ?a + ?b => let p := integer a in let q := integer b in constr:((p + q)%Z)
  | ?a - ?b => let p := integer a in let q := integer b in constr:((p - q)%Z)
  | ?a * ?b => let p := integer a in let q := integer b in constr:((p * q)%Z)
  end.
Ltac whole_numbers :=
  repeat match goal with |- context [whole ?x] =>
    let z := integer x in let n := eval compute in (Z.to_nat z) in
    replace (whole x) with n by (symmetry; apply whole_is; rewrite !INR_IZR_INZ; simpl; lra)
  end.
Ltac naturals := repeat match goal with |- context [INR ?n] =>
  let z := eval compute in (Z.of_nat n) in replace (INR n) with (IZR z) by (rewrite INR_IZR_INZ; reflexivity) end.
Ltac branches := repeat match goal with
  | |- context [if_at_most ?x ?y ?a ?b] =>
      first [rewrite (if_at_most_yes x y a b) by compared | rewrite (if_at_most_no x y a b) by compared]
  | |- context [Rmin ?x ?y] => first [rewrite (Rmin_left x y) by compared | rewrite (Rmin_right x y) by compared]
  | |- context [Rmax ?x ?y] => first [rewrite (Rmax_left x y) by compared | rewrite (Rmax_right x y) by compared]
  end.
Ltac round_up z := repeat match goal with |- context [ceiling ?x] =>
  rewrite (ceiling_is x z) by (split; compared) end.
Ltac binomials := unfold log_binomial; whole_numbers; repeat (rewrite C_step by lia); rewrite ?C_zero; naturals.
Ltac arcs := repeat match goal with
  | |- context [asin ?x] => rewrite (asin_atan x) by (split; compared)
  | |- context [acos ?x] => rewrite (acos_atan x) by compared
  end; unfold Rsqr.
Ltac agree := unfold cosh, Rpower; interval with (i_prec 90).
"""


@cache
def generated() -> dict[str, str]:
    """The sources of the comparisons by file name without ``.v``."""
    names = [name for name in FORMULAS if name not in exceptions()]
    return {
        f"Agreement{part}": "\n".join(
            [_HEAD, *(goal for name in names[part::_FILES] for goal in goals(FORMULAS[name]))]
        )
        for part in range(_FILES)
    }


@cache
def exceptions() -> frozenset[str]:
    """The formulas that are not compared: an infimum over all integers is beyond the tactic."""
    return frozenset(name for name, text in _definitions().items() if "least_over_positive" in _closure(name, text))


def goals(formula: Formula) -> list[str]:
    """That the definition is within twelve digits of the float, at each of the points."""
    return [_goal(formula, point(formula, number)) for number in range(len(POINTS))]


def point(formula: Formula, number: int) -> dict[str, Any]:
    """The values that a formula takes at one of the points."""
    shares = {"delta": "1/20"} if number == 0 else {"delta": "1/10"}
    values = {**POINTS[number], **ELSEWHERE.get(formula.name, {})}
    return {name: values[name] if name in values else shares["delta"] for name in formula.parameters}


def _goal(formula: Formula, values: Mapping[str, Any]) -> str:
    exact = formula.exact_arguments(values)
    floats = {name: [float(x) for x in value] if isinstance(value, tuple) else value for name, value in exact.items()}
    estimate = Fraction(float(formula.estimate(**floats)))
    slack = _DIGITS * max(Fraction(1), abs(estimate))
    arguments = " ".join(_written(name, exact[name]) for name in formula.parameters)
    unfolded = ", ".join(_used(formula.name))
    rounded = "".join(f" round_up ({z}%Z); branches;" for z in _ceilings(formula, exact))
    return (
        f"Goal Rabs ({formula.name} {arguments} - {_real(estimate)}) <= {_real(slack)}.\n"
        f"Proof.\n  cbv [{unfolded} sum_over sum_over2 sum_over3 combine fst snd].\n".replace(", ", " ")
        + f"  whole_numbers; naturals; branches;{rounded} binomials; branches; arcs; branches; agree.\nQed.\n"
    )


def _written(name: str, value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{'; '.join(_written(name, entry) for entry in value)}]"
    return f"{value}%nat" if parameter(name).domain.integer else _real(Fraction(value))


def _real(value: Fraction) -> str:
    return f"({value.numerator} / {value.denominator})"


class _Recorded(Balls):
    """Balls that remember which whole numbers were rounded up to."""

    def __init__(self) -> None:
        self.ceilings: list[int] = []

    def ceil(self, x: Value) -> Value:
        result = super().ceil(x)
        self.ceilings.append(round(float(as_ball(result).mid())))
        return result


def _ceilings(formula: Formula, exact: Mapping[str, Any]) -> Iterable[int]:
    recorded = _Recorded()
    with working_precision(200):
        formula(recorded, **ball_arguments(exact))
    return dict.fromkeys(recorded.ceilings)


@cache
def _definitions() -> dict[str, str]:
    terms = CoqTerms()
    for formula in FORMULAS.values():
        terms.define(formula)
    return terms.definitions


def _used(name: str) -> list[str]:
    """A definition's name and those of all definitions that it uses."""
    found, open_names = [], [name]
    while open_names:
        one = open_names.pop()
        if one not in found:
            found.append(one)
            body = _definitions()[one].partition(":=")[2]
            open_names += [word for word in re.findall(r"\w+", body) if word in _definitions()]
    return found


def _closure(name: str, text: str) -> str:
    return " ".join([text, *(_definitions()[one] for one in _used(name))])
