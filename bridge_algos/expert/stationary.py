"""The best stationary deterministic policy for the expected return of a finite horizon.

The paper's policy class is the stationary deterministic one, but neither dynamic programming nor a linear program
optimises a finite-horizon return over it: the backward recursion couples the steps. The optimum over the class is the
evaluation score's maximum, found here with a statement of what was certified.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bridge_algos.evaluation import expected_returns, rounding_allowance
from bridge_algos.expert.dynamic_programming import backward_induction
from bridge_algos.mdp import IntArray, TabularMDP
from bridge_theory.errors import InputError

BoolArray = NDArray[np.bool_]

FEW_POLICIES = 4096
"""Up to here enumeration is at most a few milliseconds; beyond, branch and bound needs fewer evaluations."""
ENUMERATION_LIMIT = 2**24
BLOCK = 2**16


@dataclass(frozen=True, eq=False)
class StationaryOptimum:
    """A stationary deterministic policy and a certified bound on all others.

    Args:
        policy: (S,) integers, the best policy found.
        value: its expected return.
        upper: no stationary deterministic policy returns more (rounding errors included).
        tolerance: the part of ``upper - value`` that rounding errors explain.
        method: ``"enumeration"`` or ``"branch and bound"``.
        evaluations: policies evaluated, or relaxed problems solved.
    """

    policy: IntArray
    value: float
    upper: float
    tolerance: float
    method: str
    evaluations: int

    @property
    def gap(self) -> float:
        """Certified distance from the optimum, upper - value."""
        return self.upper - self.value

    @property
    def optimal(self) -> bool:
        """Whether the policy is certified to be optimal up to rounding errors."""
        return self.gap <= self.tolerance

    def describe(self) -> str:
        """What was certified, in one sentence."""
        if self.optimal:
            return (
                f"the best stationary deterministic policy returns {self.value:.6g}, optimal up to {self.gap:.1e} by "
                f"{self.method}"
            )
        return (
            f"the best stationary deterministic policy found returns {self.value:.6g}, not certified as optimal: "
            f"{self.method} stopped after {self.evaluations} evaluations and leaves a gap of {self.gap:.3g}"
        )


def best_stationary(mdp: TabularMDP, node_limit: int | None = None) -> StationaryOptimum:
    """The best stationary deterministic policy: by enumeration where that is a few milliseconds, else branch and bound.

    Args:
        node_limit: see :func:`bridge_algos.expert.branch_and_bound.branch_and_bound`.

    >>> mdp = TabularMDP(transitions=[[[1, 0], [0, 1]], [[0, 1], [0, 1]]], initial=[1, 0], horizon=3, reward=[0, 1])
    >>> best = best_stationary(mdp)
    >>> best.policy, best.value, best.optimal, best.method
    (array([1, 0]), 3.0, True, 'enumeration')
    """
    from bridge_algos.expert.branch_and_bound import branch_and_bound

    if count_choices(relevant_actions(mdp)) <= FEW_POLICIES:
        return enumerate_stationary(mdp)
    return branch_and_bound(mdp, node_limit)


def enumerate_stationary(mdp: TabularMDP) -> StationaryOptimum:
    """The best of all stationary deterministic policies, the first in lexicographic order where several tie.

    Raises:
        InputError: when more than ENUMERATION_LIMIT policies differ in what can happen.
    """
    allowed = relevant_actions(mdp)
    counts, count = allowed.sum(axis=1), count_choices(allowed)
    if count > ENUMERATION_LIMIT:
        raise InputError(
            f"the MDP {mdp.name!r} has {count:.3g} different stationary policies, expected at most {ENUMERATION_LIMIT} "
            "for enumeration; use branch_and_bound."
        )
    # Row s lists the allowed actions of state s first, in increasing order.
    actions = np.argsort(~allowed, axis=1, kind="stable")
    returns = np.empty(count)

    def policies(start: int, stop: int) -> IntArray:
        digits = np.stack(np.unravel_index(np.arange(start, stop), counts), axis=1)
        return np.asarray(actions[np.arange(mdp.n_states), digits])

    for start in range(0, count, BLOCK):
        stop = min(start + BLOCK, count)
        returns[start:stop] = expected_returns(mdp, policies(start, stop))
    allowance = rounding_allowance(mdp)
    best = int(np.argmax(returns >= returns.max() - 2 * allowance))
    return StationaryOptimum(
        policy=policies(best, best + 1)[0],
        value=float(returns[best]),
        upper=float(returns.max()) + allowance,
        tolerance=4 * allowance,
        method="enumeration",
        evaluations=count,
    )


def relevant_actions(mdp: TabularMDP) -> BoolArray:
    """(S, A) mask of the choices that can matter.

    States out of reach of every policy keep one action, that of backward induction at the first step; of actions with
    equal transitions and reward the lowest is kept.
    """
    allowed = np.zeros((mdp.n_states, mdp.n_actions), dtype=bool)
    unreachable = ~reachable_states(mdp)
    allowed[unreachable, backward_induction(mdp)[0][0, unreachable]] = True
    behaviour = np.concatenate([mdp.transitions, mdp.expected_reward[..., None]], axis=-1)
    for state in np.flatnonzero(~unreachable):
        first = np.unique(behaviour[state], axis=0, return_index=True)[1]
        allowed[state, first] = True
    return allowed


def reachable_states(mdp: TabularMDP) -> BoolArray:
    """(S,) mask of the states in which some policy acts with positive probability within the horizon."""
    edges: BoolArray = np.asarray((mdp.transitions > 0).any(axis=1))
    reached = np.asarray(mdp.initial > 0)
    for _ in range(min(mdp.horizon, mdp.n_states) - 1):
        reached |= edges[reached].any(axis=0)
    return reached


def count_choices(allowed: BoolArray) -> int:
    """Number of stationary deterministic policies within a mask (S, A); exact, since it may exceed 2^63."""
    return math.prod(int(n) for n in allowed.sum(axis=1))
