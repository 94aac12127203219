"""Counterexamples of the ledger whose instance is an environment that one can run, in exact numbers.

They stand here once: the ledger's stored counterexamples name the environment and read its numbers from this package.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from importlib.resources import files

import numpy as np

from bridge_algos.mdp import TabularMDP
from bridge_theory.errors import InputError


@cache
def _instances() -> dict[str, dict[str, str]]:
    text = files("bridge_algos.envs").joinpath("counterexamples.json").read_text(encoding="utf-8")
    instances: dict[str, dict[str, str]] = json.loads(text)
    return instances


def is_counterexample(environment: str) -> bool:
    """Whether an environment's name is that of a counterexample."""
    return environment.lower() in _instances()


def instance(environment: str) -> Mapping[str, str]:
    """The exact numbers of a counterexample, as strings such as ``"1/20"``.

    Raises:
        InputError: for another name.

    >>> instance("counterexample-known-model")["delta"]
    '1/20'
    """
    if not is_counterexample(environment):
        raise InputError(f"{environment!r} is not one of the counterexamples {', '.join(sorted(_instances()))}.")
    return dict(_instances()[environment.lower()])


def two_actions(horizon: int = 1) -> TabularMDP:
    """One state, the actions ``+`` and ``-`` that pay B and -B: the counterexample to the known-model regret theorem.

    Source: the ledger's entry ``thm:main_known`` (``bridge-rl check --only thm:main_known``). For thousands of rounds
    the data cannot rule ``-`` out of the stated sets, so that the algorithm compares both actions in every round.

    >>> two_actions().expected_reward
    array([[ 0.5, -0.5]])
    """
    pay = float(Fraction(instance("counterexample-known-model")["B"]))
    return TabularMDP(
        transitions=np.ones((1, 2, 1)),
        initial=np.ones(1),
        horizon=horizon,
        reward=np.array([[pay, -pay]]),
        name="two actions",
        action_names=("+", "-"),
    )
