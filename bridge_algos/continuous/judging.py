"""Regret judged on initial states that played no part in any choice.

A policy is chosen by features that are means of rollouts. Its return read off the same rollouts is too high: the choice
favours policies with lucky initial states, the more so where each policy has its own. So every policy that was chosen
in some round is rolled out anew, from initial states that all share with the expert.
"""

from __future__ import annotations

import numpy as np

from bridge_algos.continuous.config import ContinuousConfig
from bridge_algos.continuous.environments import draw_starts
from bridge_algos.continuous.offline import OfflineStage
from bridge_algos.continuous.rollouts import map_rollouts
from bridge_algos.mdp import FloatArray, IntArray
from bridge_algos.run.streams import stream


def judged_gaps(
    config: ContinuousConfig, stage: OfflineStage, seed: int, chosen: IntArray, threads: int | None = None
) -> FloatArray:
    """The expert's return less the candidate's from each of n fresh initial states, (N, n); nan for those not chosen.

    Args:
        chosen: indices of candidates, repeated or not.
        threads: of the rollouts; does not change the numbers.
    """
    expert = len(stage.candidates) - 1
    wanted = np.unique(np.append(chosen, expert))
    returns = map_rollouts(
        stage.environment,
        [stage.candidates[index] for index in wanted],
        draw_starts(stage.environment, config.rollouts, stream(seed, "judge")),
        lambda episodes: episodes.returns[:, None],
        horizon=config.horizon,
        threads=threads,
    )[:, :, 0]
    gaps = np.full((len(stage.candidates), config.rollouts), np.nan)
    gaps[wanted] = returns[-1] - returns
    return gaps
