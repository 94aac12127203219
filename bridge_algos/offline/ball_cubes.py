r"""The Hellinger ball around a deterministic policy as a disjoint union of cubes, found by branch and bound.

Under one kernel, H^2 between a deterministic policy and the centre is :math:`F(D)`, the probability that the centre's
trajectory hits the disagreement set D (audit T14). F is monotone in D, so that the feasible sets are down-closed: while
states are decided one by one, undecided states give F a lower value when they agree and an upper one when they do not.
A node whose upper value fits is a whole cube of policies; one whose lower value does not fit is empty.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridge_algos.given import checked
from bridge_algos.hellinger import disagreement_probability
from bridge_algos.mdp import Dynamics, FloatArray, IntArray
from bridge_algos.shapes import Policy
from bridge_theory.errors import InputError

ROUNDING_SLACK = 1e-12
"""Added to r^2 in every comparison: rounding may enlarge a confidence set, never shrink it."""

WORK_LIMIT = 2e10
"""Multiplications after which the search gives up: some seconds."""


@dataclass(frozen=True, eq=False)
class Cubes:
    """Disjoint cubes of policies: in each one, some states disagree with the centre, some agree, the others are free.

    Args:
        disagree: (M, S) booleans, states forced to differ from the centre.
        free: (M, S) booleans, states where every action is allowed.
        n_actions: A.
    """

    disagree: np.ndarray
    free: np.ndarray
    n_actions: int

    def sizes(self) -> list[int]:
        """Exact number of policies in each cube, (A - 1)^|disagree| A^|free|."""
        a = self.n_actions
        pairs = zip(self.disagree.sum(axis=1).tolist(), self.free.sum(axis=1).tolist(), strict=True)
        return [(a - 1) ** differing * a**free for differing, free in pairs]


@checked
def ball_cubes(dynamics: Dynamics, center: Policy, squared_radius: float) -> Cubes:
    """All deterministic stationary policies with H^2 <= r^2 to the centre, as disjoint cubes.

    Raises:
        InputError: when that takes more than ``WORK_LIMIT`` multiplications.
    """
    n_states = dynamics.n_states
    work_per_node = 2.0 * dynamics.horizon * n_states**2
    work = 0.0
    limit = squared_radius + ROUNDING_SLACK
    singletons = disagreement_probability(dynamics, center, np.eye(n_states))
    order = np.argsort(-singletons, kind="stable")
    out = np.zeros((1, n_states), dtype=bool)
    undecided = np.ones(n_states, dtype=bool)
    found: list[tuple[np.ndarray, np.ndarray]] = []
    for state in order:
        work += len(out) * work_per_node
        if work > WORK_LIMIT:
            raise InputError(
                f"listing the ball of radius {squared_radius**0.5:g} over {n_states} states takes more than "
                f"{WORK_LIMIT:.0e} multiplications; find members of it with chain_sample, or take a radius nearer to 0 "
                "or 1."
            )
        fits = _hit(dynamics, center, out | undecided) <= limit
        found.append((out[fits], np.broadcast_to(undecided, (int(fits.sum()), n_states))))
        out = out[~fits]
        if not len(out):
            break
        undecided = undecided.copy()
        undecided[state] = False
        leaving = out.copy()
        leaving[:, state] = True
        out = np.concatenate([out, leaving[_hit(dynamics, center, leaving) <= limit]])
    else:
        found.append((out, np.zeros_like(out)))
    disagree, free = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return Cubes(disagree, free, dynamics.n_actions)


def _hit(dynamics: Dynamics, center: IntArray, sets: np.ndarray) -> FloatArray:
    return disagreement_probability(dynamics, center, sets.astype(np.float64))
