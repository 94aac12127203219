r"""Optimal policies by dynamic programming: backward induction and policy iteration.

Ties: actions whose values lie within ``TIE_TOLERANCE`` of the best, relative to the largest value of the stage, count
as equally good, and the lowest action index is taken. Without the tolerance the last bit of a matrix product, which
differs between machines, would choose among actions that are equal in exact arithmetic.
"""

from __future__ import annotations

import numpy as np

from bridge_algos.evaluation import expected_next_value
from bridge_algos.given import check_policy, checked
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_theory.errors import InputError

TIE_TOLERANCE = 1e-12
LARGEST_DISCOUNT = 1 - 1e-6
"""Beyond, values of size 1 / (1 - discount) leave neither solvers nor row sums (within 1e-9) enough accuracy."""


def backward_induction(mdp: TabularMDP) -> tuple[IntArray, FloatArray]:
    r"""An optimal time-dependent deterministic policy for the expected return of H steps.

    :math:`V_h(s) = \max_a [r(s, a) + \sum_{s'} P(s'|s, a) V_{h+1}(s')]`, :math:`V_{H+1} = 0` (Puterman, Markov
    Decision Processes, 1994, section 4.5).

    Returns:
        policy: (H, S) integers; the lowest of the tied actions, so that its return is within H TIE_TOLERANCE max|V| of
            the optimum.
        values: (H + 1, S) optimal values, the last row zero.

    >>> kernel = [[[1, 0], [0, 1]], [[0, 1], [0, 1]]]
    >>> mdp = TabularMDP(kernel, [1, 0], horizon=2, reward=[0, 1], axes="state-action", reward_on="arrival")
    >>> backward_induction(mdp)
    (array([[1, 0], [1, 0]]), array([[2., 2.], [1., 1.], [0., 0.]]))
    """
    policy = np.empty((mdp.horizon, mdp.n_states), dtype=np.int64)
    values = np.zeros((mdp.horizon + 1, mdp.n_states))
    for h in reversed(range(mdp.horizon)):
        q = mdp.expected_reward + expected_next_value(mdp, values[h + 1])
        values[h] = q.max(axis=-1)
        policy[h] = lowest_best_action(q)
    return policy, values


@checked
def policy_iteration(mdp: TabularMDP, discount: float) -> tuple[IntArray, FloatArray]:
    r"""An optimal stationary deterministic policy for the discounted return :math:`E \sum_t \gamma^{t-1} r_t`.

    Howard's policy iteration with exact evaluation, :math:`(I - \gamma P_\pi) V = r_\pi` (Puterman 1994, section 6.4).
    An action is exchanged only for one that is better by more than the error of the linear solve, so that the values
    increase strictly and the iteration ends. The horizon of the MDP plays no part.

    Args:
        discount: gamma in [0, LARGEST_DISCOUNT].

    Returns:
        policy: (S,) integers, the lowest of the tied actions.
        values: (S,) its discounted values.

    >>> kernel = [[[1, 0], [0, 1]], [[0, 1], [0, 1]]]
    >>> mdp = TabularMDP(kernel, [1, 0], horizon=2, reward=[0, 1], axes="state-action", reward_on="arrival")
    >>> policy_iteration(mdp, discount=0.5)
    (array([1, 0]), array([2., 2.]))
    """
    check_discount(discount)
    # The error of the solve grows like the condition number, at most 2 / (1 - discount).
    tolerance = max(TIE_TOLERANCE, 32 * np.finfo(float).eps / (1 - discount))
    states = np.arange(mdp.n_states)
    policy = lowest_best_action(mdp.expected_reward, tolerance)
    while True:
        values = discounted_values(mdp, policy, discount)
        q = mdp.expected_reward + discount * expected_next_value(mdp, values)
        better = lowest_best_action(q, tolerance)
        improved = q[states, better] > q[states, policy] + tolerance * np.abs(q).max()
        if not improved.any():
            return better, discounted_values(mdp, better, discount)
        policy = np.where(improved, better, policy)


@checked
def discounted_values(mdp: TabularMDP, policy: IntArray, discount: float) -> FloatArray:
    """(S,) discounted values of a deterministic stationary policy (S,), by one linear solve."""
    check_policy("policy", policy, mdp.n_states, mdp.n_actions)
    states = np.arange(mdp.n_states)
    system = np.eye(mdp.n_states) - discount * mdp.transitions[states, policy]
    return np.asarray(np.linalg.solve(system, mdp.expected_reward[states, policy]))


def lowest_best_action(q: FloatArray, tolerance: float = TIE_TOLERANCE) -> IntArray:
    """(...) lowest action whose value in q (..., A) is within a relative tolerance of the best."""
    slack = tolerance * np.abs(q).max()
    return np.asarray(np.argmax(q >= q.max(axis=-1, keepdims=True) - slack, axis=-1))


def check_discount(discount: float) -> None:
    """Raise InputError unless the discount lies in [0, LARGEST_DISCOUNT]."""
    if not 0 <= discount <= LARGEST_DISCOUNT:
        raise InputError(
            f"discount is {discount!r}, expected a number in [0, {LARGEST_DISCOUNT}]; the published runs used 0.99."
        )
