"""One seed of a run in continuous control, as one labelled data set."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import xarray as xr
from threadpoolctl import threadpool_limits

from bridge_algos.continuous.config import ContinuousConfig
from bridge_algos.continuous.embeddings import EmbeddingFunction
from bridge_algos.continuous.judging import judged_returns, regret_errors, standard_error
from bridge_algos.continuous.offline import OfflineStage, offline_stage
from bridge_algos.continuous.problem import SimulatedProblem, make_learner
from bridge_algos.mdp import FloatArray
from bridge_algos.online.loop import run_online
from bridge_algos.run.dataset import Scalars, constant_record, seed_dataset
from bridge_algos.run.streams import stream
from bridge_algos.run.versions import package_versions
from bridge_algos.run.world import return_oracle


def run_seed(
    config: ContinuousConfig,
    seed: int,
    *,
    cache: Path | None,
    threads: int | None = None,
    progress: bool = False,
    user: EmbeddingFunction | None = None,
) -> xr.Dataset:
    """All algorithms of a configuration on one seed.

    Args:
        cache, threads, progress, user: see :func:`bridge_algos.continuous.offline.offline_stage`.

    Returns:
        The data set of :func:`bridge_algos.run.dataset.seed_dataset`, with ``first``, ``second`` and ``greedy`` as
        indices of candidates (0 is the clone, the last one the expert). ``suboptimality`` is judged on fresh initial
        states, as are all returns; ``suboptimality_seen`` on the rollouts that made the features, as in the published
        runs. There is no ``pseudo_regret``: not every pair that was played is judged. ``suboptimality_error`` and
        ``cumulative_error`` are Monte-Carlo standard errors of the regret against the expert, of a round and cumulated.
        ``suboptimality`` less ``best_candidate``, or less ``best_of_all``, is the regret against the candidate that
        looked best among those that the algorithm searched, or that any did. The numbers depend on configuration, seed
        and ``user`` only.
    """
    with threadpool_limits(1):
        stage = offline_stage(config, seed, cache=cache, threads=threads, progress=progress, user=user)
        return _online(config, stage, seed, threads)


def _online(config: ContinuousConfig, stage: OfflineStage, seed: int, threads: int | None) -> xr.Dataset:
    seen = stage.features.returns.mean(axis=1)
    expert = len(seen) - 1
    everyone = make_learner("pbrl", config, stage).policies[:, 0]
    optimum = everyone[seen[everyone].argmax()]
    problem = SimulatedProblem(stage, return_oracle(config.oracle_options), np.array([optimum]), config.horizon)
    records, choices, best = {}, {}, {}
    for name in config.algorithms:
        if name == "bc":
            choices[name], best[name] = np.zeros(config.rounds, dtype=np.int64), 0
            records[name] = constant_record(config.rounds, seen[expert] - seen[0], seen[optimum] - seen[0])
        else:
            learner = make_learner(name, config, stage)
            members = learner.policies[:, 0]
            records[name] = run_online(problem, learner, config.rounds, stream(seed, name))
            for entry in ("first", "second", "greedy"):
                records[name][entry] = members[records[name][entry].astype(np.int64)].astype(np.float64)
            choices[name] = records[name]["greedy"].astype(np.int64)
            best[name] = int(members[seen[members].argmax()])
    chosen = np.concatenate([*choices.values(), list(best.values()), [0, optimum, expert]])
    returns = judged_returns(config, stage, seed, chosen, threads)
    gaps = returns[expert] - returns
    as_seen = [record["suboptimality"] for record in records.values()]
    for name, greedy in choices.items():
        records[name]["suboptimality"] = gaps.mean(axis=1)[greedy]
    errors = [regret_errors(gaps, greedy) for greedy in choices.values()]
    unit = {"units": "reward per trajectory"}
    below = {"units": "reward per trajectory below the expert"}
    attributes = {
        "versions": json.dumps(package_versions()),
        "caveats": json.dumps(caveats(config)),
        "expert": f"expert: {config.expert or f'shipped, {config.environment}'}, "
        f"{'a candidate' if config.include_expert else 'not a candidate'}",
    }
    dataset = seed_dataset(config, seed, records, _scalars(config, stage, returns), attributes)
    return dataset.drop_vars("pseudo_regret").assign(
        best_candidate=("algorithm", [float(gaps[index].mean()) for index in best.values()], below),
        best_of_all=((), float(gaps[optimum].mean()), below),
        suboptimality_seen=(("algorithm", "round"), np.stack(as_seen), unit),
        suboptimality_error=(("algorithm", "round"), np.stack([each for each, _ in errors]), unit),
        cumulative_error=(("algorithm", "round"), np.stack([total for _, total in errors]), unit),
    )


def _scalars(config: ContinuousConfig, stage: OfflineStage, returns: FloatArray) -> Scalars:
    features, reward, length = stage.features, "reward per trajectory", "norm of phi"
    distance = float(np.linalg.norm(features.mean[-1] - features.mean[0]))
    return {
        "expert_return": (float(returns[-1].mean()), reward),
        "expert_return_error": (float(standard_error(returns[-1])), reward),
        "clone_return": (float(returns[0].mean()), reward),
        "clone_gap_error": (float(standard_error(returns[-1] - returns[0])), reward),
        "likelihood": (float(stage.clone.likelihood[-1]), "nats per action"),
        "held_out_likelihood": (float(stage.clone.validation[-1]), "nats per action"),
        "radius": (config.radius, length),
        "offline_set_count": (float(stage.in_ball[:-1].sum()), "candidates without the expert"),
        "expert_distance": (distance, length),
        "expert_in_ball": (float(stage.in_ball[-1]), "1 = yes"),
        "feature_error": (float(np.median(np.linalg.norm(features.standard_error, axis=1))), length),
        "observed_bound": (features.bound, length),
        "largest_coordinate": (float(features.largest.max()), "units of the coordinate"),
    }


def caveats(config: ContinuousConfig) -> list[str]:
    """What of a run's settings has no guarantee."""
    knows = config.normalise_observations == "expert"
    return [
        *(["the clone standardises its observations as the expert does, as published"] if knows else []),
        "gamma is a hand-set number",
        f"features and returns are means of {config.rollouts} rollouts, with errors"
        + ("" if config.common_starts else ", each policy's from its own initial states, so that luck decides too"),
        "the offline set is a ball of estimated features, not a Hellinger ball of the theory",
        "the paper's bound B on the embedding is not known to hold here; its largest values are observed",
        f"the teacher breaks: {return_oracle(config.oracle_options).breaks}",
    ]
