"""The algorithms of a run as learners: what each one searches, knows and trusts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bridge_algos.mdp import FloatArray, IntArray
from bridge_algos.offline.policy_set import PolicySet
from bridge_algos.offline.transitions import estimate_transitions
from bridge_algos.online.confidence import Confidence, fixed, likelihood, repaired, stated
from bridge_algos.online.loop import Learner
from bridge_algos.policies import all_policies, random_policies
from bridge_algos.run.config import RunConfig
from bridge_algos.run.streams import stream
from bridge_algos.run.world import World
from bridge_theory.errors import InputError

WORK_LIMIT = 1e12
"""Multiplications allowed in one step (about a minute), so that a too large problem is refused and not waited for."""


def make_learner(
    name: str, config: RunConfig, world: World, offline: PolicySet, counts: IntArray, seed: int
) -> Learner:
    """One algorithm of a run.

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
    policies = _candidates(config, ball, stream(seed, "candidates"))
    if name == "pbrl":
        policies = _search_space(config, policies, mdp.n_states, mdp.n_actions, stream(seed, "search"))
    limit = "candidate_limit" if config.candidates == "exact" else "search_size"
    _afford(limit, len(policies), mdp.horizon * mdp.n_states**2 * mdp.n_actions)
    return Learner(
        name=name,
        policies=policies,
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


def transition_fit(config: RunConfig, rng: np.random.Generator) -> Callable[[IntArray], FloatArray]:
    """From pooled transition counts to a kernel, as configured."""
    if config.transition_model == "counts":
        return lambda counts: estimate_transitions(counts, config.empty_row)
    from bridge_algos.continuous.transition_mlp import fit_transition_mlp

    return lambda counts: fit_transition_mlp(counts, rng)


def _candidates(config: RunConfig, ball: PolicySet, rng: np.random.Generator) -> IntArray:
    """Candidates from the offline set, in random order, so that the order of policies breaks no tie."""
    dynamics = ball.dynamics
    if config.candidates == "rejection":
        _afford("proposals", config.proposals, dynamics.horizon * dynamics.n_states**2)
        policies = ball.rejection_sample(config.proposals, rng)
    elif ball.count() <= config.candidate_limit:
        policies = ball.enumerate(config.candidate_limit)
    else:
        policies = ball.sample(config.candidate_limit, rng)
    return rng.permutation(policies)


def _afford(entry: str, policies: int, work_per_policy: int) -> None:
    """Refuse a size with which one step of the run would take many minutes."""
    if policies * work_per_policy > WORK_LIMIT:
        raise InputError(
            f"{entry} leads to {policies:,} policies at {work_per_policy:.1e} multiplications each, more than this "
            f"package does in one step ({WORK_LIMIT:.0e}); set {entry} to at most "
            f"{int(WORK_LIMIT // work_per_policy)}, or shorten the horizon."
        )


def _search_space(
    config: RunConfig, ball: IntArray, n_states: int, n_actions: int, rng: np.random.Generator
) -> IntArray:
    """PbRL's search space: all policies, or ``search_size`` of which at most half come from the offline set.

    The paper lends PbRL the offline candidates where it cannot search everything; half is the most it gets here, so
    that it never becomes BRIDGE.
    """
    if n_actions**n_states <= config.candidate_limit:
        return rng.permutation(all_policies(n_states, n_actions))
    lent = ball[: config.search_size // 2]
    return rng.permutation(
        np.concatenate([lent, random_policies(config.search_size - len(lent), n_states, n_actions, rng)])
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
