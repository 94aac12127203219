"""Tabular MDPs by name, as the command line and the Gymnasium ids use them."""

from __future__ import annotations

import dataclasses
import difflib
import inspect
import os
from collections.abc import Callable
from typing import Any

import numpy as np

from bridge_algos.envs.counterexamples import two_actions
from bridge_algos.envs.families import chain, cliff, garnet
from bridge_algos.envs.from_gymnasium import mdp_from_gymnasium
from bridge_algos.envs.gridworld import gridworld
from bridge_algos.envs.gymnasium_ids import TABLES, mujoco_id
from bridge_algos.envs.star import star_mdp
from bridge_algos.mdp import TabularMDP
from bridge_theory.errors import InputError


def make_mdp(name: str, **options: Any) -> TabularMDP:
    """The tabular MDP of that name.

    Args:
        name: one of :func:`mdp_names`, in any case. ``starmdp`` and ``gridworld`` are the published variants,
            ``starmdp-text`` and ``gridworld-text`` follow the paper's text.
        options: ``horizon`` for every name; and for the families their arguments: ``chain`` (n_states, slip), ``cliff``
            (n_rows, n_columns, slip, fall), ``garnet`` (n_states, n_actions, branching, seed).

    Raises:
        InputError: for an unknown name or option, or an option out of range.

    >>> make_mdp("gridworld", horizon=20).horizon
    20
    >>> make_mdp("frozen-lake")
    Traceback (most recent call last):
    bridge_theory.errors.InputError: there is no environment 'frozen-lake' (did you mean 'frozenlake'?); expected one of
    chain, cliff, cliffwalking, counterexample-known-model, frozenlake, frozenlake8x8, garnet, gridworld,
    gridworld-text, starmdp, starmdp-text, taxi.
    """
    key = str(name).lower()
    if key not in _MAKERS:
        raise InputError(_unknown(str(name)))
    maker = _MAKERS[key]
    allowed = sorted(inspect.signature(maker).parameters)
    unknown = sorted(set(options) - set(allowed))
    if unknown:
        raise InputError(f"{key} has no option {unknown[0]!r}; its options are {', '.join(allowed)}.")
    return maker(**options)


def mdp_names() -> tuple[str, ...]:
    """The names that :func:`make_mdp` takes, in alphabetical order."""
    return tuple(sorted(_MAKERS))


def _unknown(name: str) -> str:
    """Why a name is none of an MDP: an environment or a file of another kind, or nothing that is known."""
    expected = f"expected one of {', '.join(mdp_names())}"
    if os.path.isfile(name):  # unlike Path.is_file, false for a name that no file can have
        return f"{name} is a file of another kind, expected an MDP's .npz file, as save_mdp writes, or an environment."
    if identifier := mujoco_id(name):
        return f"{name!r} is no tabular environment; {identifier} of MuJoCo is run by that id; {expected}."
    close = difflib.get_close_matches(name.lower(), _MAKERS, n=1)
    guess = f" (did you mean {close[0]!r}?)" if close else ""
    return f"there is no environment {name!r}{guess}; {expected}."


def _fixed(mdp_of: Callable[[str], TabularMDP], variant: str) -> Callable[..., TabularMDP]:
    def make(horizon: int | None = None) -> TabularMDP:
        mdp = mdp_of(variant)
        return mdp if horizon is None else dataclasses.replace(mdp, horizon=horizon)

    return make


def _from_gymnasium(identifier: str) -> Callable[..., TabularMDP]:
    def make(horizon: int | None = None) -> TabularMDP:
        return mdp_from_gymnasium(identifier, horizon)

    return make


def _garnet(n_states: int = 10, n_actions: int = 3, branching: int = 3, horizon: int = 10, seed: int = 0) -> TabularMDP:
    if not isinstance(seed, (int, np.integer)) or seed < 0:
        raise InputError(f"seed is {seed!r}, expected a whole number of at least 0.")
    return garnet(n_states, n_actions, branching, np.random.default_rng(seed), horizon)


_MAKERS: dict[str, Callable[..., TabularMDP]] = {
    "starmdp": _fixed(star_mdp, "published"),
    "starmdp-text": _fixed(star_mdp, "text"),
    "gridworld": _fixed(gridworld, "published"),
    "gridworld-text": _fixed(gridworld, "text"),
    "chain": chain,
    "cliff": cliff,
    "garnet": _garnet,
    **{name: _from_gymnasium(identifier) for name, identifier in TABLES.items()},
    "counterexample-known-model": two_actions,
}
