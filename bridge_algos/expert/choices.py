"""Which actions a stationary policy has to choose among: states in reach, and actions that differ."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from bridge_algos.expert.dynamic_programming import backward_induction
from bridge_algos.mdp import TabularMDP

BoolArray = NDArray[np.bool_]


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
