"""One seed of a run: demonstrations, offline stage, every algorithm's online stage, as one labelled data set."""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib.metadata import version
from typing import Any

import numpy as np
import xarray as xr
from threadpoolctl import threadpool_limits

from bridge_algos.evaluation import expected_return, expected_returns
from bridge_algos.hellinger import squared_hellinger
from bridge_algos.mdp import FloatArray, IntArray
from bridge_algos.offline.cloning import action_counts, add_action_noise, clone_deterministic
from bridge_algos.offline.policy_set import PolicySet
from bridge_algos.offline.transitions import estimate_transitions, transition_counts
from bridge_algos.online.confidence import Confidence, fixed, repaired, stated
from bridge_algos.online.loop import RECORDED, Learner, OnlineProblem, run_online
from bridge_algos.policies import all_policies, random_policies
from bridge_algos.run.config import ALGORITHMS, RunConfig
from bridge_algos.run.world import World, build_oracle
from bridge_algos.trajectories import sample_trajectories
from bridge_theory.errors import InputError

PACKAGES = ("bridge-rl", "numpy", "scipy", "xarray", "cvxpy", "highspy", "python-flint", "gymnasium")

WORK_LIMIT = 1e12
"""Multiplications allowed in one step (about a minute), so that a too large problem is refused and not waited for."""

UNITS = {
    "pseudo_regret": "reward per trajectory",
    "suboptimality": "reward per trajectory",
    "set_size": "policies",
    "optimum_kept": "1 = yes",
    "weight_error": "norm of w",
    "uncertainty": "norm of phi in the inverse data matrix",
    "bonus_sum": "utility",
    "gamma": "none",
    "log_det": "nats",
    "seconds": "s",
}


def stream(seed: int, purpose: str) -> np.random.Generator:
    """The generator of one purpose within a seed: a purpose's numbers do not depend on what else is run."""
    purposes = ("demonstrations", "noise", "ties", "candidates", "search", "network", *ALGORITHMS)
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(purposes.index(purpose),)))


def run_seed(config: RunConfig, world: World, seed: int) -> xr.Dataset:
    """All algorithms of a configuration on one seed.

    Returns:
        A data set with one variable per name in ``RECORDED`` over (algorithm, round), the offline stage's numbers as
        scalars, and configuration, seed and versions as attributes. The numbers depend on configuration and seed only.
    """
    with threadpool_limits(1):
        return _run_seed(config, world, seed)


def _run_seed(config: RunConfig, world: World, seed: int) -> xr.Dataset:
    mdp = world.mdp
    clean = world.demonstrations
    if clean is None:
        clean = sample_trajectories(mdp, world.expert.policy, config.n_demonstrations, stream(seed, "demonstrations"))
    demonstrations = add_action_noise(clean, config.noise, mdp.n_actions, stream(seed, "noise"))
    pairs = action_counts(demonstrations, mdp.n_states, mdp.n_actions)
    counts = transition_counts(demonstrations, mdp.n_states, mdp.n_actions)
    clone = clone_deterministic(pairs, stream(seed, "ties"), config.tie_break)
    fit = _transition_fit(config, stream(seed, "network"))
    estimate = mdp.dynamics.under(fit(counts))
    radius = world.radii[config.radius] if isinstance(config.radius, str) else float(config.radius)
    problem = OnlineProblem(
        mdp, world.embedding, build_oracle(config, world), world.optimum, world.expert.expected_return, world.w_star
    )
    offline = PolicySet(estimate, clone, radius)
    records, best = {}, {}
    for name in config.algorithms:
        if name == "bc":
            records[name] = _constant(config, world, clone)
            best[name] = records[name]["suboptimality"][0]
            continue
        known = name == "bridge-known"
        ball = PolicySet(mdp.dynamics, clone, radius) if known else offline
        policies = _candidates(config, ball, stream(seed, "candidates"))
        if name == "pbrl":
            policies = _search_space(config, policies, mdp.n_states, mdp.n_actions, stream(seed, "search"))
        name_of_limit = "candidate_limit" if config.candidates == "exact" else "search_size"
        _afford(name_of_limit, len(policies), mdp.horizon * mdp.n_states**2 * mdp.n_actions)
        learner = Learner(
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
            estimate=fit,
        )
        records[name] = run_online(problem, learner, config.rounds, stream(seed, name))
        best[name] = world.expert.expected_return - expected_returns(mdp, policies).max()
    distance = np.sqrt(squared_hellinger(estimate, world.expert.policy, estimate, clone))
    scalars = {
        "clone_return": (expected_return(mdp, clone), "reward per trajectory"),
        "expert_distance": (distance, "Hellinger distance to the clone under the estimate"),
        "optimum_in_offline_set": (float(offline.contains(world.optimum)), "1 = yes"),
        "states_visited": (float((pairs.sum(axis=1) > 0).sum()), "states"),
        "radius": (radius, "Hellinger distance"),
        "offline_set_count": (_count(offline), "policies"),
    }
    for name, value in world.radii.items():
        scalars[f"radius_{name}"] = (value, "Hellinger distance")
        scalars[f"expert_in_{name}"] = (float(distance <= value + 1e-9), "1 = yes")
    return _dataset(config, world, seed, records, scalars).assign(
        best_candidate=("algorithm", list(best.values()), {"units": "reward per trajectory below the expert"})
    )


