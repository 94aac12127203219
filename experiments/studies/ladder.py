r"""The ladder of radii: which radius of the offline set says something at which number of demonstrations.

All radii are on the scale of :math:`H=\sqrt{H^2}\in[0,1]`; a ball of radius 1 keeps every policy. The ball is the one
that BRIDGE searches: deterministic stationary policies around the deterministic clone, under the pooled-count estimate
with the rows without data as configured and the known law of the first state. The data enter through counts by step
alone, which are drawn exactly in law at a cost that does not grow with n
(:mod:`bridge_algos.offline.step_counts`). The radius for stochastic experts (audit T13) is no rung: it holds under
another estimate, with one row for each step, and around a stochastic clone.
"""

from __future__ import annotations

import functools
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.envs.registry import make_mdp
from bridge_algos.expert.experts import Expert, make_expert
from bridge_algos.mdp import FloatArray, TabularMDP
from bridge_algos.offline.cloning import clone_deterministic
from bridge_algos.offline.data_radius import data_dependent_radius, leaving_radius
from bridge_algos.offline.policy_set import PolicySet
from bridge_algos.offline.step_counts import StepCounts, sample_step_counts
from bridge_algos.offline.transitions import EmptyRow, estimate_transitions
from bridge_theory.errors import InputError
from experiments.cells import Cell, run_cells
from experiments.studies.ladder_report import figure, report
from experiments.studies.radius_rules import Formula, formulas

RUNGS = ("stated", "corollaries", "repaired", "sharp", "data", "leaving", "hand", "zero", "expert")
"""Every radius by its key, ``expert`` being the distance that the others are to cover."""


def compute(settings: dict[str, Any], directory: Path, jobs: int) -> xr.Dataset:
    """Radii over (demonstrations, rung, dataset), and exact set sizes of the first ``counted`` data sets."""
    shared = {name: value for name, value in settings.items() if name != "demonstrations"}
    cells = [{**shared, "demonstrations": n} for n in settings["demonstrations"]]
    results = run_cells(measure, cells, directory, jobs, "ladder")
    results = results.drop_vars(list(shared)).swap_dims(cell="demonstrations")
    mdp, expert = _world(settings["environment"], settings["expert"])
    rules = formulas(mdp.dynamics, expert.policy, settings["delta"])
    return results.assign_attrs(
        environment=mdp.name,
        states=mdp.n_states,
        actions=mdp.n_actions,
        horizon=mdp.horizon,
        one_start=int((mdp.initial > 0).sum() == 1),
        delta=settings["delta"],
        hand_radius=settings["hand_radius"],
        published_demonstrations=settings["published_demonstrations"],
        empty_row=settings["empty_row"],
        gamma_min=rules["stated"].others["gamma_min"],
        expert=expert.describe(),
        first=json.dumps({key: _first(rule, settings["hand_radius"]) for key, rule in rules.items()}),
    )


def measure(cell: Cell) -> xr.Dataset:
    """All radii of many data sets of n demonstrations, and the exact share of all A^S policies within each."""
    mdp, expert = _world(cell["environment"], cell["expert"])
    n = cell["demonstrations"]
    fixed = {key: rule.radius(n) for key, rule in formulas(mdp.dynamics, expert.policy, cell["delta"]).items()}
    fixed |= {"hand": float(cell["hand_radius"]), "zero": 0.0}
    draws, ties = (np.random.default_rng([cell["seed"], n, purpose]) for purpose in (0, 1))
    data_sets = sample_step_counts(mdp.dynamics, expert.policy, n, cell["datasets"], draws)
    balls = [_ball(mdp, counts, ties, cell["empty_row"]) for counts in data_sets]
    radii = [
        fixed | _radii_from_data(counts, ball, expert, cell["delta"])
        for counts, ball in zip(data_sets, balls, strict=True)
    ]
    shares = [_shares(ball, radius) for ball, radius in zip(balls[: cell["counted"]], radii, strict=False)]
    # radius zero goes with the closed estimate (audit T8A), whose ball is the version space
    visited = np.array([int((counts.pairs.sum(axis=1) > 0).sum()) for counts in data_sets])
    for share, states in zip(shares, visited, strict=False):
        share["zero"] = float(mdp.n_actions) ** -states
    return xr.Dataset(
        {
            "radius": (("rung", "dataset"), _table(radii), {"units": "Hellinger distance"}),
            "share": (("rung", "counted"), _table(shares), {"units": "share of all deterministic stationary policies"}),
            "visited": ("dataset", visited, {"units": "states"}),
        },
        coords={"rung": list(RUNGS)},
    )


def figures(data: xr.Dataset) -> dict[str, Any]:
    """Radii above, shares of policies kept below."""
    return {"": figure(data)}


def words(data: xr.Dataset) -> str:
    """Where each radius starts to say something, and what covers the hand-set one."""
    return report(data)


def _ball(mdp: TabularMDP, counts: StepCounts, ties: np.random.Generator, empty_row: EmptyRow) -> PolicySet:
    """All policies, around the clone of one data set, under its estimate."""
    estimate = mdp.dynamics.under(estimate_transitions(counts.pooled, empty_row))
    return PolicySet(estimate, clone_deterministic(counts.pairs, ties), 1.0)


def _radii_from_data(counts: StepCounts, ball: PolicySet, expert: Expert, delta: float) -> dict[str, float]:
    return {
        "data": data_dependent_radius(counts, ball.dynamics, ball.center, delta),
        "leaving": leaving_radius(counts, ball.dynamics, ball.center),
        "expert": float(ball.distances(expert.policy[None])[0]),
    }


def _shares(ball: PolicySet, radii: dict[str, float]) -> dict[str, float]:
    everything = ball.dynamics.n_actions**ball.dynamics.n_states
    share = {radius: replace(ball, radius=radius).count() / everything for radius in set(radii.values())}
    return {key: share[radius] for key, radius in radii.items()}


def _table(rows: list[dict[str, float]]) -> FloatArray:
    return np.array([[row[key] for row in rows] for key in RUNGS])


def _first(rule: Formula, hand_radius: float) -> dict[str, Any]:
    informative, hand = rule.informative(), rule.first(hand_radius)
    return {"text": rule.text, "informative": informative.value, "hand": hand.value, "words": informative.words}


@functools.cache
def _world(environment: str, kind: str) -> tuple[TabularMDP, Expert]:
    mdp = make_mdp(environment)
    expert = make_expert(mdp, kind)
    if expert.policy.ndim != 1:
        raise InputError(f"the expert {kind!r} depends on time; the offline set needs a stationary one.")
    return mdp, expert
