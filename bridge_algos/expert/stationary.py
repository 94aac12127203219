"""The best stationary deterministic policy for the expected return of a finite horizon.

The paper's policy class is the stationary deterministic one, but neither dynamic programming nor a linear program
optimises a finite-horizon return over it: the backward recursion couples the steps. The optimum over the class is the
evaluation score's maximum, found here with a statement of what was certified.
"""

from __future__ import annotations

import numpy as np

from bridge_algos.evaluation import expected_returns, rounding_allowance
from bridge_algos.expert.branch_and_bound import branch_and_bound
from bridge_algos.expert.choices import count_choices, relevant_actions
from bridge_algos.expert.stationary_optimum import StationaryOptimum
from bridge_algos.mdp import IntArray, TabularMDP
from bridge_algos.policies import digits
from bridge_theory.errors import InputError

FEW_POLICIES = 4096
"""Up to here enumeration is at most a few milliseconds; beyond, branch and bound needs fewer evaluations."""
ENUMERATION_LIMIT = 2**24
"""Beyond, a minute and more."""
BLOCK = 2**16
"""Policies written out at once."""


def best_stationary(mdp: TabularMDP, node_limit: int | None = None) -> StationaryOptimum:
    """The best stationary deterministic policy: by enumeration where that is a few milliseconds, else branch and bound.

    Args:
        node_limit: see :func:`bridge_algos.expert.branch_and_bound.branch_and_bound`.

    >>> kernel = [[[1, 0], [0, 1]], [[0, 1], [0, 1]]]
    >>> mdp = TabularMDP(kernel, [1, 0], horizon=3, reward=[0, 1], axes="state-action", reward_on="arrival")
    >>> best = best_stationary(mdp)
    >>> best.policy, best.value, best.optimal, best.method
    (array([1, 0]), 3.0, True, 'enumeration')
    """
    if count_choices(relevant_actions(mdp)) <= FEW_POLICIES:
        return enumerate_stationary(mdp)
    return branch_and_bound(mdp, node_limit)


def enumerate_stationary(mdp: TabularMDP) -> StationaryOptimum:
    """The best of all stationary deterministic policies, the first in lexicographic order where several tie.

    Raises:
        InputError: when more than ENUMERATION_LIMIT policies differ in what can happen.
    """
    allowed = relevant_actions(mdp)
    counts, count = allowed.sum(axis=1).tolist(), count_choices(allowed)
    if count > ENUMERATION_LIMIT:
        raise InputError(
            f"the MDP {mdp.name!r} has at least 10^{len(str(count)) - 1} different stationary policies, expected at "
            f"most {ENUMERATION_LIMIT} for enumeration; use branch_and_bound."
        )
    # Row s lists the allowed actions of state s first, in increasing order.
    actions = np.argsort(~allowed, axis=1, kind="stable")
    returns = np.empty(count)

    def policies(start: int, stop: int) -> IntArray:
        return np.asarray(actions[np.arange(mdp.n_states), digits(np.arange(start, stop), counts)])

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
