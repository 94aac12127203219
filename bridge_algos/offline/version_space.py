"""The version space: the policies that agree with every demonstration, as a ball of radius zero (audit T8A)."""

from __future__ import annotations

import numpy as np

from bridge_algos.mdp import Dynamics, TabularMDP
from bridge_algos.offline.transitions import estimate_transitions
from bridge_algos.shapes import TransitionCounts
from bridge_algos.trajectories import Trajectories


def closed_estimate(mdp: TabularMDP, demonstrations: Trajectories, counts: TransitionCounts) -> Dynamics:
    """Dynamics under which radius zero is the version space, surely.

    Transition counts with self-loops where there is no data, and the empirical first state: the chain never leaves the
    states with a recorded action, and meets each of them. A ball of radius zero under other dynamics (the real ones, a
    known random start, uniform rows) also judges states that were never demonstrated, and can lose the expert.
    """
    first = np.bincount(demonstrations.states[:, 0], minlength=mdp.n_states) / len(demonstrations)
    return Dynamics(estimate_transitions(counts, "self_loop"), first, mdp.horizon)
