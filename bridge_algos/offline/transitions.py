"""The transition estimate: pooled counts, and what to write into a row that has no data.

The paper sums over h in [H] although a trajectory ends at s_H; only the H - 1 transitions inside a trajectory are
observed, and they are what is counted here (audit M4, 3.6).
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np

from bridge_algos.given import checked
from bridge_algos.shapes import Kernel, TransitionCounts
from bridge_algos.trajectories import Trajectories
from bridge_theory.errors import InputError

EmptyRow = Literal["self_loop", "uniform"]


@checked
def transition_counts(trajectories: Trajectories, n_states: int, n_actions: int) -> TransitionCounts:
    """N(s, a, s') over the H - 1 transitions of each trajectory, (S, A, S)."""
    trajectories.checked(n_states, n_actions)
    counts = np.zeros((n_states, n_actions, n_states), dtype=np.int64)
    add_transitions(counts, trajectories)
    return counts


def add_transitions(counts: TransitionCounts, trajectories: Trajectories) -> None:
    """Add the H - 1 transitions of each trajectory to counts (S, A, S), in place; states and actions are in range."""
    s, a = trajectories.states, trajectories.actions
    np.add.at(counts, (s[:, :-1], a[:, :-1], s[:, 1:]), 1)


@checked
def estimate_transitions(counts: TransitionCounts, empty_row: EmptyRow = "self_loop") -> Kernel:
    r"""Maximum-likelihood kernel :math:`\hat P(s'|s,a) = N(s,a,s') / N(s,a)` (eq:trans_count_est).

    Args:
        counts: (S, A, S) transition counts, offline and online pooled by addition.
        empty_row: what a pair without data does, where the paper's quotient is 0/0. ``"self_loop"`` stays put, which
            keeps the estimate closed on the visited states (audit T8A: radius zero then contains the expert surely);
            ``"uniform"`` goes anywhere with equal probability.

    >>> estimate_transitions(np.array([[[1, 3]], [[0, 0]]]))[:, 0]
    array([[0.25, 0.75],
           [0.  , 1.  ]])
    """
    n_states = counts.shape[0]
    if empty_row not in get_args(EmptyRow):
        raise InputError(f"empty_row is {empty_row!r}, expected 'self_loop' or 'uniform'.")
    default = np.eye(n_states)[:, None] if empty_row == "self_loop" else 1 / n_states
    totals = counts.sum(axis=2, keepdims=True)
    return np.asarray(np.where(totals > 0, counts / np.maximum(totals, 1), default))
