"""The candidates, listed by the checker itself: every policy that no demonstration contradicts, equal features merged.

Merging is sound whatever is merged: the radius of a candidate covers the features of all policies that it stands for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridge_algos.mdp import TabularMDP
from bridge_theory.errors import InputError
from proofs_checks.verify.enclosed import UNIT, Enclosed, FloatArray, enlarged
from proofs_checks.verify.features import Coordinates, IntArray, expectations

LISTED = 2**22
"""Policies listed, at most."""

CELL = 1e-8
"""Features in one cell of a grid of this width are merged."""


@dataclass(frozen=True, eq=False)
class Candidates:
    """Args:
    policies: (N, S) one for each candidate.
    features: (N, d) midpoints.
    radii: (N,) each coordinate of each policy that the candidate stands for lies this near.
    size: policies that they stand for.
    complete: whether these are all that no demonstration contradicts.
    """

    policies: IntArray
    features: FloatArray
    radii: FloatArray
    size: int
    complete: bool


def version_space(recorded: IntArray, n_actions: int) -> IntArray:
    """(N, S) all policies that take the demonstrated actions.

    >>> version_space(np.array([1, -1]), 2)
    array([[1, 0],
           [1, 1]])
    """
    open_ = np.flatnonzero(recorded < 0)
    size = n_actions ** len(open_)
    if size > LISTED:
        raise InputError(f"the demonstrations leave {size:.3g} policies, more than the {LISTED:,} that are checked.")
    policies = np.repeat(recorded[None], size, axis=0)
    index = np.arange(size)
    for state in reversed(open_.tolist()):
        index, policies[:, state] = np.divmod(index, n_actions)
    return policies


def candidates(mdp: TabularMDP, table: Coordinates, policies: IntArray, complete: bool) -> Candidates:
    """Policies with their features enclosed and near-equal ones merged."""
    features = features_of(mdp, table, policies)
    first, group = cells(features.mid)
    apart = np.zeros(len(first))
    np.maximum.at(apart, group, np.abs(features.mid - features.mid[first[group]]).max(axis=1))
    radii = apart * (1 + 8 * UNIT) + enlarged(features.rad + 2 * UNIT * features.size)
    return Candidates(policies[first], features.mid[first], radii, len(policies), complete)


def features_of(mdp: TabularMDP, table: Coordinates, policies: IntArray) -> Enclosed:
    """(N, d) expected features, enclosed."""
    return expectations(mdp.transitions, mdp.initial, policies, table)[0]


def cells(features: FloatArray, width: float = CELL, shift: float = 0.3819660112501051) -> tuple[IntArray, IntArray]:
    """First index and group of rows that lie in one cell of a grid (or whose cells share a hash, which is as sound)."""
    keys = np.floor(features / width + shift).astype(np.int64)
    odd = np.random.default_rng(20).integers(-(2**62), 2**62, size=features.shape[1]) * 2 + 1
    _, first, group = np.unique(keys @ odd, return_index=True, return_inverse=True)
    return first, group.ravel()


def stochastic_features(mdp: TabularMDP, table: Coordinates, policy: FloatArray) -> Enclosed:
    """(d,) expected features of a stochastic policy (S, A), enclosed: nonnegative sums, whose rounding is relative."""
    kernel = mdp.transitions / mdp.transitions.sum(axis=2, keepdims=True)
    step = np.einsum("sa,sat->st", policy, kernel)
    occupancy, features = mdp.initial / mdp.initial.sum(), np.zeros(table.dimension + 1)
    for h in range(mdp.horizon):
        pairs = occupancy[:, None] * policy
        np.add.at(features, table.places[h], pairs[:, :, None])
        occupancy = occupancy @ step
    terms = mdp.horizon * (4 * mdp.n_states + 3 * mdp.n_actions + mdp.n_states * mdp.n_actions + 16)
    return Enclosed(features[:-1], enlarged(terms * UNIT * float(features.max())))
