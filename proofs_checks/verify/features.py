r"""What a policy does under a transition kernel: features and bonuses, with every rounding enclosed.

All numbers that are added are nonnegative, so that rounding is bounded relative to the result: after H steps of sums of
S terms, each entry is known up to a factor close to 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from bridge_theory import bonus_radius
from bridge_theory.arithmetic.balls import BALLS
from bridge_theory.arithmetic.flint_balls import Ball, ball, ends
from bridge_theory.errors import InputError
from proofs_checks.verify.enclosed import UNIT, Enclosed, FloatArray, enlarged, raised

IntArray = NDArray[np.int64]

BLOCK = 2**21
"""Entries of the gathered kernels (policies x S x S) held at a time."""


@dataclass(frozen=True, eq=False)
class Coordinates:
    """An embedding of the paper as a table: a trajectory adds one to the coordinates of each pair it passes.

    Args:
        places: (H, S, A, c) coordinates that step h in state s with action a adds one to; ``dimension`` means none.
        dimension: d.
        square_bound: B^2, the largest squared norm of a trajectory's features.
    """

    places: IntArray
    dimension: int
    square_bound: int

    def of_trajectories(self, states: IntArray, actions: IntArray) -> IntArray:
        """Features (n, d) of trajectories (n, H): whole numbers."""
        result = np.zeros((len(states), self.dimension + 1), dtype=np.int64)
        places = self.places[np.arange(states.shape[1]), states, actions]
        np.add.at(result, (np.arange(len(states))[:, None, None], places), 1)
        return result[:, :-1]


def coordinates(name: str, n_states: int, n_actions: int, horizon: int) -> Coordinates:
    """One of the paper's embeddings (table "Discrete embedding definitions and properties"), or the pair counts."""
    h, s, a = np.meshgrid(np.arange(horizon), np.arange(n_states), np.arange(n_actions), indexing="ij")
    both = n_states + n_actions
    tables = {
        "identity_long": ((h * both + s, h * both + n_states + a), horizon * both, 2 * horizon),
        "identity_short": ((s, n_states + a), both, 2 * horizon**2),
        "state_counts": ((s,), n_states, horizon**2),
        "final_state": ((np.where(h == horizon - 1, s, n_states),), n_states, 1),
        "state_action_counts": ((s * n_actions + a,), n_states * n_actions, horizon**2),
    }
    if name not in tables:
        raise InputError(f"the log's embedding is {name!r}, expected one of {', '.join(tables)}.")
    places, dimension, square_bound = tables[name]
    return Coordinates(np.stack(places, axis=-1), dimension, square_bound)


def estimated_kernel(counts: IntArray, empty_row: str) -> FloatArray:
    """Pooled counts (S, A, S) as a kernel, each entry a rational rounded once; rows without data are conventions."""
    totals = counts.sum(axis=2, keepdims=True)
    n_states = len(counts)
    default = np.eye(n_states)[:, None] if empty_row == "self_loop" else np.full((1, 1, n_states), 1 / n_states)
    return np.asarray(np.where(totals > 0, counts / np.maximum(totals, 1), default))


def row_radii(counts: IntArray, delta: Ball) -> FloatArray:
    """The L1 radius eps_N of every row (S, A), rounded up (audit R6)."""
    n_states, n_actions, _ = counts.shape
    seen = counts.sum(axis=2)
    radii = {
        n: ends(bonus_radius(BALLS, S=ball(n_states), A=ball(n_actions), delta_P=delta, N=ball(n)))[1]
        for n in set(seen.ravel().tolist())
    }
    return np.array([[radii[n] for n in row] for row in seen.tolist()])


def expectations(
    kernel: FloatArray,
    initial: FloatArray,
    policies: IntArray,
    table: Coordinates,
    costs: FloatArray | None = None,
    steps: int = 0,
) -> tuple[Enclosed, FloatArray]:
    """Features of deterministic policies (N, S) under a kernel (S, A, S), and their expected costs, rounded up.

    Args:
        kernel: each entry within one rounding of the true one; rows are divided by their sums.
        costs: (S, A) nonnegative, summed over the first ``steps`` pairs.

    Returns:
        Features (N, d) and expected costs (N,).
    """
    horizon, n_states, _, _ = table.places.shape
    kernel = kernel / kernel.sum(axis=2, keepdims=True)
    start = initial / initial.sum()
    features, spent = np.zeros((len(policies), table.dimension + 1)), np.zeros(len(policies))
    every = np.arange(n_states)
    block = max(1, BLOCK // n_states**2)
    for first in range(0, len(policies), block):
        part = slice(first, first + block)
        chosen = policies[part]
        kernels, rows = kernel[every, chosen], np.arange(len(chosen))[:, None, None]
        occupancy = np.broadcast_to(start, chosen.shape)
        for h in range(horizon):
            if h:
                occupancy = np.matmul(occupancy[:, None, :], kernels)[:, 0]
            np.add.at(features[part], (rows, table.places[h, every, chosen]), occupancy[:, :, None])
            if costs is not None and h < steps:
                spent[part] += (occupancy * costs[every, chosen]).sum(axis=1)
    # H steps of S + 1 roundings, S + 3 for each normalised row, and one for each of H S terms of a sum
    relative = enlarged((horizon * (3 * n_states + 8) + 8) * UNIT)
    size = float(features.max(initial=0.0))
    return Enclosed(features[:, :-1], enlarged(relative * size)), raised(spent * (1 + relative))


def feature_bound(table: Coordinates) -> Ball:
    """B as a ball."""
    return ball(table.square_bound).sqrt()


def approximate_bound(table: Coordinates) -> float:
    """B as a float."""
    return sqrt(table.square_bound)
