r"""Occupancies: how often a policy is where, exactly, for many policies at once.

The state occupancy of a policy is :math:`d_h(s) = P^\pi(s_h = s)`; it obeys :math:`d_{h+1} = d_h T_\pi` with
:math:`T_\pi(s, s') = P(s' | s, \pi(s))`. Everything linear in occupancies (returns, expected embeddings, bonuses) is
computed from them without sampling.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from bridge_algos.given import checked
from bridge_algos.mdp import Dynamics, FloatArray
from bridge_algos.policies import action_probabilities, check_actions
from bridge_algos.shapes import Occupancies, Policies, PolicyStates
from bridge_theory.errors import InputError

BLOCK = 1024
"""Policies worked on at a time, at most."""

CACHED_ENTRIES = 2**16
"""Numbers (policies, S, S) worked on at a time, so that they stay in the processor's cache."""


def blocks(policies: np.ndarray, n_states: int, n_actions: int) -> Iterator[tuple[slice, Policies]]:
    """Consecutive blocks of a batch of deterministic policies (N, S), after checking shape and range."""
    if policies.ndim != 2 or policies.shape[1] != n_states or policies.dtype.kind not in "iu":
        raise InputError(
            f"a batch of policies has shape {policies.shape} of {policies.dtype}, expected integers (N, {n_states})."
        )
    check_actions(policies, n_actions)
    size = max(1, min(BLOCK, CACHED_ENTRIES // n_states**2))
    for start in range(0, len(policies), size):
        yield slice(start, start + size), policies[start : start + size]


def state_occupancies(dynamics: Dynamics, policies: Policies) -> Occupancies:
    """Per-step state occupancies of one block of deterministic policies.

    Args:
        policies: (N, S) integers; the result and the kernels are held whole, so pass a block at a time.

    Returns:
        (N, H, S) array d_h(s); each (H, S) slice has rows that sum to one.
    """
    n, n_states = policies.shape
    n_actions = dynamics.n_actions
    kernel = dynamics.transitions.reshape(n_states * n_actions, n_states)
    # One product of (N, S A) pair occupancies with the whole kernel beats N small products with the policies' kernels.
    chosen = np.arange(n * n_states).reshape(n, n_states) * n_actions + policies
    pairs = np.zeros((n, n_states * n_actions))
    occupancy = np.empty((dynamics.horizon, n, n_states))
    occupancy[0] = dynamics.initial
    for h in range(1, dynamics.horizon):
        pairs.reshape(-1)[chosen] = occupancy[h - 1]
        np.matmul(pairs, kernel, out=occupancy[h])
    return occupancy.swapaxes(0, 1)


def state_action_occupancies(dynamics: Dynamics, policy: ArrayLike) -> FloatArray:
    """Per-step occupancies d_h(s, a), (H, S, A), of one policy of any form, stochastic and time-dependent included.

    >>> import numpy as np
    >>> swap = Dynamics(np.array([[[0.0, 1.0]], [[1.0, 0.0]]]), np.array([1.0, 0.0]), 3)
    >>> state_action_occupancies(swap, [0, 0])[:, :, 0]
    array([[1., 0.],
           [0., 1.],
           [1., 0.]])
    """
    probabilities = action_probabilities(policy, dynamics.n_states, dynamics.n_actions, dynamics.horizon)
    occupancy = np.empty_like(probabilities)
    states = dynamics.initial
    for h in range(dynamics.horizon):
        occupancy[h] = states[:, None] * probabilities[h]
        states = np.einsum("sa,sap->p", occupancy[h], dynamics.transitions)
    return occupancy


@checked
def total_occupancies(dynamics: Dynamics, policies: np.ndarray, steps: int | None = None) -> PolicyStates:
    r"""Expected visits :math:`\sum_{h \le steps} d_h(s)` of deterministic policies.

    Args:
        policies: (N, S) integers.
        steps: how many of the H steps to sum; all of them by default.

    Returns:
        (N, S) array; rows sum to ``steps``.
    """
    steps = dynamics.horizon if steps is None else steps
    totals = np.empty(policies.shape)
    for where, block in blocks(policies, dynamics.n_states, dynamics.n_actions):
        totals[where] = state_occupancies(dynamics, block)[:, :steps].sum(axis=1)
    return totals


@checked
def visit_probabilities(dynamics: Dynamics, policies: Policies) -> PolicyStates:
    """Probability that a trajectory visits each state at least once, (N, S), for deterministic policies (N, S)."""
    result = np.empty(policies.shape)
    n_states = dynamics.n_states
    for where, block in blocks(policies, n_states, dynamics.n_actions):
        kernels = dynamics.transitions[np.arange(n_states), block]
        # avoiding[n, g, s]: probability of being in s now without having met the target g so far
        avoiding = np.broadcast_to(dynamics.initial, (len(block), n_states, n_states)).copy()
        met = np.zeros((len(block), n_states))
        targets = np.arange(n_states)
        for h in range(dynamics.horizon):
            if h:
                avoiding = avoiding @ kernels
            met += avoiding[:, targets, targets]
            avoiding[:, targets, targets] = 0
        result[where] = met
    return result
