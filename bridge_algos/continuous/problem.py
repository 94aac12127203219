"""The online problem in a simulator: features of the candidates are estimated once, trajectories are played anew."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridge_algos.continuous.config import ContinuousConfig
from bridge_algos.continuous.embeddings import Embedding
from bridge_algos.continuous.environments import draw_starts
from bridge_algos.continuous.episodes import Episodes
from bridge_algos.continuous.offline import OfflineStage
from bridge_algos.continuous.rollouts import rollout
from bridge_algos.mdp import FloatArray, IntArray
from bridge_algos.online.confidence import Confidence
from bridge_algos.online.loop import Learner
from bridge_algos.online.oracles import Oracle


@dataclass(frozen=True, eq=False)
class TrajectoryEmbedding:
    """An embedding as the online loop calls it."""

    embedding: Embedding

    @property
    def dimension(self) -> int:
        return len(self.embedding.scale)

    def of_trajectories(self, episodes: Episodes) -> FloatArray:
        """(n, d) features of single episodes."""
        return self.embedding(episodes)


@dataclass(frozen=True, eq=False)
class SimulatedProblem:
    """A :class:`bridge_algos.online.loop.Problem` whose policies are rows [i] of a table of candidates.

    Args:
        stage: candidates and their features.
        oracle: who answers.
        optimum: [i] of the candidate that looks best among those that any learner may search.
        horizon: H.
    """

    stage: OfflineStage
    oracle: Oracle
    optimum: IntArray
    horizon: int
    w_star: None = None

    @property
    def embedding(self) -> TrajectoryEmbedding:
        """phi of single trajectories."""
        return TrajectoryEmbedding(self.stage.embedding)

    @property
    def expert_return(self) -> float:
        """As seen in the rollouts that made the features."""
        return float(self.stage.features.returns[-1].mean())

    def standing(self, policies: IntArray) -> tuple[FloatArray, float, bool]:
        """Returns of the policies and of the best candidate, as seen in the rollouts, and whether it is among them."""
        returns = self.stage.features.returns.mean(axis=1)
        best = float(returns[self.optimum[0]])
        return returns[policies[:, 0]], best, bool((policies == self.optimum).all(axis=1).any())

    def look(
        self, learner: Learner, counts: IntArray | None, policies: IntArray, rng: np.random.Generator
    ) -> tuple[None, FloatArray, FloatArray]:
        """The features made before; there are no transition counts, and so no bonuses."""
        return None, self.stage.features.mean[policies[:, 0]], np.zeros(len(policies))

    def sample_pair(self, pair: IntArray, n: int, rng: np.random.Generator) -> tuple[Episodes, Episodes]:
        """n episodes of each of two candidates with mean actions; all 2 n start independently."""
        environment, candidates = self.stage.environment, self.stage.candidates

        def play(policy: IntArray) -> Episodes:
            starts = draw_starts(environment, n, rng)
            return rollout(environment, candidates[int(policy[0])], starts, horizon=self.horizon, threads=1)

        return play(pair[0]), play(pair[1])


def make_learner(name: str, config: ContinuousConfig, stage: OfflineStage) -> Learner:
    """``"bridge"``, which searches the offline set, or ``"pbrl"``, which searches all candidates.

    The data matrix takes in the observed differences of single trajectories, as in the published runs.
    """
    searched = np.ones(len(stage.candidates), dtype=bool) if name == "pbrl" else stage.in_ball.copy()
    searched[-1] &= config.include_expert
    confidence = Confidence(
        name="fixed",
        multiplier=lambda _: config.gamma,
        step_bonus=lambda counts: np.zeros(counts.shape),
        bonus_steps=0,
        bonus_cap=np.inf,
        matrix="observed",
        initial_scale=config.initial_scale,
    )
    return Learner(
        name=name,
        policies=np.flatnonzero(searched)[:, None],
        counts=None,
        confidence=confidence,
        pair_rule=config.pair_rule,
        weight_bound=config.weight_bound,
        slope=config.slope,
        lam=config.lam,
        comparisons=config.comparisons,
        fit=config.fit,
        until_decided=config.until_decided,
    )
