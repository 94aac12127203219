"""Deterministic tests, array shapes checked at run time in the numerical modules, figures without a screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib
import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from jaxtyping import install_import_hook

if TYPE_CHECKING:
    from bridge_algos.mdp import Dynamics

# The other modules take what users pass and explain what is wrong with it, so their types are not enforced here.
NUMERICAL = ("occupancy", "hellinger", "offline.ball_cubes", "online.preference_model", "online.policy_filter")
install_import_hook([f"bridge_algos.{name}" for name in NUMERICAL], "beartype.beartype")
matplotlib.use("Agg")
settings.register_profile(
    "deterministic",
    derandomize=True,
    database=None,
    deadline=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("deterministic")


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20251)


def random_dynamics(rng: np.random.Generator, n_states: int, n_actions: int, horizon: int) -> Dynamics:
    """Dynamics with sparse random rows, so that supports differ and some states are hard to reach."""
    from bridge_algos.mdp import Dynamics

    weights = rng.random((n_states, n_actions, n_states)) * (rng.random((n_states, n_actions, n_states)) < 0.6)
    weights[..., 0] += 1e-3
    start = rng.random(n_states)
    return Dynamics(weights / weights.sum(axis=2, keepdims=True), start / start.sum(), horizon)
