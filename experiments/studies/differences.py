r"""What moves our StarMDP curves: every setting that the paper leaves open, one at a time, beside the published runs.

A variant changes what ``configs/published-differences.json`` says: entries of the configuration (``config``), of the
learners (``learner``: lambda of the likelihood apart from that of the data matrix), of their confidence sets
(``confidence``), the reward of the environment (``reward``: paid for the state departed from), where features are taken
(``features``: under the real dynamics, as the appendix writes E under P*, instead of the estimate), or what PbRL knows
(``lent``: the demonstrations' counts); ``without`` leaves an algorithm out. ``scored`` under the real dynamics
(exactly, or from so many rollouts) and ``counted`` until one policy is left (no regret afterwards) say how the greedy
policy is evaluated. The variants named "code" take what the paper leaves open from the authors' public code
(github.com/pfriedric/bridge at 54a96a8, which was read, not run). None of this is an option of the package that is
tuned here: the question is which difference moves which curve. Each variant is read in two ways: as we record it
(``exact``), and with the greedy policy measured before the round's answer (``before``). The published regret is in a
unit of its own and counts zero after a seed stops (:func:`experiments.published.published_unit`), so that no variant's
regret is compared with it; the numbers of policies left have no unit, and are.
"""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.embeddings import Embedding, expected_features, sampled_features
from bridge_algos.evaluation import expected_return, expected_returns
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_algos.online.loop import OnlineProblem, run_online
from bridge_algos.online.policy_filter import first_best
from bridge_algos.run.config import preset
from bridge_algos.run.learners import make_learner
from bridge_algos.run.offline import offline_stage
from bridge_algos.run.streams import stream
from bridge_algos.run.world import build_oracle, build_world
from experiments.cells import Cell, run_cells
from experiments.published import ALGORITHMS
from experiments.studies.differences_report import figure, report

READINGS = ("exact", "before")


def compute(settings: dict[str, Any], directory: Path, jobs: int) -> xr.Dataset:
    """Curves over (variant, algorithm, seed, round)."""
    cells = [
        {"variant": name, "changes": json.dumps(changes, sort_keys=True), "seeds": settings["seeds"]}
        for name, changes in settings["variants"].items()
        if settings["only"] is None or name in settings["only"]
    ]
    results = run_cells(play, cells, directory, jobs, "published-differences")
    return results.drop_vars("seeds").swap_dims(cell="variant")


def play(cell: Cell) -> xr.Dataset:
    """One variant on all its seeds; an algorithm that the variant leaves out is NaN."""
    changes = json.loads(cell["changes"])
    config = preset("published", "starmdp").but(algorithms=ALGORITHMS, **changes.get("config", {}))
    world = build_world(config)
    mdp = _departed(world.mdp) if changes.get("reward") == "departed" else world.mdp
    expert = expected_return(mdp, world.expert.policy)
    problem = OnlineProblem(mdp, world.embedding, build_oracle(config, world), world.optimum, expert)
    shape = (len(ALGORITHMS), cell["seeds"], config.rounds)
    curves = {name: np.full(shape, np.nan) for name in (*READINGS, "set_size")}
    for seed in range(cell["seeds"]):
        stage = offline_stage(config, world, seed)
        for i, name in enumerate(ALGORITHMS):
            if name in changes.get("without", []):
                continue
            learner, _ = make_learner(name, config, world, stage.offline_set, stage.transitions, seed)
            confidence = replace(learner.confidence, **changes.get("confidence", {}))
            learner = replace(learner, confidence=confidence, **changes.get("learner", {}))
            if changes.get("features") == "real":
                learner = replace(learner, estimate=partial(_real, mdp))
            if changes.get("lent"):
                learner = replace(learner, counts=stage.transitions)
            weights: list[FloatArray] = []
            log = partial(_keep, weights) if "scored" in changes else None
            record = run_online(problem, learner, config.rounds, stream(seed, name), log)
            losses = expert - expected_returns(mdp, learner.policies)
            found, size = record["suboptimality"], record["set_size"]
            if log is not None:
                fresh = np.random.default_rng([seed, i, 1])
                scores = partial(_real_scores, problem, learner.policies, changes["scored"], fresh)
                found = losses[[first_best(scores(w)) for w in weights]]
            if changes.get("counted") == "until decided":
                found, size = _until_decided(found, size)
            curves["exact"][i, seed] = found
            curves["before"][i, seed] = np.concatenate([losses[:1], found[:-1]])
            curves["set_size"][i, seed] = size
    return xr.Dataset(
        {name: (("algorithm", "seed", "round"), values) for name, values in curves.items()},
        coords={"algorithm": list(ALGORITHMS), "round": np.arange(1, config.rounds + 1)},
    )


def _keep(weights: list[FloatArray], entry: dict[str, Any]) -> None:
    weights.append(entry["w_next"])


def _real_scores(
    problem: OnlineProblem, policies: IntArray, rollouts: int | None, rng: np.random.Generator, w: FloatArray
) -> FloatArray:
    """Scores under the real dynamics: exact, or from fresh rollouts of every policy."""
    dynamics, embedding = problem.mdp.dynamics, problem.embedding
    if rollouts is None:
        assert isinstance(embedding, Embedding)
        return np.asarray(expected_features(dynamics, policies, embedding)[0] @ w)
    return np.asarray(sampled_features(dynamics, policies, embedding, rollouts, rng).means @ w)


def _until_decided(found: FloatArray, size: FloatArray) -> tuple[FloatArray, FloatArray]:
    """As the authors' public code pads a seed that stops: no regret once a single policy is left."""
    alone = np.logical_or.accumulate(size == 1)
    stopped = np.concatenate([[alone[0]], alone[:-1]])
    return np.where(stopped, 0.0, found), np.where(alone, 1.0, size)


def _real(mdp: TabularMDP, counts: IntArray) -> FloatArray:
    """The real kernel, whatever was counted."""
    return mdp.transitions


def _departed(mdp: TabularMDP) -> TabularMDP:
    """The reward of the state departed from instead of that arrived at: H - 1 arrivals, and the start, are paid."""
    return replace(mdp, reward=np.repeat(mdp.reward[:, None], mdp.n_actions, axis=1))


def figures(data: xr.Dataset) -> dict[str, Any]:
    """Final cumulative regret of every variant beside the published intervals."""
    return {"": figure(data)}


def words(data: xr.Dataset) -> str:
    """Each difference's effect with its interval, what remains, and what the published data cannot decide."""
    return report(data)
