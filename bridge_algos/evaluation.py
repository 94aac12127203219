r"""Exact expected returns of policies, one at a time or in batches, by backward recursion.

With :math:`V_{H+1} = 0`, a policy satisfies
:math:`V_h(s) = \sum_a \pi_h(a|s) [r(s, a) + \sum_{s'} P(s'|s, a) V_{h+1}(s')]` and its expected return is
:math:`J(\pi) = \sum_s d_0(s) V_1(s)`: the score by which experts and learned policies are compared.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bridge_algos.mdp import FloatArray, TabularMDP
from bridge_algos.occupancy import blocks
from bridge_algos.policies import action_probabilities


def expected_return(mdp: TabularMDP, policy: ArrayLike) -> float:
    """Expected sum of the H rewards of one policy; exact up to :func:`rounding_allowance`.

    Args:
        policy: any form that :func:`bridge_algos.policies.action_probabilities` takes.

    Raises:
        InputError: for a policy of another shape or range.

    >>> kernel = [[[1, 0], [0, 1]], [[0, 1], [0, 1]]]
    >>> mdp = TabularMDP(kernel, [1, 0], horizon=3, reward=[0, 1], axes="state-action", reward_on="arrival")
    >>> expected_return(mdp, [1, 0]), expected_return(mdp, [[0.5, 0.5], [1.0, 0.0]])
    (3.0, 2.125)
    """
    chosen = action_probabilities(policy, mdp.n_states, mdp.n_actions, mdp.horizon)
    values = np.zeros(mdp.n_states)
    for probabilities in chosen[::-1]:
        values = (probabilities * (mdp.expected_reward + expected_next_value(mdp, values))).sum(axis=-1)
    return float(mdp.initial @ values)


def expected_returns(mdp: TabularMDP, policies: ArrayLike) -> FloatArray:
    """Expected returns (N,) of N deterministic stationary policies, integers of shape (N, S).

    Raises:
        InputError: for another shape or type, or an action out of range.

    >>> kernel = [[[1, 0], [0, 1]], [[0, 1], [0, 1]]]
    >>> mdp = TabularMDP(kernel, [1, 0], horizon=3, reward=[0, 1], axes="state-action", reward_on="arrival")
    >>> expected_returns(mdp, [[0, 0], [1, 0]])
    array([0., 3.])
    """
    array, states = np.asarray(policies), np.arange(mdp.n_states)
    returns = np.empty(len(array))
    for part, block in blocks(array, mdp.n_states, mdp.n_actions):
        kernels, reward = mdp.transitions[states, block], mdp.expected_reward[states, block]
        values = np.zeros_like(reward)
        for _ in range(mdp.horizon):
            values = reward + np.matmul(kernels, values[..., None])[..., 0]
        returns[part] = values @ mdp.initial
    return returns


def expected_next_value(mdp: TabularMDP, values: FloatArray) -> FloatArray:
    """(..., S, A) expectation of values (..., S) at the next state, one matrix product for a whole batch."""
    n_states, n_actions = mdp.n_states, mdp.n_actions
    kernel = mdp.transitions.reshape(n_states * n_actions, n_states)
    return np.asarray((values @ kernel.T).reshape(*values.shape, n_actions))


def rounding_allowance(mdp: TabularMDP) -> float:
    r"""A bound on the rounding error of a backward recursion over the horizon in double precision.

    A dot product of k terms errs by at most :math:`k u / (1 - k u)` times the sum of magnitudes, u = 2^-53 (Higham,
    Accuracy and Stability of Numerical Algorithms, 2002, section 3.1). One step of the recursion takes at most
    2S + A + 6 roundings on values of magnitude at most (H - h + 1) max|r|; the sum over the steps is doubled, which
    covers the second-order terms and row sums that are off by 1e-9.
    """
    roundings = 2 * mdp.n_states + mdp.n_actions + 6
    return 2.0**-53 * roundings * mdp.horizon * (mdp.horizon + 3) * float(np.abs(mdp.reward).max())
