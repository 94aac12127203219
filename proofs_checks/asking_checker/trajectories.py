"""Recorded trajectories, checked to be possible, and what demonstrations leave open."""

from __future__ import annotations

from typing import Any

import numpy as np

from bridge_algos.mdp import TabularMDP
from bridge_theory.errors import InputError
from proofs_checks.asking_checker.entries import table
from proofs_checks.verify.features import IntArray


def trajectories(value: Any, name: str, mdp: TabularMDP) -> tuple[IntArray, IntArray]:
    """States and actions (n, H) of trajectories that the environment can produce.

    Raises:
        InputError: for another shape, an index out of range, or a step of probability zero.
    """
    if not isinstance(value, dict):
        raise InputError(f"{name} must hold states and actions.")
    states = table(value.get("states"), f"the states of the {name}", mdp.horizon, mdp.n_states)
    actions = table(value.get("actions"), f"the actions of the {name}", mdp.horizon, mdp.n_actions)
    if len(states) != len(actions):
        raise InputError(f"the {name} has {len(states)} rows of states and {len(actions)} of actions.")
    chances = mdp.transitions[states[:, :-1], actions[:, :-1], states[:, 1:]]
    impossible = (mdp.initial[states[:, 0]] <= 0) | (chances <= 0).any(axis=1)
    if impossible.any():
        row = int(np.flatnonzero(impossible)[0])
        raise InputError(f"trajectory {row} of the {name} is impossible in the environment.")
    return states, actions


def demonstrated(states: IntArray, actions: IntArray, n_states: int) -> IntArray:
    """(S,) the one action demonstrated in each state, -1 where none was.

    Raises:
        InputError: when demonstrations take two actions in a state: they contradict a deterministic demonstrator.
    """
    recorded = np.full(n_states, -1, dtype=np.int64)
    for state, action in zip(states.ravel().tolist(), actions.ravel().tolist(), strict=True):
        if recorded[state] not in (-1, action):
            raise InputError(f"the demonstrations take several actions in state {state}; no candidate is left.")
        recorded[state] = action
    return recorded
