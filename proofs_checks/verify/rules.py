"""How wide a run says its confidence set is: the four rules, written down a second time to contradict the run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

import bridge_theory as theory
from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.arithmetic.flint_balls import Ball, ball
from proofs_checks.verify.ellipsoid import certified_scale
from proofs_checks.verify.enclosed import FloatArray
from proofs_checks.verify.facts import Facts
from proofs_checks.verify.features import IntArray, approximate_bound, feature_bound
from proofs_checks.verify.remaining import Remaining


@dataclass(eq=False)
class History:
    """The pairs played so far: expected visits (2, S, A) under the estimate of their round, and the counts (S, A)."""

    visits: list[FloatArray] = field(default_factory=list)
    counts: list[IntArray] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Rule:
    """What a run's confidence set is made of.

    Args:
        scale: its data matrix starts as this multiple of the identity.
        expected: the matrix takes in the expected differences of the pairs, not the observed ones of trajectories.
        gamma: multiplier in round t from the certified radius rho_t and the history.
        costs: bonus of a pair of state and action from its count; None for the L1 bonus of audit R6.
        answers: what Pi_t comes from where it is not the multiplier; the centre, matrix and radius of its ellipsoid are
            then used instead of the logged weights, the data matrix and ``gamma``.
    """

    scale: Ball
    expected: bool
    gamma: Callable[[int, float, History], float]
    costs: Callable[[IntArray], FloatArray] | None = None
    answers: Remaining | None = None


def rule_of(facts: Facts) -> Rule:
    """The rule that a log's configuration names."""
    rules = {"fixed": _fixed, "stated": _stated, "repaired": _repaired, "likelihood": _likelihood}
    return rules[facts.configuration["confidence"]](facts)


def _repaired(facts: Facts) -> Rule:
    scale = certified_scale(feature_bound(facts.table), ball(facts.weight_bound), ball(facts.lam))
    return Rule(scale, expected=False, gamma=lambda _t, rho, _history: rho)


def _likelihood(facts: Facts) -> Rule:
    numbers = float(facts.weight_bound), float(facts.delta), float(facts.slope)
    return replace(_repaired(facts), answers=Remaining(*numbers, len(facts.policies)))


def _fixed(facts: Facts) -> Rule:
    _, n_states, n_actions, _ = facts.table.places.shape
    most = float(np.log(n_states * n_actions))

    def costs(counts: IntArray) -> FloatArray:
        rooted = np.sqrt(most / np.where(counts > 0, counts, 1))
        return np.asarray(facts.bonus_multiplier * np.where(counts > 0, np.minimum(most, rooted), most))

    return Rule(ball(facts.lam), expected=True, gamma=lambda _t, _rho, _history: facts.gamma, costs=costs)


def _stated(facts: Facts) -> Rule:
    horizon, n_states, n_actions, _ = facts.table.places.shape
    size = {"S": n_states, "A": n_actions}
    bound, weight_bound = approximate_bound(facts.table), float(facts.weight_bound)
    lam, delta, d = float(facts.lam), float(facts.delta), facts.table.dimension
    eta = 2 * weight_bound * bound
    model = {"B": bound, "W": weight_bound, "d": d, "lam": lam, "T": facts.rounds, "delta": delta}

    def bonus(counts: IntArray, failure: float) -> FloatArray:
        seen = np.maximum(counts, 2)
        values = theory.xi.estimate(N=seen, eta=eta, delta=failure, H=horizon, **size)
        return np.where(counts >= 2, values, 2 * eta)

    def gamma(t: int, _rho: float, history: History) -> float:
        if facts.known:
            return float(theory.gamma_known.estimate(t=t, **model))
        epsilon = theory.net_scale.estimate(t=t, lam=lam, B=bound, W=weight_bound)
        shared = float(theory.net_delta.estimate(W=weight_bound, d=d, epsilon=epsilon, delta=delta))
        squares = 0.0
        for age, (visits, counts) in enumerate(zip(history.visits, history.counts, strict=True), start=1):
            failure = float(theory.step_bonus_delta.estimate(t=age, delta=shared, **size))
            squares += float(((visits * bonus(counts, failure)).sum(axis=(1, 2)) ** 2).sum())
        return float(theory.gamma_unknown.estimate(t=t, bonus_square_sum=squares, **model))

    scale = theory.kappa(BALLS, B=feature_bound(facts.table), W=ball(facts.weight_bound)) * ball(facts.lam)
    failure = float(theory.online_bonus_delta.estimate(delta=delta, **size))
    return Rule(scale, expected=True, gamma=gamma, costs=lambda counts: bonus(counts, failure))
