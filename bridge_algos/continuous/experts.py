"""Experts: those that ship with the package, and those that users bring."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any

from bridge_algos.continuous.environments import Environment
from bridge_algos.continuous.policies import MlpPolicy
from bridge_algos.continuous.policy_files import load_policy
from bridge_algos.continuous.sb3_zip import policy_from_sb3_zip
from bridge_theory.errors import InputError

SHIPPED = ("reacher", "reacher-zoo", "ant")
"""Experts that ship with the package: the best ones, and one trained as the paper's was, with the Zoo's settings."""


def load_expert(source: str | Path, environment: Environment) -> MlpPolicy:
    """An expert for an environment; nothing in its file is executed.

    Args:
        source: one of ``SHIPPED``, the path of a ``.safetensors`` file written by ``save_policy``, or the path of a
            ``.zip`` of Stable-Baselines3 (see :mod:`bridge_algos.continuous.sb3_zip`). A callable needs no loading:
            pass it to the rollouts.
        environment: whose dimensions it must fit.

    Raises:
        InputError: no such expert, a file of another kind, or other dimensions.
    """
    path = shipped_path(str(source)) or Path(source)
    if path.suffix == ".safetensors":
        policy = load_policy(path)
    elif path.suffix == ".zip":
        policy = policy_from_sb3_zip(path, environment)
    elif path.suffix in (".pt", ".pth", ".pkl", ".pickle"):
        raise InputError(
            f"{source} may be a pickle, which can run any program when it is loaded; load it yourself in Python and "
            "pass policy_from_module(module) to the rollouts."
        )
    elif path.exists():
        raise InputError(f"{source} is a file of another kind, expected a .safetensors file or an SB3 .zip.")
    else:
        known = ", ".join(SHIPPED)
        raise InputError(
            f"there is no expert {str(source)!r}; give one of {known}, or your own .safetensors file or SB3 .zip, by "
            "--expert."
        )
    sizes = (policy.observation_size, policy.action_size)
    expected = (environment.observation_size, environment.action_size)
    if sizes != expected:
        raise InputError(
            f"the expert {str(source)!r} takes {sizes[0]} observations and gives {sizes[1]} actions, expected "
            f"{expected[0]} and {expected[1]}, as {environment.name} has."
        )
    return policy


def expert_card(source: str | Path) -> dict[str, Any]:
    """The JSON card beside an expert's file: training command, seed, versions, return with its error.

    Raises:
        InputError: there is none, or it is not JSON.
    """
    path = (shipped_path(str(source)) or Path(source)).with_suffix(".json")
    try:
        return dict(json.loads(path.read_text()))
    except (OSError, ValueError, TypeError) as error:
        raise InputError(f"the expert {str(source)!r} has no readable card {path.name} ({error}).") from None


def shipped_path(name: str) -> Path | None:
    """The file of a shipped expert, or None where the name is not one's."""
    if name.lower() not in SHIPPED:
        return None
    return Path(str(files("bridge_algos.continuous").joinpath(f"expert_files/{name.lower()}.safetensors")))
