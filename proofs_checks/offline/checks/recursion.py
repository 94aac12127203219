"""The agreement recursion for Bhattacharyya coefficients of trajectory laws, against enumeration."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn

from bridge_algos.hellinger import disagreement_probability
from bridge_algos.hellinger import squared_hellinger as computed_hellinger
from bridge_algos.mdp import Dynamics
from proofs_checks.context import Context
from proofs_checks.exact.every import QUICK, on_every
from proofs_checks.exact.laws import bhattacharyya, probability_of_hitting, stationary_policy
from proofs_checks.exact.model import Model
from proofs_checks.exact.strategies import Pair, Row, pairs, rows
from proofs_checks.exact.surd import Surd, root, surd
from proofs_checks.outcome import Outcome

_ROUNDING = 1e-12


def one_step(x: list[Surd], pair: Pair, *, transposed: bool = True) -> list[Surd]:
    """X_{t+1}(s') = sum_s X_t(s) M(s, s'); without transposition the paper's display X_{t+1} = M X_t."""
    states = range(pair.model.n_states)
    matrix = [
        [
            root(pair.model.kernel[s][a][p] * pair.estimate.kernel[s][a][p]) if a == pair.clone[s] else surd(0)
            for p in states
        ]
        for s, a in enumerate(pair.expert)
    ]
    rows_ = zip(*matrix, strict=True) if transposed else matrix
    return [sum((entry * x[s] for s, entry in enumerate(row)), surd(0)) for row in rows_]


def recursion_equals_enumeration(*, transposed: bool = True, context: Context = QUICK) -> Outcome:
    """X_t(s) is the sum over partial trajectories that end in s, at every step; its total is BC."""

    def holds(pair: Pair) -> bool:
        x = [surd(p) for p in pair.model.initial]
        for steps in range(1, pair.model.horizon + 1):
            x = one_step(x, pair, transposed=transposed)
            laws = (
                Model(m.initial, m.kernel, steps).law(policy, arrival=True)
                for m, policy in ((pair.model, pair.expert), (pair.estimate, pair.clone))
            )
            first, second = laws
            if sum(x, surd(0)) != bhattacharyya(first, second):
                return False
        return True

    return on_every("recursion = enumeration", pairs(), holds, context.pick(quick=50, full=150))


def disagreement_is_the_distance(*, first_state: int = 0, context: Context = QUICK) -> Outcome:
    """With one kernel H^2 is the probability of a state of disagreement."""

    def holds(pair: Pair) -> bool:
        model = pair.model
        first, second = model.law(pair.expert), model.law(pair.clone)
        differ = {s for s in range(first_state, model.n_states) if pair.expert[s] != pair.clone[s]}
        return 1 - bhattacharyya(first, second) == probability_of_hitting(first, differ, model.horizon)

    return on_every("H^2 = P(disagree) with one kernel", pairs(), holds, context.pick(quick=50, full=150))


def disagreement_in_code(*, first_state: int = 0, context: Context = QUICK) -> Outcome:
    """bridge_algos computes the probability of a state of disagreement, to rounding."""

    def holds(pair: Pair) -> bool:
        model = pair.model
        differ = [s for s in range(model.n_states) if pair.expert[s] != pair.clone[s]]
        hit = probability_of_hitting(model.law(pair.expert), differ, model.horizon)
        dynamics = _floats(model)
        indicator = np.array([[float(s in differ and s >= first_state) for s in range(model.n_states)]])
        fast = disagreement_probability(dynamics, np.array(pair.expert), indicator)[0]
        return bool(abs(fast - float(hit)) < _ROUNDING)

    return on_every("the code's probability of a disagreement", pairs(), holds, context.pick(quick=50, full=150))


@st.composite
def _stochastic(draw: DrawFn) -> tuple[Pair, list[Row], list[Row]]:
    pair = draw(pairs(max_states=2))
    tables = [[draw(rows(pair.model.n_actions)) for _ in range(pair.model.n_states)] for _ in range(2)]
    return pair, tables[0], tables[1]


def stochastic_policies(*, factor: Fraction = Fraction(1), context: Context = QUICK) -> Outcome:
    """BC = d_0^T M_1 ... M_{H-1} r for stochastic policies."""

    def holds(instance: tuple[Pair, list[Row], list[Row]]) -> bool:
        pair, one, two = instance
        model, estimate = pair.model, pair.estimate
        states, actions = range(model.n_states), range(model.n_actions)
        agree = [[root(one[s][a] * two[s][a]) * factor for a in actions] for s in states]
        x = [surd(p) for p in model.initial]
        for _ in range(model.horizon - 1):
            x = [
                sum(
                    (
                        x[s] * agree[s][a] * root(model.kernel[s][a][p] * estimate.kernel[s][a][p])
                        for s in states
                        for a in actions
                    ),
                    surd(0),
                )
                for p in states
            ]
        total = sum((x[s] * agree[s][a] for s in states for a in actions), surd(0))
        return total == bhattacharyya(model.law(stationary_policy(one)), estimate.law(stationary_policy(two)))

    return on_every(
        "matrix product = enumeration, stochastic policies", _stochastic(), holds, context.pick(quick=40, full=120)
    )


def stochastic_policies_in_code(*, factor: float = 1.0, context: Context = QUICK) -> Outcome:
    """bridge_algos computes H^2 of stochastic policies, to rounding."""

    def holds(instance: tuple[Pair, list[Row], list[Row]]) -> bool:
        pair, *tables = instance
        models = pair.model, pair.estimate
        first, second = (m.law(stationary_policy(table)) for m, table in zip(models, tables, strict=True))
        one, two = (np.array(table, dtype=float) for table in tables)
        computed = computed_hellinger(_floats(models[0]), one, _floats(models[1]), two)
        return bool(abs(factor * computed - (1 - float(bhattacharyya(first, second)))) < _ROUNDING)

    return on_every("the code's distance", _stochastic(), holds, context.pick(quick=40, full=120))


def _floats(model: Model) -> Dynamics:
    return Dynamics(np.array(model.kernel, dtype=float), np.array(model.initial, dtype=float), model.horizon)
