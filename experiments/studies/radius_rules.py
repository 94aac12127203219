"""The radii that a formula gives before any data is seen, by a short key: what the ladder and the ablation compare."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import bridge_theory as theory
from bridge_algos.mdp import Dynamics, IntArray
from bridge_algos.offline.radius import minimum_visitation
from bridge_theory.bound import Bound
from bridge_theory.solution import Solution
from bridge_theory.solve import solve_for


@dataclass(frozen=True)
class Formula:
    """A bound on the Hellinger distance (not squared; 1 is trivial) with everything but n filled in.

    Args:
        text: for tables and legends.
    """

    text: str
    bound: Bound
    others: dict[str, Any]

    def radius(self, n: int) -> float:
        """The certified upper end of the radius for n demonstrations."""
        return self.bound.enclosure(n=n, **self.others).upper

    def first(self, target: float) -> Solution:
        """The smallest n at which the radius is at most ``target``, with its certificates."""
        return solve_for("n", self.bound, target, **self.others)

    def informative(self) -> Solution:
        """The smallest n at which the radius says something: it is below 1, which a capped radius meets for every n."""
        return self.first(math.nextafter(1, 0))


def formulas(truth: Dynamics, expert: IntArray, delta: float) -> dict[str, Formula]:
    """The a-priori radii of a deterministic expert at level 1 - delta.

    Args:
        truth: the real dynamics, used for gamma_min, which the paper's radius needs and no learner knows.
    """
    size = {"S": truth.n_states, "H": truth.horizon, "delta": delta}
    paper = {**size, "A": truth.n_actions, "gamma_min": minimum_visitation(truth, expert)}
    rows = {**size, "rows": truth.n_states}
    return {
        "stated": Formula("stated", theory.offline_radius, paper),
        "corollaries": Formula("stated, its corollaries' 6 for 4", theory.offline_radius_corollaries, paper),
        "repaired": Formula("repaired (T9)", theory.offline_radius_repaired, rows),
        "sharp": Formula("repaired, angle (T9)", theory.offline_radius_repaired_angle, rows),
    }
