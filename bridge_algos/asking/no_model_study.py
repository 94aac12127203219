"""Sessions without a model of utility, with a simulated teacher on a tabular environment, a seed each."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from bridge_algos.asking.candidates import LISTED, version_space_candidates
from bridge_algos.asking.config import AskConfig
from bridge_algos.asking.no_model import MOST_ITEMS, PairwiseSession
from bridge_algos.asking.session_file import load_session, record_digest, save_session, session_path
from bridge_algos.asking.study import prepare
from bridge_algos.asking.tabular import simulated_answer
from bridge_algos.asking.utility import Utility
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_algos.run.parallel import check_jobs, for_each
from bridge_algos.run.versions import package_versions
from bridge_algos.trajectories import Trajectories, sample_each, sample_trajectories
from bridge_theory.errors import InputError

KIND, FORMAT = "bridge-rl asking session without a model of utility", 1

SHARED_FIELDS = (
    "environment",
    "embedding",
    "utility_range",
    "weight_norm",
    "delta",
    "n_demonstrations",
    "demonstrations",
    "max_questions",
)
"""What the configuration has in common with asking under the linear model."""

DRAWS = 2000
"""Trajectories of each candidate from which its true preference probabilities are estimated."""


def configuration_record(config: AskConfig, eps: float) -> dict[str, Any]:
    """What such a study is configured by, as plain values."""
    values = asdict(config)
    return {"model": "none", "eps": eps, **{name: values[name] for name in SHARED_FIELDS}}


def run_no_model(config: AskConfig, eps: float, directory: Path, seeds: int, jobs: int = 1) -> list[dict[str, Any]]:
    """Run the seeds 0..seeds-1 that are not stored yet; returns the outcome of each.

    Raises:
        InputError: for too many candidates, or when the directory holds other sessions.
    """
    if seeds < 1:
        raise InputError(f"seeds must be at least 1, got {seeds}.")
    PairwiseSession(1, eps, config.delta, np.random.default_rng(0))  # eps is checked before anything is computed
    check_jobs(jobs)
    mdp, utility, demonstrations = prepare(config)
    stored = [seed for seed in range(seeds) if session_path(directory, seed).exists()]
    for seed in stored:
        if load_session(session_path(directory, seed), KIND)["configuration"] != configuration_record(config, eps):
            raise InputError(f"{directory} holds sessions of another configuration; choose another --out.")
    missing = [seed for seed in range(seeds) if seed not in stored]
    work = [(config, eps, mdp, utility, demonstrations, seed, directory) for seed in missing]
    for_each(run_and_store, work, jobs, f"ask {config.environment}", "session", finished=len(stored))
    return [load_session(session_path(directory, seed), KIND)["outcome"] for seed in range(seeds)]


def run_and_store(
    config: AskConfig,
    eps: float,
    mdp: TabularMDP,
    utility: Utility,
    demonstrations: Trajectories | None,
    seed: int,
    directory: Path,
) -> None:
    """One session, written when it ends."""
    rng = np.random.default_rng(seed)
    if demonstrations is None and config.n_demonstrations:
        demonstrations = sample_trajectories(mdp, utility.best.policy, config.n_demonstrations, rng)
    found = version_space_candidates(mdp, utility.embedding, demonstrations, LISTED, rng)
    if len(found.policies) > MOST_ITEMS:
        raise InputError(
            f"--model none compares every pair of at most {MOST_ITEMS} candidates, got {len(found.policies)} in seed "
            f"{seed}; give more demonstrations, or a model."
        )
    session = PairwiseSession(len(found.policies), eps, config.delta, rng)
    while not session.done and len(session.history) < config.max_questions:
        question = session.ask()
        shown = sample_each(mdp, found.policies[[question.first, question.second]], 1, rng)
        first, second = utility.embedding.of_trajectories(shown)
        session.tell(question, simulated_answer(utility.weights, first - second, rng))
    save_session(session_path(directory, seed), _record(config, eps, mdp, utility, seed, session, found.policies, rng))


def _record(
    config: AskConfig,
    eps: float,
    mdp: TabularMDP,
    utility: Utility,
    seed: int,
    session: PairwiseSession,
    policies: IntArray,
    rng: np.random.Generator,
) -> dict[str, Any]:
    certificate = session.certificate
    own = session.recommended
    others = np.delete(preferences(mdp, utility, policies, rng)[own], own)
    decided = session.certified or session.no_winner
    outcome = {
        "seed": seed,
        "questions": len(session.history) if decided else None,
        "verdict": in_a_word(session),
        "certified_preference": 0.5 - eps if session.certified else None,
        "true_preference_estimate": float(others.min()) if len(others) else None,
        "candidates": len(policies),
        "sentence": certificate.sentence,
    }
    record = {
        "kind": KIND,
        "format": FORMAT,
        "model": "none",
        "configuration": configuration_record(config, eps),
        "seed": seed,
        "versions": package_versions(),
        "candidates": policies.tolist(),
        "questions": [list(row) for row in session.history],
        "recommended": policies[own].tolist(),
        "outcome": outcome,
    }
    return {**record, "digest": record_digest(record)}


def in_a_word(session: PairwiseSession) -> str:
    """How a session ended."""
    if session.contradicted:
        return "contradicted"
    return "certified" if session.certified else "no winner" if session.no_winner else "open"


def preferences(mdp: TabularMDP, utility: Utility, policies: IntArray, rng: np.random.Generator) -> FloatArray:
    """(K, K) estimates of p(i, j) from DRAWS trajectories of each policy; 1/2 on the diagonal."""
    trajectories = sample_each(mdp, policies, DRAWS, rng)
    utilities = (utility.embedding.of_trajectories(trajectories) @ utility.weights).reshape(len(policies), DRAWS)
    found = np.full((len(policies), len(policies)), 0.5)
    for i, j in zip(*np.triu_indices(len(policies), 1), strict=True):
        found[i, j] = float(np.mean(1 / (1 + np.exp(np.subtract.outer(utilities[j], utilities[i])))))
        found[j, i] = 1 - found[i, j]
    return found
