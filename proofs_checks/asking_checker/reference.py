"""The policy that shares are measured against, from its name: its features are computed and compared."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from bridge_theory.errors import InputError
from proofs_checks.asking_checker.candidates import Candidates, stochastic_features
from proofs_checks.asking_checker.entries import text, vector
from proofs_checks.asking_checker.setting import Setting
from proofs_checks.verify.enclosed import Enclosed
from proofs_checks.verify.features import IntArray

AGREE = 1e-9
"""What recorded features may differ from computed ones."""


def reference(
    record: Mapping[str, Any], configured: dict[str, Any], fixed: Setting, listed: Candidates, recorded: IntArray
) -> Enclosed:
    """(d,) features of the named reference, enclosed.

    Raises:
        InputError: when the recorded features are not those of that policy.
    """
    name, d = text(configured, "reference"), fixed.table.dimension
    given = vector(record.get("reference"), "reference", d)
    if name == "worst":
        return _worst(given, fixed, listed)
    if name not in ("random", "clone"):
        raise InputError(f"reference is {name!r}, expected random, clone or worst.")
    n_states, n_actions = fixed.mdp.n_states, fixed.mdp.n_actions
    policy = np.full((n_states, n_actions), 1 / n_actions)
    if name == "clone":
        policy[recorded >= 0] = np.eye(n_actions)[recorded[recorded >= 0]]
    found = stochastic_features(fixed.mdp, fixed.table, policy)
    if np.abs(found.mid - given).max() > AGREE * max(1.0, found.size):
        raise InputError(f"the recorded features of the reference are not those of the policy {name!r}.")
    return found


def _worst(given: np.ndarray, fixed: Setting, listed: Candidates) -> Enclosed:
    """The candidate whose features are recorded; for a simulated teacher it must be the worst one."""
    distances = np.abs(listed.features - given).max(axis=1)
    index = int(distances.argmin())
    if distances[index] > AGREE * max(1.0, float(np.abs(given).max())):
        raise InputError("the reference is none of the candidates.")
    if fixed.teacher is not None:
        utilities = listed.features @ fixed.teacher
        if utilities[index] > utilities.min() + 1e-7 * max(1.0, float(np.abs(utilities).max())):
            raise InputError("the reference is not the worst candidate.")
    return Enclosed(listed.features[index], float(listed.radii[index]))
