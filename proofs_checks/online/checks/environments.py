"""The paper's empirical claims on whole runs: random MDPs of several families, StarMDP, Gridworld, FrozenLake."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from proofs_checks.context import Context
from proofs_checks.coverage import Coverage
from proofs_checks.outcome import Outcome, Tally

_DELTA = Fraction(1, 4)
"""Large, so that few runs decide: 50 runs without a failure put the failure probability below it."""

_SLACK = 1e-7


def mdp_of(name: str, rng: np.random.Generator) -> Any:
    """An environment by name, or a random MDP of a family."""
    from bridge_algos.envs.families import chain, garnet
    from bridge_algos.envs.registry import make_mdp

    if name == "garnet":
        return garnet(4, 2, 2, rng, horizon=3)
    if name == "dense garnet":
        return garnet(3, 3, 3, rng, horizon=2)
    if name == "chain":
        return chain(4, slip=float(rng.uniform(0, 0.3)), horizon=4)
    return make_mdp(name, horizon=6)


def good_runs(
    context: Context, *, environment: str = "garnet", known: bool = True, shrink: float = 1.0, rounds: int = 15
) -> Outcome:
    """The best policy is in Pi_t for all t, and in the same runs R4 bounds the realised pseudo-regret."""
    from threadpoolctl import threadpool_limits

    import proofs_checks.online.checks.runs  # noqa: F401  (loads every linear-algebra library before they are limited)

    trials = context.pick(quick=50, full=70)
    failures, worst = 0, 0.0
    for rng in context.rng().spawn(trials):
        with threadpool_limits(1):
            outcome = _run(environment, known, shrink, rounds, rng)
        bounds = outcome.bounds()
        ordered = bounds["optimism"] <= bounds["width"] + _SLACK
        good = outcome.best_is_kept and ordered and min(bounds.values()) >= outcome.regret - _SLACK
        failures += not good
        worst = max(worst, outcome.regret / max(min(bounds.values()), 1e-12))
    kind = "known" if known else "unknown"
    return Coverage(_DELTA, trials, failures).outcome(
        f"{environment}, {kind} dynamics, regret at most {worst:.2f} of the best bound"
    )


def _run(environment: str, known: bool, shrink: float, rounds: int, rng: np.random.Generator) -> Any:
    from bridge_algos.embeddings import make_embedding
    from bridge_algos.offline.transitions import transition_counts
    from bridge_algos.online.confidence import repaired
    from bridge_algos.policies import random_policies
    from bridge_algos.trajectories import sample_trajectories
    from proofs_checks.online.checks.runs import play

    mdp = mdp_of(environment, rng)
    size = (mdp.n_states, mdp.n_actions, mdp.horizon)
    embedding = make_embedding("state_action_counts", *size)
    policies = np.unique(random_policies(24, *size[:2], rng), axis=0)
    w_star = rng.normal(size=embedding.dimension)
    weight_bound, lam, share = 0.3, 0.05, float(_DELTA) / (1 if known else 2)
    w_star *= weight_bound / np.linalg.norm(w_star)
    confidence = repaired(embedding.bound, weight_bound, embedding.dimension, *size, lam, share, share)
    counts = None
    if not known:
        expert = policies[rng.integers(len(policies))]
        counts = transition_counts(sample_trajectories(mdp, expert, 20, rng), *size[:2])
    return play(
        mdp, policies, embedding, w_star, confidence, rounds, rng, lam=lam, weight_bound=weight_bound, counts=counts,
        shrink=shrink,
    )  # fmt: skip


def offline_geometry(context: Context, *, environment: str = "starmdp", factor: float = 1.0) -> Outcome:
    """The expert is at distance 0 of its clone (closed counts), and features in a ball differ by at most 4 B r^2."""
    from bridge_algos.embeddings import expected_features, make_embedding
    from bridge_algos.hellinger import disagreement_probability
    from bridge_algos.offline.cloning import action_counts, clone_deterministic
    from bridge_algos.offline.policy_set import PolicySet
    from bridge_algos.offline.transitions import estimate_transitions, transition_counts
    from bridge_algos.policies import random_policies
    from bridge_algos.trajectories import sample_trajectories

    tally = Tally()
    for rng in context.rng().spawn(context.pick(quick=4, full=20)):
        mdp = mdp_of(environment, rng)
        size = (mdp.n_states, mdp.n_actions)
        expert = rng.integers(size[1], size=size[0])
        demonstrations = sample_trajectories(mdp, expert, 3, rng)
        clone = clone_deterministic(action_counts(demonstrations, *size), rng)
        estimate = mdp.dynamics.under(estimate_transitions(transition_counts(demonstrations, *size)))
        start = np.bincount(demonstrations.states[:, 0], minlength=size[0]) / len(demonstrations)
        closed = type(estimate)(estimate.transitions, start, mdp.horizon)
        tally.expect(
            bool(PolicySet(closed, clone, 0.0).contains(expert)), f"{environment}: the expert is outside radius 0"
        )
        policies = np.where(rng.random((30, size[0])) < 0.2, random_policies(30, *size, rng), clone)
        radius = np.sqrt(disagreement_probability(mdp.dynamics, clone, (policies != clone).astype(float)).max())
        embedding = make_embedding("state_action_counts", *size, mdp.horizon)
        features = expected_features(mdp.dynamics, policies, embedding)[0]
        widest = np.linalg.norm(features[:, None] - features[None], axis=2).max()
        bound = 4 * embedding.bound * float(radius) ** 2 * factor
        tally.expect(bool(widest <= bound + _SLACK), f"{environment}: features differ by {widest:.3g} > {bound:.3g}")
    return tally.outcome(f"{environment}: expert at radius 0, features within 4 B r^2")
