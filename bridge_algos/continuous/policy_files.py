"""Policies on disk: a safetensors file of plain arrays, and beside it a JSON card that says where they come from."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from bridge_algos.continuous.needs import need
from bridge_algos.continuous.policies import OPTIONAL, MlpPolicy
from bridge_algos.files import atomic_write, atomic_write_text
from bridge_theory.errors import InputError

FORMAT = "bridge-rl policy 1"
_HEADER = {"format", "activation", "observation_clip", "squashed"}


def save_policy(path: str | Path, policy: MlpPolicy, card: dict[str, Any]) -> None:
    """Write ``path`` (ending in ``.safetensors``) and the card beside it (``.json``).

    The arrays are ``weights.0``, ``biases.0``, ``weights.1``, ..., and those of ``OPTIONAL`` that the policy has; the
    header holds the rest.

    Raises:
        InputError: the path ends otherwise, or safetensors is not installed.
    """
    target = checked_path(path)
    save = need("safetensors.numpy").save
    arrays = {f"weights.{i}": weight for i, weight in enumerate(policy.weights)}
    arrays |= {f"biases.{i}": bias for i, bias in enumerate(policy.biases)}
    arrays |= {name: getattr(policy, name) for name in OPTIONAL if getattr(policy, name) is not None}
    header = {
        "format": FORMAT,
        "activation": policy.activation,
        "observation_clip": repr(float(policy.observation_clip)),
        "squashed": str(policy.squashed).lower(),
    }
    content = save({name: np.ascontiguousarray(array) for name, array in arrays.items()}, header)
    with atomic_write(target) as handle:
        handle.write(content)
    atomic_write_text(target.with_suffix(".json"), json.dumps(card, indent=2) + "\n")


def checked_path(path: str | Path) -> Path:
    """A path that a policy can be written to.

    Raises:
        InputError: its name has another ending.
    """
    target = Path(path)
    if target.suffix != ".safetensors":
        raise InputError(f"the policy's file is named {target.name!r}, expected a name that ends in '.safetensors'.")
    return target


def load_policy(path: str | Path) -> MlpPolicy:
    """Read a policy that :func:`save_policy` wrote; nothing in the file is executed.

    Raises:
        InputError: the file is missing, damaged, or not such a policy; safetensors is not installed.
    """
    source = Path(path)
    safetensors = need("safetensors")
    if not source.is_file():
        lacking = "is a directory" if source.is_dir() else "does not exist"
        raise InputError(f"{path} {lacking}; give the path of a policy's .safetensors file.")
    try:
        with safetensors.safe_open(source, framework="numpy") as handle:
            header = handle.metadata() or {}
            arrays = {name: np.asarray(handle.get_tensor(name), dtype=np.float64) for name in handle.keys()}  # noqa: SIM118
    except (safetensors.SafetensorError, OSError, TypeError, ValueError) as error:
        raise InputError(f"{path} is not a readable .safetensors file ({error}); save the policy again.") from None
    layers = sum(name.startswith("weights.") for name in arrays)
    named = [f"{kind}.{i}" for i in range(layers) for kind in ("weights", "biases")]
    if header.get("format") != FORMAT or not layers or set(arrays) - set(OPTIONAL) != set(named):
        raise InputError(
            f"{path} holds no policy of the format {FORMAT!r} (header: {header.get('format')!r}; arrays: "
            f"{', '.join(sorted(arrays)) or 'none'}); write policies with save_policy."
        )
    if set(header) != _HEADER or header["squashed"] not in ("true", "false"):
        raise InputError(
            f"{path} has the header {json.dumps(header)}, expected {', '.join(sorted(_HEADER))}, and 'squashed' true "
            "or false; save the policy again."
        )
    try:
        clip = float(header["observation_clip"])
    except ValueError:
        raise InputError(f"{path} has no number observation_clip in its header; save the policy again.") from None
    return MlpPolicy(
        weights=tuple(arrays[f"weights.{i}"] for i in range(layers)),
        biases=tuple(arrays[f"biases.{i}"] for i in range(layers)),
        activation=header["activation"],
        observation_clip=clip,
        squashed=header["squashed"] == "true",
        **{name: arrays.get(name) for name in OPTIONAL},
    )
