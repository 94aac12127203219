r"""Features of the candidates, estimated once and kept on disk by content.

For each policy: :math:`\hat\phi(\pi) = \frac1n \sum_i \phi(\tau_i)` with standard errors, all returns, and the largest
absolute value of each coordinate over the n trajectories, which shows how far the paper's assumption of coordinates in
[-1, 1] holds. All named embeddings of an environment are computed from the same rollouts.

Policies go to disk in chunks. A chunk's file is named by a digest of all that decides its numbers: the policies'
parameters, the environment, the initial states, the horizon, the embeddings, and the versions of the packages that
simulate. So runs that search the same candidates share it, whatever else they vary, and a killed run continues in the
middle of a seed.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np

from bridge_algos.continuous.embeddings import EmbeddingFunction
from bridge_algos.continuous.environments import Environment
from bridge_algos.continuous.episodes import Episodes
from bridge_algos.continuous.policies import Policy
from bridge_algos.continuous.rollouts import map_rollouts
from bridge_algos.continuous.starts import Starts
from bridge_algos.files import atomic_write
from bridge_algos.mdp import FloatArray
from bridge_algos.npz import read_arrays
from bridge_theory.errors import InputError

CHUNK = 25
"""Policies a file: seconds of work on Reacher, less than a minute on Ant."""
FORMAT = 2
"""Changes whenever the definition of an embedding or of a file does."""
_ARRAYS = ("mean", "standard_error", "largest")


@dataclass(frozen=True, eq=False)
class Features:
    """Estimates for N policies from n initial states, common to all or each policy's own.

    Args:
        mean, standard_error: (N, d).
        largest: (N, d) largest absolute value of each coordinate over the policy's trajectories.
        returns: (N, n); column i belongs to initial state i.
    """

    mean: FloatArray
    standard_error: FloatArray
    largest: FloatArray
    returns: FloatArray

    def scaled(self, scale: FloatArray) -> Features:
        """The features of the embedding divided by a (d,) scale."""
        return Features(self.mean / scale, self.standard_error / scale, self.largest / scale, self.returns)

    @property
    def bound(self) -> float:
        """Norm of the coordinates' largest absolute values over all trajectories: no trajectory seen had a larger norm.

        The paper's B = sqrt(d) is this number for coordinates that reach 1. It is an observation, not a bound on
        trajectories that were not seen.
        """
        return float(np.linalg.norm(self.largest.max(axis=0)))


def cache_directory() -> Path:
    """Where features are kept: ``$BRIDGE_RL_CACHE``, else ``bridge-rl`` in the user's cache directory."""
    own = os.environ.get("BRIDGE_RL_CACHE")
    if own:
        return Path(own)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "bridge-rl"


def candidate_features(
    environment: Environment,
    policies: Sequence[Policy],
    starts: Starts | Sequence[Starts],
    embeddings: dict[str, EmbeddingFunction],
    *,
    horizon: int,
    cache: Path | None,
    threads: int | None = None,
    progress: bool = False,
) -> dict[str, Features]:
    """Features of N policies under several embeddings, from one rollout of each policy from each of its starts.

    Args:
        policies: made as they are needed, a chunk at a time.
        starts: common to all policies, or as many for each of them, one entry a policy.
        embeddings: functions by name.
        cache: directory of finished chunks; None keeps nothing. Chunks of an environment that is not Gymnasium's own,
            or with a policy that has no ``digest``, such as a user's own function, are never kept; nor should a user's
            own embedding be, whose name says nothing of its content: pass None then.
        threads: of the rollouts; does not change the numbers.

    Raises:
        InputError: fewer than two starts (no standard error exists), or a damaged file, which is named.
    """
    own = [starts] * len(policies) if isinstance(starts, Starts) else list(starts)
    if len(own[0]) < 2:
        raise InputError(f"{len(own[0])} rollouts a policy are too few for a standard error; expected at least 2.")
    parts = []
    for first in range(0, len(policies), CHUNK):
        rows = range(first, min(first + CHUNK, len(policies)))
        chunk, theirs = [policies[i] for i in rows], [own[i] for i in rows]
        path = None if cache is None else _path(cache, environment, chunk, theirs, list(embeddings), horizon)
        if path is not None and path.exists():
            parts.append(_read(path, embeddings, len(chunk), len(theirs[0])))
            continue
        arrays = _roll(environment, chunk, theirs, embeddings, horizon, threads, progress)
        if path is not None:
            with atomic_write(path) as handle:
                np.savez(handle, allow_pickle=False, **arrays)
        parts.append(arrays)
    joined = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
    return {
        name: Features(**{array: joined[f"{name}.{array}"] for array in _ARRAYS}, returns=joined["returns"])
        for name in embeddings
    }


