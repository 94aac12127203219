"""Random networks for tests of rollouts."""

from itertools import pairwise

import numpy as np

from bridge_algos.continuous.environments import Environment
from bridge_algos.continuous.policies import MlpPolicy


def random_policy(environment: Environment, seed: int, hidden: int = 16, gain: float = 1.0) -> MlpPolicy:
    """Two hidden layers of normal weights, scaled by ``gain``, and biases 0.1 times normal."""
    rng = np.random.default_rng(seed)
    sizes = [environment.observation_size, hidden, hidden, environment.action_size]
    weights = tuple(gain * rng.normal(size=(a, b)) / a**0.5 for a, b in pairwise(sizes))
    return MlpPolicy(weights, tuple(0.1 * rng.normal(size=b) for b in sizes[1:]), std=np.full(sizes[-1], 0.3))
