"""Sessions with simulated teachers, a seed each: stored, resumed, and summarised."""

from __future__ import annotations

from math import inf, log
from pathlib import Path
from typing import Any

import numpy as np

from bridge_algos.asking.config import AskConfig
from bridge_algos.asking.rollouts import simulated_session
from bridge_algos.asking.session_file import load_session, save_session, session_path, session_record
from bridge_algos.asking.tabular import build_problem, simulated_answer
from bridge_algos.asking.utility import Utility, simulated_utility
from bridge_algos.demonstrations import load_demonstrations
from bridge_algos.embeddings import make_embedding
from bridge_algos.envs.registry import make_mdp
from bridge_algos.mdp import TabularMDP
from bridge_algos.mdp_file import load_mdp
from bridge_algos.run.parallel import check_jobs, for_each
from bridge_algos.trajectories import Trajectories
from bridge_theory.errors import InputError


def run_study(config: AskConfig, directory: Path, seeds: int, jobs: int = 1) -> list[dict[str, Any]]:
    """Run the seeds 0..seeds-1 that are not stored yet; returns the outcome of each.

    Raises:
        InputError: when the directory holds sessions of another configuration.
    """
    if seeds < 1:
        raise InputError(f"seeds must be at least 1, got {seeds}.")
    check_jobs(jobs)
    mdp, utility, demonstrations = prepare(config)
    stored = [seed for seed in range(seeds) if session_path(directory, seed).exists()]
    for seed in stored:
        if load_session(session_path(directory, seed))["configuration"] != config.record():
            raise InputError(f"{directory} holds sessions of another configuration; choose another --out.")
    missing = [seed for seed in range(seeds) if seed not in stored]
    work = [(config, mdp, utility, demonstrations, seed, directory) for seed in missing]
    label = f"ask {config.environment}, {config.n_demonstrations} demonstrations"
    for_each(run_and_store, work, jobs, label, "session", finished=len(stored))
    return [load_session(session_path(directory, seed))["outcome"] for seed in range(seeds)]


def prepare(config: AskConfig) -> tuple[TabularMDP, Utility, Trajectories | None]:
    """The environment, the teacher's utility, and the demonstrations of the configured file."""
    file = config.environment.endswith(".npz")
    mdp = load_mdp(config.environment) if file else make_mdp(config.environment)
    norm = config.weight_norm
    if norm is not None:
        norm /= make_embedding(config.embedding, mdp.n_states, mdp.n_actions, mdp.horizon).bound
    utility = simulated_utility(mdp, config.embedding, config.utility_range, norm)
    path = config.demonstrations
    return mdp, utility, None if path is None else load_demonstrations(path, mdp)


def run_and_store(
    config: AskConfig,
    mdp: TabularMDP,
    utility: Utility,
    demonstrations: Trajectories | None,
    seed: int,
    directory: Path,
) -> None:
    """One session, written when it ends."""
    save_session(session_path(directory, seed), run_session(config, mdp, utility, demonstrations, seed))


def run_session(
    config: AskConfig, mdp: TabularMDP, utility: Utility, demonstrations: Trajectories | None, seed: int
) -> dict[str, Any]:
    """The record of one session, all of whose randomness comes from the seed."""
    rng = np.random.default_rng(seed)
    n, until, delta, asking = config.n_demonstrations, config.until, config.delta, config.asking
    rollouts = None
    if config.dynamics == "unknown":
        rollouts = simulated_session(mdp, utility, n, rng, until, delta, asking, demonstrations, config.pool)
        problem, session = rollouts.problem, rollouts.session
    else:
        problem = build_problem(mdp, utility, n, rng, demonstrations, config.limit, config.pool)
        session = problem.session(until, delta, asking, rng, config.reference)
    covered = True
    while not session.done and len(session.history) < config.max_questions:
        question = session.ask()
        session.tell(question, simulated_answer(utility.weights, question.difference, rng))
        level = session.evidence.value - log(1 / session.delta)
        covered &= bool(session.answers.log_likelihood(utility.weights[None])[0] >= level)
    outcome = {
        "seed": seed,
        "questions": len(session.history) if session.certified else None,
        "certified_gap": session.certificate.gap,
        "true_gap": problem.true_gap(session.recommended) if rollouts is None else rollouts.true_gap(),
        "covered": covered,
        "contradicted": session.contradicted,
        "candidates": len(problem.candidates.policies),
    }
    if rollouts is not None:
        outcome["episodes"] = rollouts.episodes
    return session_record(config.record(), seed, problem, session, outcome)


def summary(outcomes: list[dict[str, Any]]) -> dict[str, Any]:
    """Medians and quantiles of the questions, where a session without a certificate counts as infinite."""
    questions = np.array([inf if row["questions"] is None else row["questions"] for row in outcomes])
    episodes = [row["episodes"] for row in outcomes if "episodes" in row]
    several = questions[np.array([row["candidates"] > 1 for row in outcomes])]
    return {
        "median_questions": _finite(np.quantile(questions, 0.5, method="higher")),
        "quantile_90": _finite(np.quantile(questions, 0.9, method="higher")),
        "median_where_something_is_open": _finite(np.quantile(several, 0.5, method="higher")) if len(several) else None,
        "seeds_with_one_candidate": len(questions) - len(several),
        "certified": int(np.isfinite(questions).sum()),
        "contradicted": sum(row.get("contradicted", False) for row in outcomes),
        "not_covered": sum(not row["covered"] for row in outcomes),
        "median_episodes": float(np.median(episodes)) if episodes else None,
        "seeds": outcomes,
    }


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
