"""Asking on a tabular MDP: demonstrations, candidates, a pool of simulated trajectories, and a simulated teacher."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import expit

from bridge_algos.asking.candidates import LISTED, Candidates, deviations, recorded_actions, version_space_candidates
from bridge_algos.asking.elicitation import Ball, Elicitation
from bridge_algos.asking.utility import Utility, step_features
from bridge_algos.demonstrations import checked_demonstrations
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_algos.occupancy import state_action_occupancies
from bridge_algos.trajectories import Trajectories, sample_each, sample_trajectories

POOL = 20_000
"""Trajectories simulated for the pool, one of each of so many candidates."""

KEPT = 2000
"""Candidates whose rivals are remembered; those that decide come up again and again."""

REFERENCES = ("random", "clone", "worst")
"""Whom shares are measured against: the uniformly random policy, the clone (uniform where
nothing was demonstrated), or the candidate that is worst for the simulated teacher."""

OFFLINE = (
    "the demonstrator is deterministic and best for the teacher's utility, so that the best policy agrees with every "
    "demonstration (audit T8)",
    0.0,
)
SAMPLED = (
    "the best of these candidates is meant: they are a sample of the policies that agree with the demonstrations",
    0.0,
)


@dataclass(frozen=True, eq=False)
class Problem:
    """What a session is about.

    Args:
        mdp: known dynamics.
        utility: of the simulated teacher.
        demonstrations: that the candidates agree with, or None.
        candidates: policies to choose from.
        pool: the M trajectories that questions show.
        owners: (M,) candidate that each was drawn from.
    """

    mdp: TabularMDP
    utility: Utility
    demonstrations: Trajectories | None
    candidates: Candidates
    pool: Trajectories
    owners: IntArray

    def reference(self, name: str) -> FloatArray:
        """(d,) features of a reference: one of REFERENCES."""
        if name == "worst":
            return np.asarray(self.candidates.features[int((self.candidates.features @ self.utility.weights).argmin())])
        n_states, n_actions = self.mdp.n_states, self.mdp.n_actions
        policy = np.full((n_states, n_actions), 1 / n_actions)
        if name == "clone" and self.demonstrations is not None:
            recorded = recorded_actions(self.demonstrations, n_states)
            policy[recorded >= 0] = np.eye(n_actions)[recorded[recorded >= 0]]
        visits = state_action_occupancies(self.mdp.dynamics, policy).sum(axis=0)
        return np.asarray(np.einsum("sa,sad->d", visits, step_features(self.utility.embedding.name, self.mdp)))

    def session(
        self, until: str, delta: float, asking: str, rng: np.random.Generator, reference: str = "random"
    ) -> Elicitation:
        """A session with a simulated teacher, for whom the same pair asked again is a fresh draw."""
        candidates = self.candidates

        known: dict[int, FloatArray] = {}

        def rivals(index: IntArray) -> FloatArray:
            new = np.array([i for i in index.tolist() if i not in known], dtype=np.int64)
            if len(known) > KEPT:
                known.clear()
                new = index
            if len(new):
                found = deviations(self.mdp, self.utility.embedding, candidates.policies[new])
                known.update(zip(new.tolist(), found, strict=True))
            return np.stack([known[i] for i in index.tolist()])

        return Elicitation(
            candidates.features,
            Ball(self.utility.weight_bound),
            self.utility.embedding.of_trajectories(self.pool),
            delta,
            until,
            rng,
            utility_range=self.utility.utility_range,
            reference=self.reference(reference),
            rivals=rivals if candidates.complete else None,
            owners=self.owners,
            asking=asking,
            fresh=True,
            offline=OFFLINE if candidates.complete else SAMPLED,
        )

    def true_gap(self, candidate: int) -> float:
        """Nats by which the best candidate's utility exceeds this one's."""
        utilities = self.candidates.features @ self.utility.weights
        return float(utilities.max() - utilities[candidate])


def build_problem(
    mdp: TabularMDP,
    utility: Utility,
    n_demonstrations: int,
    rng: np.random.Generator,
    demonstrations: Trajectories | None = None,
    limit: int = LISTED,
    pool: int = POOL,
) -> Problem:
    """A problem with demonstrations of the utility's best policy, or with given ones."""
    if demonstrations is not None:
        checked_demonstrations(mdp, demonstrations)
    elif n_demonstrations:
        demonstrations = sample_trajectories(mdp, utility.best.policy, n_demonstrations, rng)
    candidates = version_space_candidates(mdp, utility.embedding, demonstrations, limit, rng)
    owners = rng.integers(len(candidates.policies), size=pool)
    trajectories = sample_each(mdp, candidates.policies[owners], 1, rng)
    return Problem(mdp, utility, demonstrations, candidates, trajectories, owners)


def simulated_answer(weights: FloatArray, difference: FloatArray, rng: np.random.Generator) -> int:
    """The answer of a Bradley-Terry teacher."""
    return int(rng.random() < expit(difference @ weights))
