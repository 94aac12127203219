"""The bounds that demonstrations certify by themselves, from the demonstrations and the MDP they come from."""

from __future__ import annotations

from bridge_algos.demonstrations import checked_demonstrations
from bridge_algos.mdp import TabularMDP
from bridge_algos.offline.cloning import clone_deterministic
from bridge_algos.offline.data_radius import leaving_mass
from bridge_algos.offline.step_counts import step_counts
from bridge_algos.offline.transitions import EmptyRow
from bridge_algos.trajectories import Trajectories
from bridge_theory.from_data import bounds_from_counts
from bridge_theory.parameters import Given
from bridge_theory.value import BoundValue


def bounds_from_demonstrations(
    mdp: TabularMDP, demonstrations: Trajectories, *, delta: Given, empty_row: EmptyRow = "uniform"
) -> dict[str, BoundValue]:
    """What demonstrations certify: :func:`bridge_theory.bounds_from_counts` with the radius of audit T8(B).

    Args:
        mdp: gives the sizes and the first state's law, and has to allow every step of the demonstrations.
        demonstrations: recorded without noise.
        delta: failure probability of each bound.
        empty_row: what the estimated dynamics do where there is no data; it decides the mass of T8(B) alone.

    Raises:
        InputError: for demonstrations that the MDP cannot have produced.

    >>> from bridge_algos.envs import star_mdp
    >>> import numpy as np
    >>> zeros = np.zeros((3, 8), dtype=np.int64)
    >>> bounds_from_demonstrations(star_mdp(), Trajectories(zeros, zeros), delta="0.05")
    Traceback (most recent call last):
    bridge_theory.errors.InputError: step 1 of demonstration 0 goes from the state 's0' by the action ...
    """
    counts = step_counts(checked_demonstrations(mdp, demonstrations), mdp.n_states, mdp.n_actions)
    clone = clone_deterministic(counts.pairs, tie_break="first")
    mass = leaving_mass(counts, mdp.initial, clone, empty_row).upper
    return bounds_from_counts(counts.visits, counts.transitions, delta=delta, mass=mass)
