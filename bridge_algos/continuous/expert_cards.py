"""What an expert's card says: how it was trained, with which versions, and what it returns."""

from __future__ import annotations

from typing import Any

import numpy as np

from bridge_algos.continuous.environments import Environment, draw_starts
from bridge_algos.continuous.policies import Policy
from bridge_algos.continuous.rollouts import map_rollouts
from bridge_algos.run.versions import package_versions

STUDY_HORIZONS = {"reacher": 50, "ant": 100}
"""Steps of an episode in the paper's experiments (appendix "Environments")."""
PUBLISHED_RETURNS = {"reacher": -4.39, "ant": 320.4}
"""Mean returns of the authors' experts over these steps (the authors' published runs)."""
EVALUATION_EPISODES = 1000
EVALUATION_SEED = 1_000_000


def study_horizon(environment: Environment) -> int:
    """The paper's number of steps, or the environment's own for those it does not study."""
    return STUDY_HORIZONS.get(environment.name, environment.max_steps)


def evaluation(
    environment: Environment,
    policy: Policy,
    *,
    episodes: int = EVALUATION_EPISODES,
    seed: int = EVALUATION_SEED,
    horizon: int | None = None,
    sampled: bool = False,
    threads: int | None = None,
    progress: bool = False,
) -> dict[str, Any]:
    """Mean return of a policy over fresh episodes, with its standard error; mean actions unless ``sampled``."""
    rng = np.random.default_rng(seed)
    starts = draw_starts(environment, episodes, rng)
    steps = horizon or study_horizon(environment)
    table = map_rollouts(
        environment,
        [policy],
        starts,
        lambda block: np.column_stack([block.returns, block.terminated]),
        horizon=steps,
        rng=rng if sampled else None,
        threads=threads,
        progress=progress,
    )[0]
    returns, ended = table.T
    return {
        "episodes": episodes,
        "horizon": steps,
        "seed": seed,
        "actions": "sampled" if sampled else "mean",
        "return": float(returns.mean()),
        "standard_error": float(returns.std(ddof=1) / np.sqrt(episodes)) if episodes > 1 else float("nan"),
        "terminated": int(ended.sum()),
    }


def describe(
    environment: Environment,
    policy: Policy,
    algorithm: str,
    settings: dict[str, Any],
    seed: int,
    command: str,
    *,
    horizon: int | None,
    threads: int | None,
) -> dict[str, Any]:
    """The card of a trained expert, evaluated over 1,000 episodes that training did not see."""
    return {
        "environment": environment.gymnasium_id,
        "algorithm": algorithm,
        "command": command,
        "settings": settings,
        "seed": seed,
        "versions": package_versions(),
        "evaluation": evaluation(environment, policy, horizon=horizon, threads=threads),
        "published_return": PUBLISHED_RETURNS.get(environment.name),
    }
