"""The offline stage of a seed: demonstrations, the clone, the estimated dynamics, and the sets around the clone."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from bridge_algos.mdp import Dynamics
from bridge_algos.offline.cloning import action_counts, add_action_noise, clone_deterministic
from bridge_algos.offline.policy_set import PolicySet
from bridge_algos.offline.transitions import transition_counts
from bridge_algos.offline.version_space import closed_estimate
from bridge_algos.run.config import RunConfig
from bridge_algos.run.learners import transition_fit
from bridge_algos.run.streams import stream
from bridge_algos.run.world import World
from bridge_algos.shapes import PairCounts, Policy, TransitionCounts
from bridge_algos.trajectories import Trajectories, sample_trajectories


@dataclass(frozen=True, eq=False)
class OfflineStage:
    """What a learner of this seed has before its first question.

    Args:
        demonstrations: as recorded, with noise.
        pairs: (S, A) how often each action was recorded in each state.
        transitions: (S, A, S) transition counts.
        clone: (S,) the deterministic clone.
        estimate: the estimated dynamics.
        radius: of the offline set, as a number.
        closed: whether the offline set is the version space, whose dynamics are the closed estimate.
        version_space: the policies that agree with every demonstration.
    """

    demonstrations: Trajectories
    pairs: PairCounts
    transitions: TransitionCounts
    clone: Policy
    estimate: Dynamics
    radius: float
    closed: bool
    version_space: PolicySet

    @cached_property
    def offline_set(self) -> PolicySet:
        """The configured offline set."""
        return self.version_space if self.closed else PolicySet(self.estimate, self.clone, self.radius)


def offline_stage(config: RunConfig, world: World, seed: int) -> OfflineStage:
    """The offline stage that :func:`bridge_algos.run.seed.run_seed` starts from; it depends on nothing online."""
    mdp = world.mdp
    clean = world.demonstrations
    if clean is None:
        clean = sample_trajectories(mdp, world.expert.policy, config.n_demonstrations, stream(seed, "demonstrations"))
    demonstrations = add_action_noise(clean, config.noise, mdp.n_actions, stream(seed, "noise"))
    pairs = action_counts(demonstrations, mdp.n_states, mdp.n_actions)
    transitions = transition_counts(demonstrations, mdp.n_states, mdp.n_actions)
    clone = clone_deterministic(pairs, stream(seed, "ties"), config.tie_break)
    return OfflineStage(
        demonstrations=demonstrations,
        pairs=pairs,
        transitions=transitions,
        clone=clone,
        estimate=mdp.dynamics.under(transition_fit(config, stream(seed, "network"))(transitions)),
        radius=world.radii[config.radius] if isinstance(config.radius, str) else float(config.radius),
        closed=config.radius == "zero",
        version_space=PolicySet(closed_estimate(mdp, demonstrations, transitions), clone, 0.0),
    )
