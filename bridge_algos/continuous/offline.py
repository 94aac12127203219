"""The offline stage of a seed in continuous control: demonstrations, the clone, the candidates and their features."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bridge_algos.continuous.candidates import Candidates, feature_ball, make_candidates
from bridge_algos.continuous.clone_cache import cached_clone
from bridge_algos.continuous.cloning import Clone, Statistics, demonstrated_statistics
from bridge_algos.continuous.config import ContinuousConfig
from bridge_algos.continuous.demonstrations import load_demonstrations
from bridge_algos.continuous.embeddings import Embedding, EmbeddingFunction, embeddings_for, make_embedding
from bridge_algos.continuous.environments import Environment, draw_starts, make_environment
from bridge_algos.continuous.episodes import Episodes, episodes_digest
from bridge_algos.continuous.experts import load_expert
from bridge_algos.continuous.features import Features, candidate_features
from bridge_algos.continuous.policies import MlpPolicy
from bridge_algos.continuous.rollouts import rollout
from bridge_algos.continuous.starts import Starts
from bridge_algos.run.streams import stream
from bridge_theory.errors import InputError

HELD_OUT = 5
"""Of given demonstrations, every fifth is held out."""


@dataclass(frozen=True, eq=False)
class OfflineStage:
    """What a learner of this seed has before its first question, and the expert as a yardstick.

    Args:
        candidates: the clone, its noisy copies, and always the expert as the last one, included in the search or not.
        features: of all candidates, in the embedding's units.
        in_ball: (N,) which candidates lie in the offline set.
    """

    environment: Environment
    demonstrations: Episodes
    clone: Clone
    candidates: Candidates
    embedding: Embedding
    features: Features
    in_ball: NDArray[np.bool_]


def load_world(config: ContinuousConfig) -> tuple[Environment, MlpPolicy, Episodes | None]:
    """Environment, expert, and the configured demonstrations; mistakes in the configuration show here.

    Raises:
        InputError: no such environment, expert or data, a changed file, or other dimensions.
    """
    environment = make_environment(config.environment)
    expert = load_expert(config.expert or config.environment, environment)
    if config.expert_digest not in (None, expert.digest()):
        raise InputError(
            f"the expert {config.expert or config.environment!r} has changed since this run was configured; use "
            "another --out for the new one."
        )
    if config.demonstrations is None:
        return environment, expert, None
    given = load_demonstrations(config.demonstrations, environment, config.horizon)
    if config.demonstrations_digest not in (None, episodes_digest(given)):
        raise InputError(
            f"{config.demonstrations} has changed since this run was configured; use another --out for the new data."
        )
    return environment, expert, given


def resolved(config: ContinuousConfig) -> ContinuousConfig:
    """The configuration with the digests of its expert and demonstrations, so that it describes their content."""
    _, expert, given = load_world(config)
    found = None if given is None else episodes_digest(given)
    return config.but(expert_digest=expert.digest(), demonstrations_digest=found)


def demonstrations_and_clone(
    config: ContinuousConfig, seed: int, cache: Path | None
) -> tuple[Environment, MlpPolicy, Episodes, Clone]:
    """Environment, expert, the demonstrations of a seed, and the clone fitted to them or found in the cache."""
    environment, expert, given = load_world(config)
    if given is None:
        demonstrations, held_out = (
            rollout(environment, expert, draw_starts(environment, n, stream(seed, purpose)), horizon=config.horizon)
            for n, purpose in ((config.n_demonstrations, "demonstrations"), (config.held_out, "held-out"))
        )
    else:
        every_fifth = np.arange(len(given)) % HELD_OUT == HELD_OUT - 1
        demonstrations, held_out = _part(given, ~every_fifth), _part(given, every_fifth)
    settings = {name: getattr(config, name) for name in ("hidden", "epochs", "batch", "rate")}
    statistics = _statistics(config, demonstrations, expert)
    validation = held_out if len(held_out) else None
    cloned = cached_clone(cache, demonstrations, stream(seed, "clone"), validation, statistics, settings)
    return environment, expert, demonstrations, cloned


def _statistics(config: ContinuousConfig, demonstrations: Episodes, expert: MlpPolicy) -> Statistics | None:
    """By what the clone standardises its observations."""
    if config.normalise_observations == "demonstrations":
        return demonstrated_statistics(demonstrations)
    mean, scale = expert.observation_mean, expert.observation_scale
    if config.normalise_observations == "none" or mean is None or scale is None:
        return None
    return mean, scale


def candidates_of(config: ContinuousConfig, cloned: Clone, expert: MlpPolicy, seed: int) -> Candidates:
    """The candidates of a seed, the expert last."""
    noise = {name: getattr(config, name) for name in ("small", "large", "sigma", "large_factor")}
    return make_candidates(cloned.policy, stream(seed, "candidates"), **noise, expert=expert)


def offline_stage(
    config: ContinuousConfig,
    seed: int,
    *,
    cache: Path | None,
    threads: int | None = None,
    progress: bool = False,
    user: EmbeddingFunction | None = None,
) -> OfflineStage:
    """The offline stage of a seed; the numbers depend on configuration, seed and ``user`` only.

    Args:
        cache, threads, progress: see :func:`bridge_algos.continuous.features.candidate_features`.
        user: a function from episodes to (n, d) that is used in place of a named embedding, and not cached.
    """
    environment, expert, demonstrations, cloned = demonstrations_and_clone(config, seed, cache)
    candidates = candidates_of(config, cloned, expert, seed)
    embedding = make_embedding(
        config.embedding, environment.gymnasium_id, demonstrations, config.normalise_embedding, user
    )
    functions = embeddings_for(environment.gymnasium_id) if user is None else {config.embedding: user}
    estimates = candidate_features(
        environment,
        candidates,
        _starts(config, environment, len(candidates), seed),
        functions,
        horizon=config.horizon,
        cache=cache if user is None else None,
        threads=threads,
        progress=progress,
    )
    features = estimates[config.embedding].scaled(embedding.scale)
    in_ball = feature_ball(features.mean, features.mean[0], config.radius)
    return OfflineStage(environment, demonstrations, cloned, candidates, embedding, features, in_ball)


def _starts(config: ContinuousConfig, environment: Environment, policies: int, seed: int) -> Starts | list[Starts]:
    """The initial states that all policies share, or each policy's own."""
    rng = stream(seed, "starts")
    if config.common_starts:
        return draw_starts(environment, config.rollouts, rng)
    return [draw_starts(environment, config.rollouts, own) for own in rng.spawn(policies)]


def _part(episodes: Episodes, chosen: NDArray[np.bool_]) -> Episodes:
    return Episodes(*(getattr(episodes, part.name)[chosen] for part in fields(episodes)))
