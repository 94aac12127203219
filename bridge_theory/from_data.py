"""What the demonstrations themselves certify: the data-dependent bounds, from tables of counts."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from bridge_theory.bound import Bound
from bridge_theory.errors import InputError
from bridge_theory.offline.assumptions import DETERMINISTIC
from bridge_theory.offline.kl_budget import (
    offline_radius_stochastic,
    policy_kl_budget,
    transition_error_counts,
    transition_kl_budget,
)
from bridge_theory.offline.missing_mass import missing_mass_observed
from bridge_theory.offline.zero_radius import offline_radius_mass
from bridge_theory.parameters import Given
from bridge_theory.setting import Setting
from bridge_theory.value import BoundValue

IntArray = npt.NDArray[np.integer]


def bounds_from_counts(
    visits: IntArray, transitions: IntArray, *, delta: Given, mass: Given | None = None
) -> dict[str, BoundValue]:
    r"""The data-dependent bounds of one set of demonstrations, each at failure probability ``delta`` on its own.

    Statement: T7(c) from the states without a recorded action, T8(B) from the estimated mass of meeting one, T10 from
    the transition counts (the pooled budget, and the per-step transition error), T13 from the action counts.
    Source: audit T7(c), T8(B), T10, T13. Assumptions: those of the bounds. Arguments: ``visits[h, s, a]`` recorded
    actions (steps ``1..H``), ``transitions[h, s, a, s']`` recorded transitions (steps ``1..H-1``), both of whole
    numbers; ``delta`` in (0, 1); ``mass`` is at least the squared radius of T8(B), computed by dynamic programming
    elsewhere, and without it T8(B) is left out. Returns values by the name of the bound; where the data refute a
    deterministic expert (see ``contradicted_states``), without those that assume one. Errors: ``InputError`` if the
    shapes do not fit, the transitions do not join the visits, or a step does not hold one action per demonstration.

    >>> visits = np.array([[[3, 0], [0, 0]], [[2, 0], [0, 1]]])
    >>> transitions = np.zeros((1, 2, 2, 2), dtype=int)
    >>> transitions[0, 0, 0] = [2, 1]
    >>> values = bounds_from_counts(visits, transitions, delta="0.05")
    >>> values["missing_mass_observed"].enclosure.upper  # every state was acted in
    0.0
    """
    _check(visits, transitions)
    steps, states, actions = visits.shape
    demonstrations = int(visits[0].sum())
    step_state = transitions.sum(axis=(2, 3)).ravel()
    common = {"S": states, "A": actions, "H": steps, "n": demonstrations, "delta": delta}
    given: dict[str, Given] = {
        **common,
        "unvisited": int((visits.sum(axis=(0, 2)) == 0).sum()),
        "visits": visits.sum(axis=2).ravel().tolist(),
    }
    pooled = transitions.sum(axis=(0, 3)).ravel().tolist()
    per_step = step_state.tolist() or [0]  # a horizon of one has no transitions
    values = [
        _value(missing_mass_observed, given),
        _value(transition_kl_budget, {**given, "counts": pooled}),
        _value(transition_error_counts, {**given, "counts": per_step}),
        _value(policy_kl_budget, given),
        _value(offline_radius_stochastic, given),
    ]
    if mass is not None:
        values.append(_value(offline_radius_mass, {"mass": mass}))
    refuted = contradicted_states(visits).size > 0
    return {value.bound.name: value for value in values if not (refuted and DETERMINISTIC in value.bound.assumptions)}


def contradicted_states(visits: IntArray) -> IntArray:
    """The states with more than one recorded action, ascending; a deterministic stationary expert leaves none.

    Arguments: ``visits[h, s, a]`` recorded actions.

    >>> contradicted_states(np.array([[[3, 0], [0, 0]], [[2, 1], [0, 0]]])).tolist()
    [0]
    """
    return np.flatnonzero((visits.sum(axis=0) > 0).sum(axis=1) > 1)


def _value(bound: Bound, given: dict[str, Given]) -> BoundValue:
    return bound.value(Setting(**{name: given[name] for name in bound.parameters}))


def _check(visits: IntArray, transitions: IntArray) -> None:
    shape = visits.shape
    if visits.ndim != 3 or 0 in shape or transitions.shape != (shape[0] - 1, *shape[1:], shape[1]):
        raise InputError(
            f"visits have shape {shape} and transitions {transitions.shape}; expected (H, S, A) and (H-1, S, A, S)"
        )
    if any(not np.issubdtype(table.dtype, np.integer) or table.min(initial=0) < 0 for table in (visits, transitions)):
        raise InputError("visits and transitions must be tables of whole numbers >= 0; convert them with .astype(int)")
    totals = visits.sum(axis=(1, 2))
    if totals[0] == 0 or not np.all(totals == totals[0]):
        raise InputError(
            f"the steps hold {totals.tolist()} recorded actions; expected one per demonstration at every step"
        )
    leaving, arriving = transitions.sum(axis=3), transitions.sum(axis=(1, 2))
    if not (np.array_equal(leaving, visits[:-1]) and np.array_equal(arriving, visits[1:].sum(axis=2))):
        raise InputError(
            "transitions do not join the visits: each step must leave every pair as often as it was visited and "
            "reach every state as often as the next step visits it"
        )
