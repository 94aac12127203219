r"""The radius of the offline set, by name.

- ``stated``: thm:tabular_confidence_set; needs gamma_min, which only the true dynamics and expert know.
- ``stated-known``: lem:offline_CI_under_known_dyn, for known dynamics.
- ``repaired``: audit T9 with T7(b) for the clone and T6(ii) + T11 for the transitions, over the S rows that the expert
  uses; no gamma_min.
- ``zero``: audit T8, the version space of all policies that agree with the demonstrations; contains a deterministic
  stationary expert surely when the demonstrations are not noisy (see :mod:`bridge_algos.offline.version_space`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

import bridge_theory as theory
from bridge_algos.given import checked
from bridge_algos.mdp import Dynamics
from bridge_algos.occupancy import state_action_occupancies


@checked
def named_radii(truth: Dynamics, expert: ArrayLike, n: int, delta: float) -> dict[str, float]:
    """The radii for n demonstrations at level 1 - delta, rounded up to doubles where they are certified.

    Args:
        truth: the real dynamics, used for gamma_min alone.
        expert: the expert's policy, in any form.
    """
    size = {"S": truth.n_states, "H": truth.horizon, "n": n, "delta": delta}
    gamma_min = minimum_visitation(truth, expert)
    stated = theory.offline_radius.enclosure(**size, A=truth.n_actions, gamma_min=gamma_min)
    known = theory.offline_radius_known.enclosure(S=truth.n_states, A=truth.n_actions, n=n, delta=delta)
    repaired = theory.offline_radius_repaired.enclosure(**size, rows=truth.n_states)
    return {"stated": stated.upper, "stated-known": known.upper, "repaired": repaired.upper, "zero": 0.0}


def minimum_visitation(truth: Dynamics, expert: ArrayLike) -> float:
    """gamma_min (assumption:min_visitation): the smallest positive occupancy d_h(s, a) of the expert over all steps."""
    occupancy = state_action_occupancies(truth, expert)
    return float(np.min(occupancy[occupancy > 0]))
