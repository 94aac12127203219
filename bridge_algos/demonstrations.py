"""Demonstrations against the MDP they are said to come from: the one check behind every door.

What certifies a number from demonstrations refuses those that the MDP excludes; what only runs with them or keeps them
says so, because recorded actions may be noisy.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bridge_algos.mdp import TabularMDP
from bridge_algos.trajectories import Trajectories, load_trajectories
from bridge_theory.errors import InputError


def excluded(mdp: TabularMDP, demonstrations: Trajectories) -> str | None:
    """The first thing in demonstrations that has probability 0 in the MDP, in words; None if there is none.

    Args:
        demonstrations: of states, actions and a horizon that fit the MDP, see :meth:`Trajectories.checked`.

    >>> mdp = TabularMDP(transitions=[[[0, 1]], [[0, 1]]], initial=[1, 0], horizon=2, reward=[[0], [1]])
    >>> excluded(mdp, Trajectories(np.array([[0, 1], [1, 1]]), np.array([[0, 0], [0, 0]])))
    "demonstration 1 starts in the state 's1', where 'mdp' never starts"
    """
    states, actions = demonstrations.states, demonstrations.actions
    wrong = np.flatnonzero(mdp.initial[states[:, 0]] == 0)
    if wrong.size:
        start = mdp.state_names[states[wrong[0], 0]]
        return f"demonstration {wrong[0]} starts in the state {start!r}, where {mdp.name!r} never starts"
    impossible = np.argwhere(mdp.transitions[states[:, :-1], actions[:, :-1], states[:, 1:]] == 0)
    if impossible.size:
        i, h = impossible[0]
        source, target = (mdp.state_names[s] for s in states[i, h : h + 2])
        action = mdp.action_names[actions[i, h]]
        step = (
            f"step {h + 1} of demonstration {i} goes from the state {source!r} by the action {action!r} to {target!r}"
        )
        return f"{step}, which {mdp.name!r} never does"
    return None


def checked_demonstrations(mdp: TabularMDP, demonstrations: Trajectories) -> Trajectories:
    """The demonstrations themselves, after making sure that the MDP can have produced them.

    Raises:
        InputError: for shapes, ranges or a horizon that do not fit, and for what the MDP gives probability 0.
    """
    demonstrations.checked(mdp.n_states, mdp.n_actions, mdp.horizon)
    fault = excluded(mdp, demonstrations)
    if fault is not None:
        raise InputError(f"{fault}; are these demonstrations from another environment, or their actions noisy?")
    return demonstrations


def load_demonstrations(path: str | Path, mdp: TabularMDP) -> Trajectories:
    """The demonstrations of an ``.npz`` file, checked as by :func:`checked_demonstrations`."""
    return checked_demonstrations(mdp, load_trajectories(path, mdp.n_states, mdp.n_actions, mdp.horizon))
