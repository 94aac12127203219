"""The algorithms of a run as learners: what each one searches, knows and trusts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bridge_algos.mdp import FloatArray, IntArray
from bridge_algos.offline.policy_set import PolicySet
from bridge_algos.offline.transitions import estimate_transitions
from bridge_algos.online.confidence import Confidence, fixed, likelihood, repaired, stated
from bridge_algos.online.loop import Learner
from bridge_algos.run.candidates import Candidates, offline_candidates, search_space
from bridge_algos.run.config import RunConfig
from bridge_algos.run.streams import stream
from bridge_algos.run.world import World
from bridge_theory.errors import InputError

WORK_LIMIT = 1e12
"""Multiplications allowed in one step (about a minute), so that a too large problem is refused and not waited for."""


def make_learner(
    name: str, config: RunConfig, world: World, offline: PolicySet, counts: IntArray, seed: int
) -> tuple[Learner, Candidates]:
    """One algorithm of a run, and how the policies it searches were found.

    Args:
        name: bridge, bridge-known or pbrl.
        offline: the offline set; bridge-known takes the ball of its radius under the real dynamics, or the same
            version space.
        counts: (S, A, S) offline transition counts, which pbrl does not see.
        seed: decides candidates and search space.
    """
    mdp = world.mdp
    known = name == "bridge-known"
    # the version space needs no dynamics: it is the same set whether they are known or not
    ball = PolicySet(mdp.dynamics, offline.center, offline.radius) if known and config.radius != "zero" else offline
    if config.candidates == "rejection":
        _afford("proposals", config.proposals, mdp.horizon * mdp.n_states**2)
    if name == "pbrl":
        found = search_space(config, ball, stream(seed, "search"), stream(seed, "candidates"))
    else:
        found = offline_candidates(config, ball, stream(seed, "candidates"))
    limit = "candidate_limit" if config.candidates == "exact" else "search_size"
    _afford(limit, len(found.policies), mdp.horizon * mdp.n_states**2 * mdp.n_actions)
    learner = Learner(
        name=name,
        policies=found.policies,
        counts=None if known else np.zeros_like(counts) if name == "pbrl" else counts,
        confidence=_confidence(config, world, known),
        pair_rule=config.pair_rule,
        weight_bound=world.weight_bound,
        slope=config.slope,
        lam=config.lam,
        comparisons=config.comparisons,
        fit=config.fit,
        rollouts=config.rollouts,
        estimate=transition_fit(config, stream(seed, "network")),
    )
    return learner, found


def transition_fit(config: RunConfig, rng: np.random.Generator) -> Callable[[IntArray], FloatArray]:
    """From pooled transition counts to a kernel, as configured."""
    if config.transition_model == "counts":
        return lambda counts: estimate_transitions(counts, config.empty_row)
    from bridge_algos.continuous.transition_mlp import fit_transition_mlp

    return lambda counts: fit_transition_mlp(counts, rng)


def _afford(entry: str, policies: int, work_per_policy: int) -> None:
    """Refuse a size with which one step of the run would take many minutes."""
    if policies * work_per_policy > WORK_LIMIT:
        raise InputError(
            f"{entry} leads to {policies:,} policies at {work_per_policy:.1e} multiplications each, more than this "
            f"package does in one step ({WORK_LIMIT:.0e}); set {entry} to at most "
            f"{int(WORK_LIMIT // work_per_policy)}, or shorten the horizon."
        )


def _confidence(config: RunConfig, world: World, known: bool) -> Confidence:
    mdp, embedding = world.mdp, world.embedding
    size = (mdp.n_states, mdp.n_actions, mdp.horizon)
    if config.confidence == "fixed":
        return fixed(config.gamma, config.bonus_multiplier, *size, config.lam)
    model = (embedding.bound, world.weight_bound, embedding.dimension)
    if config.confidence == "stated":
        return stated(*model, *size, config.rounds, config.lam, config.delta, known)
    if config.confidence == "likelihood":
        return likelihood(embedding.bound, world.weight_bound, *size, config.lam, config.delta, config.delta)
    return repaired(*model, *size, config.lam, config.delta, config.delta)
