r"""Counts by step: all that the offline stage knows of its demonstrations, and a way to draw them without trajectories.

The clone, the estimated dynamics and every bound from data see n demonstrations only through how often each pair was
recorded at step h and where it led. Under a deterministic expert these tables form a Markov chain of their own: given
how many trajectories are in each state at step h, the numbers that go on from s to each s' are multinomial,
independently over s and independent of the earlier tables. Drawing them therefore costs the same for ten
demonstrations and for a billion, and the visits within one trajectory keep their dependence.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridge_algos.given import check_policy, checked
from bridge_algos.mdp import Dynamics, FloatArray, IntArray
from bridge_algos.shapes import PairCounts, Policy, TransitionCounts
from bridge_algos.trajectories import Trajectories


@dataclass(frozen=True, eq=False)
class StepCounts:
    """What n demonstrations recorded at each step.

    Args:
        visits: (H, S, A) recorded actions; each step sums to n.
        transitions: (H - 1, S, A, S) transitions from step h to step h + 1.
    """

    visits: IntArray
    transitions: IntArray

    @property
    def pairs(self) -> PairCounts:
        """(S, A) as :func:`bridge_algos.offline.cloning.action_counts` counts them."""
        return np.asarray(self.visits.sum(axis=0))

    @property
    def pooled(self) -> TransitionCounts:
        """(S, A, S) as :func:`bridge_algos.offline.transitions.transition_counts` counts them."""
        return np.asarray(self.transitions.sum(axis=0))


@checked
def step_counts(demonstrations: Trajectories, n_states: int, n_actions: int) -> StepCounts:
    """The tables of given demonstrations.

    >>> counts = step_counts(Trajectories(np.array([[0, 1]]), np.array([[2, 0]])), n_states=2, n_actions=3)
    >>> counts.visits.shape, counts.transitions[0, 0, 2].tolist()
    ((2, 2, 3), [0, 1])
    """
    states, actions = demonstrations.checked(n_states, n_actions).states, demonstrations.actions
    horizon = demonstrations.horizon
    visits = np.zeros((horizon, n_states, n_actions), dtype=np.int64)
    np.add.at(visits, (np.arange(horizon), states, actions), 1)
    transitions = np.zeros((horizon - 1, n_states, n_actions, n_states), dtype=np.int64)
    np.add.at(transitions, (np.arange(horizon - 1), states[:, :-1], actions[:, :-1], states[:, 1:]), 1)
    return StepCounts(visits, transitions)


@checked
def sample_step_counts(
    dynamics: Dynamics, policy: Policy, n: int, size: int, rng: np.random.Generator
) -> list[StepCounts]:
    """The tables of ``size`` independent data sets of n demonstrations, with exactly the law of those of trajectories.

    Args:
        dynamics: the real dynamics, with one kernel for all steps.
        policy: (S,) the deterministic stationary expert.
        n: at least 1; up to 10^18, for the counts are 64-bit integers.
    """
    check_policy("policy", policy, dynamics.n_states, dynamics.n_actions)
    states = np.arange(dynamics.n_states)
    kernel = dynamics.transitions[states, policy]
    shape = (size, dynamics.horizon, dynamics.n_states, dynamics.n_actions)
    visits = np.zeros(shape, dtype=np.int64)
    transitions = np.zeros((size, shape[1] - 1, *shape[2:], shape[2]), dtype=np.int64)
    present = _multinomial(np.full(size, n), dynamics.initial, rng)
    for h in range(dynamics.horizon):
        visits[:, h, states, policy] = present
        if h + 1 < dynamics.horizon:
            moves = _multinomial(present, kernel, rng)
            transitions[:, h, states, policy] = moves
            present = moves.sum(axis=1)
    return [StepCounts(*tables) for tables in zip(visits, transitions, strict=True)]


def _multinomial(totals: IntArray, probabilities: FloatArray, rng: np.random.Generator) -> IntArray:
    """Multinomial counts, one category after the other; unlike NumPy's, never one where the probability is zero."""
    tails = np.cumsum(probabilities[..., ::-1], axis=-1)[..., ::-1]
    left = totals.copy()
    counts = np.zeros((*totals.shape, probabilities.shape[-1]), dtype=np.int64)
    for category in range(probabilities.shape[-1]):
        chance, tail = probabilities[..., category], tails[..., category]
        share = np.divide(chance, tail, out=np.zeros_like(tail), where=tail > 0)
        counts[..., category] = rng.binomial(left, share)
        left = left - counts[..., category]
    return counts
