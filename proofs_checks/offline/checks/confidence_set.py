"""T9: how far the expert may lie from the clone under the estimated kernel, given the two errors."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from itertools import pairwise
from typing import Any

from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from bridge_theory import (
    confidence_set_radius,
    confidence_set_radius_angle,
    confidence_set_radius_deterministic,
    confidence_set_radius_repaired,
)
from bridge_theory.arithmetic.flint_balls import Ball
from bridge_theory.bound import Bound
from proofs_checks.context import Context
from proofs_checks.exact.certify import Number, at_most, attained, value_of, within
from proofs_checks.exact.every import QUICK, on_every
from proofs_checks.exact.laws import Choice, deterministic, occupancies, squared_hellinger
from proofs_checks.exact.model import Model
from proofs_checks.exact.strategies import choices, pairs
from proofs_checks.exact.surd import Surd, at_most_roots, surd
from proofs_checks.outcome import Outcome, Tally, together
from proofs_checks.smt import prove, reals

Policy = Choice | tuple[int, ...]


@st.composite
def _settings(draw: DrawFn, deterministic: bool = False) -> Any:
    pair = draw(pairs())
    if deterministic:
        return pair.model, pair.estimate, pair.expert, pair.clone
    return pair.model, pair.estimate, draw(choices(pair.model)), draw(choices(pair.model))


def _as_choices(instance: tuple[Model, Model, tuple[int, ...], tuple[int, ...]]) -> tuple[Model, Model, Choice, Choice]:
    model, estimate, *actions = instance
    expert, clone = (deterministic(each, model.n_actions) for each in actions)
    return model, estimate, expert, clone


def _errors(model: Model, estimate: Model, expert: Policy, clone: Policy) -> tuple[Surd, Surd, Surd]:
    """K = H^2(P-hat^pi*, P-hat^BC), R_1 and R_2."""
    true_expert, estimated_expert = model.law(expert), estimate.law(expert)
    return (
        squared_hellinger(estimated_expert, estimate.law(clone)),
        squared_hellinger(model.law(clone), true_expert),
        squared_hellinger(estimated_expert, true_expert),
    )


def any_policies(*, factor: Fraction = Fraction(2), context: Context = QUICK) -> Outcome:
    """sqrt(K) <= sqrt(R1) + factor sqrt(R2), exactly and by the formula, for stochastic history-dependent policies."""

    def holds(instance: tuple[Model, Model, Choice, Choice]) -> bool:
        k, r1, r2 = _errors(*instance)
        exact = at_most_roots(k, (1, r1), (factor, r2))
        return exact and within(_root(k), confidence_set_radius_repaired, R1=r1, R2=r2)

    known = _as_choices((*_detour(Fraction(3, 4)), (0, 0), (0, 1)))
    settings = st.one_of(st.just(known), _settings(), _settings(deterministic=True).map(_as_choices))
    return on_every("T9, any policies", settings, holds, context.pick(quick=60, full=220))


def deterministic_policies(*, squared_factor: Fraction = Fraction(2), context: Context = QUICK) -> Outcome:
    """sqrt(K) <= sqrt(R1) + sqrt(2 R2), for deterministic policies."""

    def holds(instance: tuple[Model, Model, tuple[int, ...], tuple[int, ...]]) -> bool:
        k, r1, r2 = _errors(*instance)
        exact = at_most_roots(k, (1, r1), (1, r2 * squared_factor))
        return exact and within(_root(k), confidence_set_radius_deterministic, R1=r1, R2=r2)

    settings = _settings(deterministic=True)
    return on_every("T9, deterministic policies", settings, holds, context.pick(quick=60, full=220))


def angle_form(*, share: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """sqrt(K) <= sin(arcsin sqrt(R1) + arccos(1 - R2)) for deterministic policies; ``share`` shrinks R2."""

    def holds(instance: tuple[Model, Model, tuple[int, ...], tuple[int, ...]]) -> bool:
        k, r1, r2 = _errors(*instance)
        return within(_root(k), confidence_set_radius_angle, R1=r1, R2=r2 * share)

    known = (*_detour(Fraction(3, 4)), (0, 0), (0, 1))
    settings = st.one_of(st.just(known), _settings(deterministic=True))
    return on_every("T9, angle form", settings, holds, context.pick(quick=60, full=220))


def _root(value: Surd) -> Number:
    """The root of a surd as a number for ``within``; zero stays exact."""

    def ball_() -> Ball:
        return value.ball().sqrt()

    return surd(0) if value == 0 else ball_


def root_two_is_tight(*, squared_factor: Fraction = Fraction(2)) -> Outcome:
    """R1 = 0 and an estimate that reaches the disagreement with small probability x: K / R2 = 1 + sqrt(1 - x)."""
    tally = Tally()
    for stay in (Fraction(1, 2), Fraction(9, 10), Fraction(999, 1000), Fraction(99999, 100000)):
        x = 1 - stay**2
        instance = _detour(x)
        k, r1, r2 = _errors(*instance, (0, 0), (0, 1))
        tally.expect((k, r1, r2) == (surd(x), surd(0), surd(1 - stay)), "the instance is another")
        tally.expect(k == r2 * (1 + stay), f"K is not (1 + {stay}) R2")
        tally.expect(k <= r2 * squared_factor, f"the squared factor {squared_factor} fails at x = {x}")
    return tally.outcome("the factor sqrt 2 is approached")


def _detour(x: Fraction) -> tuple[Model, Model]:
    start, stay = (Fraction(1), Fraction(0)), (Fraction(1), Fraction(0))
    model = Model(start, ((stay, stay), (stay[::-1],) * 2), 2)
    return model, model.under((((1 - x, x),) * 2, (stay[::-1],) * 2))


def angle_is_attained(*, shift: Fraction = Fraction(0)) -> Outcome:
    """Start mass a^2 on the disagreement under the truth and b^2 under the estimate: the angle form is an equality."""
    tally = Tally()
    for k, j in ((Fraction(1, 3), Fraction(1, 2)), (Fraction(1, 5), Fraction(1, 3)), (Fraction(0), Fraction(2, 7))):
        (a, a_rest), (b, b_rest) = ((2 * t / (1 + t**2), (1 - t**2) / (1 + t**2)) for t in (k, j))
        r2 = 1 - a * b - a_rest * b_rest
        tally.expect(attained(b + shift, confidence_set_radius_angle, R1=a**2, R2=r2), f"R1 = {a**2}, R2 = {r2}")
    return tally.outcome("two-point laws attain the angle form")


def stated_radius_is_larger(*, floor: Fraction = Fraction(2)) -> Outcome:
    """1 + sqrt(H (1 + 2 sqrt(R1)/gamma)) >= 2 for all H >= 1, R1 >= 0, gamma > 0: T9 implies the paper's lemma."""
    h, r, g, root = reals("H r gamma root")
    hypotheses = [h >= 1, r >= 0, g > 0, g <= 1, root >= 0, root * root * g == h * (g + 2 * r)]
    bound = f"{floor.numerator}/{floor.denominator}"
    import z3

    return prove("1 + sqrt(H C) >= 2", hypotheses, 1 + root >= z3.RealVal(bound))


