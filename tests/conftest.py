"""Deterministic tests and a figure backend without a screen."""

import matplotlib
import numpy as np
import pytest
from hypothesis import HealthCheck, settings

from bridge_algos.mdp import Dynamics

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
    weights = rng.random((n_states, n_actions, n_states)) * (rng.random((n_states, n_actions, n_states)) < 0.6)
    weights[..., 0] += 1e-3
    start = rng.random(n_states)
    return Dynamics(weights / weights.sum(axis=2, keepdims=True), start / start.sum(), horizon)
