r"""Certified answers: how many questions certify a recommendation, and how the certified gap falls.

Sessions of :mod:`bridge_algos.asking` with a simulated teacher of a declared range, for several numbers of
demonstrations and ways of asking; beside them what the earlier certificate (audit R1, whose width contains kappa) would
need, and an estimate of what no method can undercut (companion G9).
"""

from __future__ import annotations

import functools
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.asking.config import AskConfig
from bridge_algos.asking.goal import goal
from bridge_algos.asking.limit import tabular_limit
from bridge_algos.asking.study import prepare, run_session
from bridge_algos.asking.tabular import Problem, build_problem, simulated_answer
from bridge_algos.asking.utility import Utility
from bridge_algos.mdp import TabularMDP
from experiments.cells import Cell, run_cells
from experiments.studies.certified_answers_report import gaps_figure, questions_figure, report
from experiments.studies.old_width import answers_needed

MEASURED = ("questions", "certified_gap", "true_gap", "covered", "candidates")


def compute(settings: dict[str, Any], directory: Path, jobs: int) -> xr.Dataset:
    """Outcomes over (way, seed), limits over (given, limit_seed), gaps over (session, look)."""
    config = _configuration(settings)
    shared = {"config": config.record()}
    ways = [
        {**shared, "n": n, "asking": asking, "seeds": settings["seeds"]}
        for n in settings["demonstrations"]
        for asking in settings["asking"]
        if n or asking in settings["without_demonstrations"]
    ]
    limits = [{**shared, "n": n, "seeds": settings["limit_seeds"]} for n in settings["demonstrations"] if n]
    one = settings["session"]
    shown = replace(config, n_demonstrations=one["demonstrations"], until=one["until"])
    sessions = [{"config": shown.record(), "looks": one["looks"], "seed": seed} for seed in range(settings["seeds"])]
    parts = [
        run_cells(measure, ways, directory, jobs, "sessions").rename(cell="way").drop_vars(["config", "seeds"]),
        run_cells(measure_limits, limits, directory, jobs, "limits")
        .rename(cell="given", n="limit_n")
        .drop_vars(["config", "seeds"]),
        run_cells(measure_gaps, sessions, directory, jobs, "gaps")
        .rename(cell="session")
        .drop_vars(["config", "looks", "seed"]),
    ]
    _, utility = _world(config)
    return xr.merge(parts, combine_attrs="drop_conflicts").assign_attrs(
        weight_bound=utility.weight_bound,
        embedding_bound=utility.embedding.bound,
        goal_nats=goal(config.until, config.utility_range).nats,
    )


def measure(cell: Cell) -> xr.Dataset:
    """The sessions of one number of demonstrations and one way of asking."""
    config = replace(AskConfig(**cell["config"]), n_demonstrations=cell["n"], asking=cell["asking"])
    mdp, utility = _world(config)
    rows = [run_session(config, mdp, utility, None, seed)["outcome"] for seed in range(cell["seeds"])]
    columns = {
        name: ("seed", np.array([inf if row[name] is None else float(row[name]) for row in rows])) for name in MEASURED
    }
    return xr.Dataset(columns)


def measure_limits(cell: Cell) -> xr.Dataset:
    """The yardstick (an estimate), and what the earlier certificate would need, for the first seeds' problems."""
    config = replace(AskConfig(**cell["config"]), n_demonstrations=cell["n"])
    nats = goal(config.until, config.utility_range).nats
    yardsticks, old = [], []
    for seed in range(cell["seeds"]):
        problem = _problem(config, np.random.default_rng(seed))
        yardsticks.append(tabular_limit(problem, nats, config.delta).questions)
        old.append(answers_needed(problem, nats, config.delta))
    return xr.Dataset({"yardstick": ("limit_seed", np.array(yardsticks)), "old": ("limit_seed", np.array(old))})


def measure_gaps(cell: Cell) -> xr.Dataset:
    """The certified gap, computed tightly, and the true one after some numbers of answers of one session."""
    config = AskConfig(**cell["config"])
    rng = np.random.default_rng(cell["seed"])
    problem = _problem(config, rng)
    session = problem.session(config.until, config.delta, config.asking, rng)
    weights, certified, true = problem.utility.weights, [], []
    for look in cell["looks"]:
        while not session.done and len(session.history) < look:
            question = session.ask()
            session.tell(question, simulated_answer(weights, question.difference, rng))
        certified.append(session.tight_gap)
        true.append(problem.true_gap(session.recommended))
    gaps = {"certified": ("look", np.array(certified)), "true": ("look", np.array(true))}
    return xr.Dataset({f"gap_{name}": values for name, values in gaps.items()}, coords={"look": cell["looks"]})


def figures(data: xr.Dataset) -> dict[str, Any]:
    """Questions against demonstrations, and gaps over the questions of sessions."""
    return {"": questions_figure(data), "gaps": gaps_figure(data)}


def words(data: xr.Dataset) -> str:
    """What was asked, what was certified, and how it compares."""
    return report(data)


def _configuration(settings: dict[str, Any]) -> AskConfig:
    return AskConfig(
        environment=settings["environment"],
        embedding=settings["embedding"],
        utility_range=float(settings["range"]),
        until=settings["until"],
        delta=settings["delta"],
        max_questions=settings["max_questions"],
        pool=settings["pool"],
    )


@functools.cache
def _world(config: AskConfig) -> tuple[TabularMDP, Utility]:
    mdp, utility, _ = prepare(config)
    return mdp, utility


def _problem(config: AskConfig, rng: np.random.Generator) -> Problem:
    mdp, utility = _world(config)
    return build_problem(mdp, utility, config.n_demonstrations, rng, None, config.limit, config.pool)
