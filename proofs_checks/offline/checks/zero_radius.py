"""T8 and T14: what the data alone determine, and how many policies a ball holds."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations
from typing import Literal

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from bridge_theory import offline_radius_closed, offline_radius_mass
from proofs_checks.context import Context
from proofs_checks.exact.certify import within
from proofs_checks.exact.every import QUICK, on_every
from proofs_checks.exact.laws import History, deterministic_policies, probability_of_hitting, squared_hellinger
from proofs_checks.exact.model import Model, point
from proofs_checks.exact.strategies import Study, kernels, models, rows, studies
from proofs_checks.exact.surd import root
from proofs_checks.outcome import Outcome, Tally

Default = Literal["self-loop", "uniform"]


def recorded_actions(demonstrations: Sequence[History]) -> dict[int, int]:
    """The action seen in each state that was acted in."""
    return {h[2 * t]: h[2 * t + 1] for h in demonstrations for t in range(len(h) // 2)}


def count_estimate(study: Study, default: Default = "self-loop") -> Model:
    """Counts of the transitions inside the trajectories, ``default`` where there are none, empirical start."""
    size, actions = study.model.n_states, study.model.n_actions
    counts = [[[0] * size for _ in range(actions)] for _ in range(size)]
    for h in study.demonstrations:
        for t in range(len(h) // 2 - 1):
            counts[h[2 * t]][h[2 * t + 1]][h[2 * t + 2]] += 1
    kernel = tuple(
        tuple(
            tuple(Fraction(c, sum(row)) for c in row) if sum(row) else _default_row(s, size, default)
            for row in counts[s]
        )
        for s in range(size)
    )
    first = [sum(h[0] == s for h in study.demonstrations) for s in range(size)]
    empirical = tuple(Fraction(c, len(study.demonstrations)) for c in first)
    return Model(empirical, kernel, study.model.horizon)


def _default_row(state: int, size: int, default: Default) -> tuple[Fraction, ...]:
    return tuple(point(state, size)) if default == "self-loop" else (Fraction(1, size),) * size


def consistent_policies(study: Study) -> list[tuple[int, ...]]:
    """The version space: every deterministic policy that agrees with all demonstrations."""
    recorded = recorded_actions(study.demonstrations)
    return [
        policy
        for policy in deterministic_policies(study.model.n_states, study.model.n_actions)
        if all(policy[s] == a for s, a in recorded.items())
    ]


def closed_estimate(*, default: Default = "self-loop", context: Context = QUICK) -> Outcome:
    """T8(A): with the closed count estimate the ball of radius 0 around any clone is the version space."""

    def holds(study: Study) -> bool:
        estimate, space = count_estimate(study, default), consistent_policies(study)
        clone = estimate.law(space[-1])
        laws = {p: estimate.law(p) for p in deterministic_policies(study.model.n_states, study.model.n_actions)}
        inside = [p for p, law in laws.items() if squared_hellinger(law, clone) == 0]
        return study.expert in space and inside == space and all(laws[p] == clone for p in space)

    cases = st.one_of(st.just(_last_seen_state()), studies(max_states=3, max_horizon=4))
    return on_every("radius 0 is the version space", cases, holds, context.pick(quick=60, full=200))


def _last_seen_state() -> Study:
    """One demonstration (A, A, B): B is acted in only at the last step, and C never."""
    half = (Fraction(1, 2), Fraction(1, 2), Fraction(0))
    kernel = ((half, half), (tuple(point(1, 3)),) * 2, (tuple(point(2, 3)),) * 2)
    return Study(Model(tuple(point(0, 3)), kernel, 3), (0, 0, 0), ((0, 0, 0, 0, 1, 0),))


def closed_formula(*, claimed: Fraction = Fraction(0)) -> Outcome:
    """The formula of bridge_theory for a closed estimate is 0."""
    tally = Tally()
    tally.expect(Fraction(offline_radius_closed.enclosure().upper) == claimed, "the radius is not zero")
    return tally.outcome("radius under a closed estimate")


@st.composite
def _any_estimate(draw: DrawFn) -> tuple[Study, Model]:
    study = draw(studies(max_states=3, max_horizon=3))
    size, actions = study.model.n_states, study.model.n_actions
    return study, Model(draw(rows(size)), draw(kernels(size, actions)), study.model.horizon)


def any_estimate(*, forgotten: int = 0, context: Context = QUICK) -> Outcome:
    """T8(B): H^2(P-hat^pi*, P-hat^BC) <= P-hat^BC(hit a state without data), for every clone and every estimate."""

    def holds(instance: tuple[Study, Model]) -> bool:
        study, estimate = instance
        unseen = set(range(study.model.n_states - forgotten)) - set(recorded_actions(study.demonstrations))
        expert = estimate.law(study.expert)
        for clone in consistent_policies(study):
            law = estimate.law(clone)
            distance = squared_hellinger(expert, law).rational()
            mass = probability_of_hitting(law, unseen, estimate.horizon)
            if distance > mass or not within(root(distance), offline_radius_mass, mass=mass):
                return False
        return True

    return on_every("distance below the mass without data", _any_estimate(), holds, context.pick(quick=50, full=150))


@st.composite
def _balls(draw: DrawFn) -> tuple[Model, tuple[int, ...], Fraction]:
    model = draw(models(max_states=3, max_actions=3, weights=(0, 1, 2, 3)))
    center = tuple(draw(st.integers(0, model.n_actions - 1)) for _ in range(model.n_states))
    return model, center, draw(st.sampled_from([Fraction(k, 6) for k in range(7)]))


def counting(*, alternatives: int = 1, context: Context = QUICK) -> Outcome:
    """T14: |{pi : H^2 <= r^2}| = sum over D with P(hit D) <= r^2 of (A - 1)^|D|; bridge_algos counts the same."""

    def holds(instance: tuple[Model, tuple[int, ...], Fraction]) -> bool:
        from bridge_algos.mdp import Dynamics
        from bridge_algos.offline.policy_set import PolicySet

        model, center, squared_radius = instance
        law, size, actions = model.law(center), model.n_states, model.n_actions
        enumerated = sum(
            squared_hellinger(law, model.law(policy)) <= squared_radius
            for policy in deterministic_policies(size, actions)
        )
        counted = sum(
            (actions - alternatives) ** len(differ)
            for k in range(size + 1)
            for differ in combinations(range(size), k)
            if probability_of_hitting(law, differ, model.horizon) <= squared_radius
        )
        dynamics = Dynamics(np.array(model.kernel, float), np.array(model.initial, float), model.horizon)
        listed = PolicySet(dynamics, np.array(center), float(squared_radius) ** 0.5).count()
        return bool(enumerated == counted == listed)

    return on_every("counting a ball", _balls(), holds, context.pick(quick=50, full=150))


def hitting_is_a_capacity(*, sign: int = 1, context: Context = QUICK) -> Outcome:
    """F(D) = P(hit D) is monotone and submodular, and its feasible sets are down-closed."""

    def holds(instance: tuple[Model, tuple[int, ...], Fraction]) -> bool:
        model, center, _ = instance
        law = model.law(center)
        subsets = [frozenset(c) for k in range(model.n_states + 1) for c in combinations(range(model.n_states), k)]
        hit = {d: sign * probability_of_hitting(law, d, model.horizon) for d in subsets}
        monotone = all(hit[d] <= hit[e] for d in subsets for e in subsets if d <= e)
        return monotone and all(hit[d | e] + hit[d & e] <= hit[d] + hit[e] for d in subsets for e in subsets)

    return on_every("hitting probability is a capacity", _balls(), holds, context.pick(quick=50, full=150))
