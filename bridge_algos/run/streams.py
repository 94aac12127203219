"""Randomness of a run: one generator a purpose, spawned from one seed."""

from __future__ import annotations

import numpy as np

from bridge_algos.given import checked
from bridge_algos.run.configuration import ALGORITHMS

_TABULAR = ("demonstrations", "noise", "ties", "candidates", "search", "network", *ALGORITHMS)
PURPOSES = (*_TABULAR, "clone", "starts", "held-out", "judge")


@checked
def stream(seed: int, purpose: str) -> np.random.Generator:
    """The generator of one purpose within a seed: a purpose's numbers do not depend on what else is run."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(PURPOSES.index(purpose),)))