def _constant(config: RunConfig, world: World, clone: IntArray) -> dict[str, FloatArray]:
    """The record of playing the clone for ever."""
    value = expected_return(world.mdp, clone)
    record = {name: np.full(config.rounds, np.nan) for name in RECORDED}
    record["suboptimality"][:] = world.expert.expected_return - value
    record["pseudo_regret"][:] = world.expert.best_stationary.value - value
    record["set_size"][:] = 1
    return record


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
    """PbRL's search space: all policies, or the offline candidates and random policies up to ``search_size``."""
    if n_actions**n_states <= config.candidate_limit:
        return rng.permutation(all_policies(n_states, n_actions))
    missing = max(0, config.search_size - len(ball))
    return rng.permutation(np.concatenate([ball, random_policies(missing, n_states, n_actions, rng)]))


def _transition_fit(config: RunConfig, rng: np.random.Generator) -> Callable[[IntArray], FloatArray]:
    if config.transition_model == "counts":
        return lambda counts: estimate_transitions(counts, config.empty_row)
    from bridge_algos.continuous.transition_mlp import fit_transition_mlp

    return lambda counts: fit_transition_mlp(counts, rng)


def _confidence(config: RunConfig, world: World, known: bool) -> Confidence:
    mdp, embedding = world.mdp, world.embedding
    size = (mdp.n_states, mdp.n_actions, mdp.horizon)
    if config.confidence == "fixed":
        return fixed(config.gamma, config.bonus_multiplier, *size, config.lam)
    model = (embedding.bound, world.weight_bound, embedding.dimension)
    if config.confidence == "stated":
        return stated(*model, *size, config.rounds, config.lam, config.delta, known)
    return repaired(*model, *size, config.lam, config.delta, config.delta)


def _count(offline: PolicySet) -> float:
    try:
        return float(offline.count())
    except (InputError, OverflowError):
        return float("nan")


def _dataset(
    config: RunConfig,
    world: World,
    seed: int,
    records: dict[str, dict[str, FloatArray]],
    scalars: dict[str, tuple[float, str]],
) -> xr.Dataset:
    names = list(records)
    variables: dict[str, Any] = {
        name: (("algorithm", "round"), np.stack([records[algorithm][name] for algorithm in names]), {"units": unit})
        for name, unit in UNITS.items()
    }
    variables |= {name: ((), value, {"units": unit}) for name, (value, unit) in scalars.items()}
    return xr.Dataset(
        variables,
        coords={"algorithm": names, "round": np.arange(1, config.rounds + 1), "seed": seed},
        attrs={
            "title": f"BRIDGE companion: {config.environment}, seed {seed}",
            "configuration": config.to_json(),
            "versions": json.dumps({package: _version(package) for package in PACKAGES}),
            "expert": world.expert.describe(),
            "expert_return": world.expert.expected_return,
            "optimum_return": world.expert.best_stationary.value,
            "optimum_upper": world.expert.best_stationary.upper,
            "utility_scale": world.utility_scale,
        },
    )


def _version(package: str) -> str:
    try:
        return version(package)
    except ModuleNotFoundError:
        return "not installed"