def stated_formula_covers(*, only_policy_error: bool = False, context: Context = QUICK) -> Outcome:
    """The paper's radius, from the exact R1, R2 and gamma_min of each instance, contains the expert."""

    def holds(instance: tuple[Model, Model, tuple[int, ...], tuple[int, ...]]) -> bool:
        model, _, expert, _ = instance
        k, r1, r2 = _errors(*instance)
        rarest = min(p for d in occupancies(model.law(expert), model.horizon) for p in d.values())
        second = surd(0) if only_policy_error else r2
        return within(_root(k), confidence_set_radius, R1=r1, R2=second, H=model.horizon, gamma_min=rarest)

    known = (*_detour(Fraction(3, 4)), (0, 0), (0, 1))
    settings = st.one_of(st.just(known), _settings(deterministic=True))
    return on_every("the lemma's radius contains the expert", settings, holds, context.pick(quick=40, full=150))


def product_inequality(*, constant: int = 2) -> Outcome:
    """The algebra of T9: E[(1 - g)^2] <= constant (1 - E g), and division by sqrt K + sqrt R1."""
    k, a, b = reals("k a b")  # sqrt K, sqrt R1, sqrt R2
    hypothesis = [k >= 0, a >= 0, b >= 0, k * k - a * a <= 2 * b * (k + a)]
    difference = prove("divide by sqrt K + sqrt R1", hypothesis, k <= a + constant * b)
    g, m = reals("g m")  # first and second moment of g
    weights = prove("E(1 - g)^2", [g >= 0, m >= g * g, m <= 1], 1 - 2 * g + m <= constant * (1 - g))
    return together(difference, weights)


def monotone_in_errors(*, formula: Bound = confidence_set_radius_repaired, sign: int = 1) -> Outcome:
    """Larger error bounds give larger radii, so that bounds may stand in for the errors themselves."""
    tally = Tally()
    grid = [Fraction(k, 8) for k in range(9)]
    for low, high in pairwise(grid):
        for other in grid:
            for key, fixed in (("R1", "R2"), ("R2", "R1")):
                small, large = ({key: value, fixed: other} for value in ((low, high) if sign > 0 else (high, low)))
                rises = at_most(partial(value_of, formula, **small), partial(value_of, formula, **large))
                tally.expect(rises, f"{formula.name} falls from {small} to {large}")
    return tally.outcome(f"{formula.name} rises on a grid of 8 x 9")
