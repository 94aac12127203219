"""All that changes while PPO trains, as plain arrays, and its checkpoint."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from bridge_algos.continuous.moments import Moments
from bridge_algos.files import atomic_write
from bridge_algos.mdp import FloatArray
from bridge_algos.npz import read_arrays
from bridge_theory.errors import InputError


@dataclass
class Learner:
    """The parameters of both networks, Adam's state, and the moments that normalise.

    Args:
        parameters: (P,) as :class:`~bridge_algos.continuous.ppo_gradient.Networks` reads them.
        first: (P,) Adam's running mean of the gradient.
        second: (P,) Adam's running mean of its square.
        steps: gradient steps so far.
        observations: of the states seen.
        returns: of the discounted sums of rewards.
    """

    parameters: FloatArray
    first: FloatArray
    second: FloatArray
    steps: int
    observations: Moments
    returns: Moments


_MOMENTS = ("observations", "returns")
_VECTORS = ("parameters", "first", "second")


def save_checkpoint(path: Path, identity: str, learner: Learner, done: int) -> None:
    """Write the learner after ``done`` iterations, whole or not at all; ``identity`` says of which training."""
    arrays: dict[str, Any] = {name: getattr(learner, name) for name in (*_VECTORS, "steps")}
    for name in _MOMENTS:
        arrays |= {f"{name}.{part.name}": getattr(getattr(learner, name), part.name) for part in fields(Moments)}
    with atomic_write(path) as handle:
        np.savez(handle, identity=np.array(identity), done=np.array(done), **arrays)


def load_checkpoint(path: Path, identity: str) -> tuple[Learner, int] | None:
    """The learner and how many iterations it has done, or None where there is no checkpoint.

    Raises:
        InputError: the file is damaged, or of another training.
    """
    if not path.exists():
        return None
    moments = [f"{name}.{part.name}" for name in _MOMENTS for part in fields(Moments)]
    arrays = read_arrays(path, ("identity", "done", "steps", *_VECTORS, *moments))
    if str(arrays["identity"]) != identity:
        raise InputError(f"{path} is of another training ({arrays['identity']}); move it away to start anew.")
    observations, returns = (
        Moments(float(arrays[f"{name}.count"]), arrays[f"{name}.mean"], arrays[f"{name}.squares"]) for name in _MOMENTS
    )
    first, second = arrays["first"], arrays["second"]
    learner = Learner(arrays["parameters"], first, second, int(arrays["steps"]), observations, returns)
    return learner, int(arrays["done"])
