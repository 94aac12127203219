"""The two tabular MDPs of the authors' published runs, read from the package's own data file."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

import numpy as np

from bridge_algos.mdp import TabularMDP
from bridge_theory.errors import InputError

VARIANTS = ("text", "published")


def published_mdp(name: str, **labels: Any) -> TabularMDP:
    """The MDP ``"StarMDP"`` or ``"Gridworld"`` of ``published_mdps.json``, with labels for pictures added."""
    record = json.loads(files("bridge_algos.envs").joinpath("published_mdps.json").read_text(encoding="utf-8"))[name]
    return TabularMDP(
        transitions=record["transitions"],
        initial=np.eye(len(record["reward_on_arrival"]))[record["initial_state"]],
        horizon=record["horizon"],
        reward=record["reward_on_arrival"],
        name=name,
        action_names=tuple(record["actions"]),
        **labels,
        axes="state-action",
        reward_on="arrival",
    )


def check_variant(variant: str) -> None:
    """Raise InputError unless the variant is one of :data:`VARIANTS`."""
    if variant not in VARIANTS:
        raise InputError(f"variant is {variant!r}, expected one of {', '.join(map(repr, VARIANTS))}.")
