r"""Squared Hellinger distance between trajectory laws, by recursion instead of enumeration.

.. math:: H^2(P, Q) = 1 - BC(P, Q), \qquad BC(P, Q) = \sum_\tau \sqrt{P(\tau) Q(\tau)} .

With :math:`X_1 = \sqrt{d_0^1 d_0^2}` and
:math:`M_h(s, s') = \sum_a \sqrt{\pi^1_h \pi^2_h(a|s)} \sqrt{P^1 P^2(s'|s, a)}` the paper's recursion (appendix "An
efficient calculation of the Hellinger distance") is :math:`X_{h+1} = M_h^T X_h`; the paper prints M where M^T is meant.
A trajectory has H state-action pairs, so there are H - 1 transitions and a last factor for the agreement on a_H; with
equal dynamics this equals the paper's H transitions.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bridge_algos.given import checked
from bridge_algos.mdp import Dynamics, FloatArray
from bridge_algos.policies import action_probabilities
from bridge_algos.shapes import PerPolicy, Policy, PolicyStates
from bridge_theory.errors import InputError

CACHED_ROWS = 8192
"""Rows worked on at a time, so that they stay in the processor's cache."""


def bhattacharyya(first: Dynamics, policy1: ArrayLike, second: Dynamics, policy2: ArrayLike) -> float:
    """Bhattacharyya coefficient BC in [0, 1] between two trajectory laws, an estimate to rounding.

    Policies may be deterministic or stochastic, stationary or time-dependent; dynamics equal or different, with
    kernels (S, A, S) or time-dependent (H - 1, S, A, S).

    >>> coin = Dynamics(np.array([[[0.5, 0.5]] * 2, [[0.5, 0.5]] * 2]), np.array([1.0, 0.0]), 2)
    >>> bhattacharyya(coin, [0, 0], coin, [0, 1])
    0.5
    """
    horizon = first.horizon
    shape = (first.n_states, first.n_actions)
    if (second.horizon, second.n_states, second.n_actions) != (horizon, *shape):
        raise InputError(
            f"two dynamics of different size, (H, S, A) = {(horizon, *shape)} and "
            f"{(second.horizon, second.n_states, second.n_actions)}, have no Hellinger distance; make them agree."
        )
    agreement = np.sqrt(action_probabilities(policy1, *shape, horizon) * action_probabilities(policy2, *shape, horizon))
    overlap = np.sqrt(_per_step(first) * _per_step(second))
    x = np.sqrt(first.initial * second.initial)
    for h in range(horizon - 1):
        x = np.einsum("s,sa,sap->p", x, agreement[h], overlap[min(h, len(overlap) - 1)])
    return float(min(1.0, (x[:, None] * agreement[-1]).sum()))


def squared_hellinger(first: Dynamics, policy1: ArrayLike, second: Dynamics, policy2: ArrayLike) -> float:
    """H^2 = 1 - BC in [0, 1]; see :func:`bhattacharyya`. For one kernel prefer :func:`disagreement_probability`."""
    return 1.0 - bhattacharyya(first, policy1, second, policy2)


def _per_step(dynamics: Dynamics) -> FloatArray:
    kernel = dynamics.transitions
    return kernel[None] if kernel.ndim == 3 else kernel


@checked
def disagreement_probability(dynamics: Dynamics, center: Policy, disagree: PolicyStates) -> PerPolicy:
    r"""H^2 to a deterministic centre: the probability that its trajectory meets a state where the other disagrees.

    For deterministic policies under one kernel :math:`H^2(P^\pi, P^c) = TV = P^c(\text{hit } D)` with
    :math:`D = \{s : \pi(s) \ne c(s)\}` (audit T7, T14). Sums of non-negative terms only, so that a distance of zero is
    exactly zero.

    Args:
        center: (S,) deterministic policy c.
        disagree: (N, S) indicator of D, one row a policy.

    Returns:
        (N,) array in [0, 1].
    """
    kernel = dynamics.transitions[np.arange(dynamics.n_states), center]
    hit = np.zeros(len(disagree))
    for start in range(0, len(disagree), CACHED_ROWS):
        leaving = disagree[start : start + CACHED_ROWS]
        staying = 1.0 - leaving
        x = np.broadcast_to(dynamics.initial, leaving.shape)
        for h in range(dynamics.horizon):
            if h:
                x = (x * staying) @ kernel
            hit[start : start + CACHED_ROWS] += np.einsum("ns,ns->n", x, leaving)
    return np.minimum(hit, 1.0)
