"""What was fixed before the first answer: environment, features, delta, W, prior and goal."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np

from bridge_algos.envs.registry import make_mdp
from bridge_algos.mdp import TabularMDP
from bridge_algos.mdp_file import load_mdp
from bridge_theory.errors import InputError
from proofs_checks.asking_checker.entries import close, number, part, same, text, vector
from proofs_checks.verify.enclosed import FloatArray
from proofs_checks.verify.features import Coordinates, coordinates

SIMULATED_SHARE = 0.8
"""Of delta, for the answers, where a session had only a simulator and spent the rest on its rollouts."""

ADDITIVE = ("state_action_counts", "state_counts", "identity_short")

PRIOR_SCALES = (1, 4, 16)
"""Precisions of the prior's components must be these multiples of d / W^2."""


@dataclass(frozen=True, eq=False)
class Setting:
    """Args:
    mdp, table: dynamics, and what a step adds to the features.
    delta, weight_bound: of the session.
    precisions: of the prior's components.
    target: nats; the gap at which the goal is reached.
    rho: with a share 1/(1 + rho), else 0.
    teacher: (d,) weights of a simulated teacher, or None for a person.
    simulated: whether the session had only a simulator of the environment.
    """

    mdp: TabularMDP
    table: Coordinates
    delta: float
    weight_bound: float
    precisions: tuple[float, ...]
    target: float
    rho: float
    teacher: FloatArray | None
    simulated: bool


def setting(record: Mapping[str, Any]) -> Setting:
    """Read and check.

    Raises:
        InputError: for an entry that is malformed, or that other entries contradict.
    """
    configured = part(record, "configuration")
    mdp = _environment(text(configured, "environment"))
    embedding = text(configured, "embedding")
    if embedding not in ADDITIVE:
        raise InputError(f"embedding is {embedding!r}, expected one of {', '.join(ADDITIVE)}.")
    table = coordinates(embedding, mdp.n_states, mdp.n_actions, mdp.horizon)
    delta = number(record, "delta", 1e-12, 1 - 1e-12)
    simulated = "dynamics" in configured
    if simulated:
        same("dynamics", configured["dynamics"], "unknown")
    whole_delta = number(configured, "delta", 1e-12, 1 - 1e-12)
    close("delta", delta, SIMULATED_SHARE * whole_delta if simulated else whole_delta, 1e-15)
    weight_bound = number(record, "weight_bound", 1e-9, 1e9)
    precisions = vector(record.get("prior_precisions"), "prior_precisions", len(PRIOR_SCALES))
    for found, scale in zip(precisions.tolist(), PRIOR_SCALES, strict=True):
        close("prior_precisions", found, scale * table.dimension / weight_bound**2)
    teacher = None
    if record.get("teacher") is not None:
        teacher = vector(part(record, "teacher").get("weights"), "the teacher's weights", table.dimension)
        _check_teacher(teacher, weight_bound, configured, table)
    spread = _utility_range(record, configured, mdp, table, teacher)
    target, rho = _goal(record, configured, spread)
    return Setting(mdp, table, delta, weight_bound, tuple(precisions.tolist()), target, rho, teacher, simulated)


def _environment(name: str) -> TabularMDP:
    return load_mdp(name) if name.endswith(".npz") else make_mdp(name)


def _check_teacher(teacher: FloatArray, weight_bound: float, configured: dict[str, Any], table: Coordinates) -> None:
    """W is twice the norm of a simulated teacher's weights, or B W as configured."""
    norm = float(np.linalg.norm(teacher))
    if configured.get("weight_norm") is None:
        close("weight_bound", weight_bound, 2 * norm)
        return
    close("weight_bound", weight_bound, number(configured, "weight_norm", 1e-9, 1e9) / sqrt(table.square_bound))
    if norm > weight_bound * (1 + 1e-9):
        raise InputError(f"the teacher's weights have norm {norm:.6g}, above W = {weight_bound:.6g}.")


def _utility_range(
    record: Mapping[str, Any],
    configured: dict[str, Any],
    mdp: TabularMDP,
    table: Coordinates,
    teacher: FloatArray | None,
) -> float:
    """Best minus worst utility: as declared, and that of a simulated teacher's weights."""
    spread = number(record, "utility_range", 1e-12, 1e9)
    declared = configured.get("utility_range")
    if declared is not None:
        close("utility_range", spread, number(configured, "utility_range", 1e-12, 1e9))
    elif teacher is None:
        raise InputError("utility_range is declared by nobody; the configuration must name it.")
    if teacher is not None:
        close("utility_range", spread, range_of(mdp, table, teacher), 1e-7)
    return spread


def range_of(mdp: TabularMDP, table: Coordinates, weights: FloatArray) -> float:
    """Best minus worst expected utility over all policies, by dynamic programming; an estimate, in floats."""
    reward = np.append(weights, 0.0)[table.places].sum(axis=-1)
    best, worst = np.zeros(mdp.n_states), np.zeros(mdp.n_states)
    for h in reversed(range(mdp.horizon)):
        best = (reward[h] + mdp.transitions @ best).max(axis=1)
        worst = (reward[h] + mdp.transitions @ worst).min(axis=1)
    return float(mdp.initial @ (best - worst))


def _goal(record: Mapping[str, Any], configured: dict[str, Any], spread: float) -> tuple[float, float]:
    """Target and rho that the text of ``until`` means."""
    until = text(record, "until").replace(" ", "")
    same("until", until, text(configured, "until").replace(" ", ""))
    match = re.fullmatch(r"(share=)?(\d+(?:\.\d*)?|\.\d+)(%|nats)", until)
    amount = float(match[2]) if match else 0.0
    if not match or not amount > 0 or (match[1] and match[3] == "nats") or (match[3] == "%" and amount >= 100):
        raise InputError(f"until is {until!r}, expected '10%', '0.2nats' or 'share=90%'.")
    target, rho = number(record, "goal_nats", 0.0, 1e9), number(record, "rho", 0.0, 1e9)
    close("rho", rho, 100 / amount - 1 if match[1] else 0.0)
    close("goal_nats", target, 0.0 if match[1] else amount if match[3] == "nats" else amount / 100 * spread)
    return target, rho
