"""The candidates of a session: the version space of the demonstrations, listed, with equal features merged."""

from __future__ import annotations

from dataclasses import dataclass
from math import prod

import numpy as np

from bridge_algos.embeddings import Embedding, expected_features
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_algos.policies import digits, random_policies
from bridge_algos.trajectories import Trajectories
from bridge_theory.errors import InputError

LISTED = 2**21
"""Policies listed, at most; beyond, a sample."""

DIGITS = 10
"""Features that agree to this many decimals are one candidate."""


@dataclass(frozen=True, eq=False)
class Candidates:
    """Policies to choose from.

    Args:
        policies: (N, S) one policy for each distinct feature vector.
        features: (N, d).
        size: policies in the version space.
        complete: whether every policy of the version space is represented; else a sample is.
    """

    policies: IntArray
    features: FloatArray
    size: int
    complete: bool


def recorded_actions(demonstrations: Trajectories | None, n_states: int) -> IntArray:
    """(S,) the action recorded in each state, -1 where none was.

    Raises:
        InputError: when two actions were recorded in one state: then no deterministic policy made the demonstrations.
    """
    recorded = np.full(n_states, -1)
    if demonstrations is None:
        return recorded
    states, actions = demonstrations.states.ravel(), demonstrations.actions.ravel()
    recorded[states] = actions
    if (recorded[states] != actions).any():
        state = int(states[recorded[states] != actions][0])
        raise InputError(
            f"the demonstrations take several actions in state {state}; a version space needs a deterministic "
            "demonstrator, who takes the same action in a state each time."
        )
    return recorded


def version_space_candidates(
    mdp: TabularMDP, embedding: Embedding, demonstrations: Trajectories | None, limit: int, rng: np.random.Generator
) -> Candidates:
    """Every policy that agrees with the demonstrations, or ``limit`` of them drawn uniformly where there are too many.

    Args:
        limit: policies listed, at most.
    """
    recorded = recorded_actions(demonstrations, mdp.n_states)
    open_ = recorded < 0
    size = prod([mdp.n_actions] * int(open_.sum()))
    if size <= limit:
        policies = np.repeat(recorded[None], size, axis=0)
        policies[:, open_] = digits(np.arange(size), [mdp.n_actions] * int(open_.sum()))
    else:
        drawn = random_policies(limit, mdp.n_states, mdp.n_actions, rng)
        policies = np.where(open_, drawn, recorded)
    features, _ = expected_features(mdp.dynamics, policies, embedding)
    first = distinct_rows(features)
    return Candidates(policies[first], features[first], size, size <= limit)


def distinct_rows(features: FloatArray) -> IntArray:
    """Indices of one row for each distinct row, in increasing order; rows that agree to DIGITS decimals are equal.

    Rows are sorted by a 64-bit hash of the rounded numbers, and equality is then checked.
    """
    rounded = np.round(features * 10.0**DIGITS).astype(np.int64)
    multipliers = np.random.default_rng(0).integers(-(2**63), 2**63 - 1, size=features.shape[1]) | 1
    _, first, group = np.unique(rounded @ multipliers, return_index=True, return_inverse=True)
    if (rounded != rounded[first[group]]).any():  # two different rows have the same hash
        _, first = np.unique(rounded, axis=0, return_index=True)
    return np.sort(first)


def deviations(mdp: TabularMDP, embedding: Embedding, policies: IntArray) -> FloatArray:
    """(B, S (A - 1), d) features of the policies that differ from each of B policies (B, S) in one state."""
    n, n_states = policies.shape
    others = np.repeat(policies[:, None], n_states * (mdp.n_actions - 1), axis=1)
    for s in range(n_states):
        for k in range(mdp.n_actions - 1):
            others[:, s * (mdp.n_actions - 1) + k, s] = (policies[:, s] + 1 + k) % mdp.n_actions
    features, _ = expected_features(mdp.dynamics, others.reshape(-1, n_states), embedding)
    return features.reshape(n, -1, embedding.dimension)