def _roll(
    environment: Environment,
    chunk: list[Policy],
    starts: list[Starts],
    embeddings: dict[str, EmbeddingFunction],
    horizon: int,
    threads: int | None,
    progress: bool,
) -> dict[str, FloatArray]:
    sizes: dict[str, int] = {}

    def values(episodes: Episodes) -> FloatArray:
        columns = {name: function(episodes) for name, function in embeddings.items()}
        sizes.update({name: column.shape[1] for name, column in columns.items()})
        return np.column_stack([episodes.returns, *columns.values()])

    table = map_rollouts(environment, chunk, starts, values, horizon=horizon, threads=threads, progress=progress)
    arrays, at = {"returns": table[:, :, 0]}, 1
    for name, size in sizes.items():
        part = table[:, :, at : at + size]
        arrays[f"{name}.mean"] = part.mean(axis=1)
        arrays[f"{name}.standard_error"] = part.std(axis=1, ddof=1) / np.sqrt(len(starts[0]))
        arrays[f"{name}.largest"] = np.abs(part).max(axis=1)
        at += size
    return arrays


def _read(path: Path, embeddings: dict[str, EmbeddingFunction], policies: int, rollouts: int) -> dict[str, FloatArray]:
    names = ["returns", *(f"{name}.{array}" for name in embeddings for array in _ARRAYS)]
    damaged = InputError(f"{path} does not hold what was kept there; delete it, so that it is computed again.")
    try:
        stored = read_arrays(path, names)
    except InputError:
        raise damaged from None
    arrays = {name: stored[name] for name in names}
    numbers = all(array.dtype.kind == "f" and np.isfinite(array).all() for array in arrays.values())
    sizes = {array.shape[:1] for array in arrays.values()}
    if not numbers or sizes != {(policies,)} or arrays["returns"].shape != (policies, rollouts):
        raise damaged
    return arrays


def _path(
    cache: Path,
    environment: Environment,
    chunk: list[Policy],
    starts: list[Starts],
    embeddings: list[str],
    horizon: int,
) -> Path | None:
    """Where a chunk is kept, or None where the content of a policy or of the environment cannot be named."""
    digests = [getattr(policy, "digest", None) for policy in chunk]
    spec = environment.reference.spec  # a user's own environment may change under the same id
    own = str(spec.entry_point).startswith("gymnasium.envs.mujoco.") and not spec.kwargs
    if not own or not all(callable(digest) for digest in digests):
        return None
    identity = {
        "format": FORMAT,
        "environment": environment.gymnasium_id,
        "versions": {name: version(name) for name in ("mujoco", "gymnasium", "numpy")},
        "starts": hashlib.sha256(np.stack([own.seeds for own in starts]).tobytes()).hexdigest(),
        "horizon": horizon,
        "embeddings": embeddings,
        "policies": [digest() for digest in digests],  # type: ignore[misc]
    }
    name = hashlib.sha256(json.dumps(identity, sort_keys=True).encode()).hexdigest()[:32]
    return cache / "features" / environment.name / f"{name}.npz"
