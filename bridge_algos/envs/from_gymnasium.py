"""Gymnasium environments that carry their transition table, as finite-horizon MDPs."""

from __future__ import annotations

from typing import Any

import numpy as np

from bridge_algos.mdp import FloatArray, TabularMDP
from bridge_theory.errors import InputError

DEFAULT_HORIZON = 100
"""Steps of an environment that names no limit of its own (CliffWalking)."""

_END = "end"
_ACTION_NAMES = {
    "FrozenLakeEnv": ("left", "down", "right", "up"),
    "CliffWalkingEnv": ("up", "right", "down", "left"),
    "TaxiEnv": ("south", "north", "east", "west", "pickup", "dropoff"),
}
_TRANSPARENT_WRAPPERS = ("OrderEnforcing", "PassiveEnvChecker", "RecordEpisodeStatistics", "TimeLimit")


def mdp_from_gymnasium(environment: Any, horizon: int | None = None) -> TabularMDP:
    r"""The MDP behind an environment with a transition table, exact in every return and in every law of states.

    The table is ``env.unwrapped.P[s][a]``, a list of (probability, next state, reward, terminated), as in Gymnasium's
    FrozenLake, CliffWalking and Taxi; the first state has law ``env.unwrapped.initial_state_distrib``.

    - Outcomes of one pair with the same next state are summed. Where their rewards differ, the reward is random given
      (s, a, s'); the MDP pays its expectation, so that expected returns are exact but not the law of returns (slippery
      CliffWalking: falling off the cliff and bumping into the border of the start cell both end in the start cell).
    - After a terminating transition nothing is paid any more. The flag sits on the transition: a state that only
      terminating transitions enter becomes absorbing with reward 0, whatever its own rows in the table say. Where a
      terminating transition leads to a state that the table also enters without terminating, or that an episode may
      start in (Taxi: a passenger set down at the destination), it leads to one extra state ``end`` instead, the last
      one, absorbing with reward 0.

    Args:
        environment: an environment, or the id of a registered one.
        horizon: H >= 1. By default the time limit of the environment's specification, else its attribute ``horizon``,
            else :data:`DEFAULT_HORIZON`.

    Returns:
        The MDP, with a reward for each transition, (S, A, S).

    Raises:
        InputError: an unknown id, no table, spaces that are not ``Discrete`` from 0, a wrapper that may change what
            the table says, or dynamics that the table does not describe (Taxi with ``fickle_passenger``).

    >>> mdp = mdp_from_gymnasium("FrozenLake-v1")
    >>> mdp.n_states, mdp.n_actions, mdp.horizon
    (16, 4, 100)
    """
    environment = _opened(environment)
    table = environment.unwrapped
    _check_describes_everything(environment)
    n_states, n_actions = _count(table, "observation_space"), _count(table, "action_space")
    outcomes = _outcomes(table, n_states, n_actions)
    initial = _initial(table, n_states)

    source, action, probability, target, reward = outcomes[:, :5].T
    source, action, target = (column.astype(np.int64) for column in (source, action, target))
    terminated = outcomes[:, 5] == 1
    occupied = initial > 0
    occupied[target[~terminated & (source != target)]] = True
    absorbing = np.isin(np.arange(n_states), target[terminated]) & ~occupied
    to_end = terminated & occupied[target]
    if to_end.any():
        target = np.where(to_end, n_states, target)
        absorbing, initial = np.append(absorbing, True), np.append(initial, 0.0)

    total = len(absorbing)
    where = (source, action, target)
    kernel, pay, deviation = (np.zeros((total, n_actions, total)) for _ in range(3))
    np.add.at(kernel, where, probability)
    pay[where] = reward  # of the last outcome; its deviation from the mean is exactly 0 where all outcomes pay the same
    np.add.at(deviation, where, probability * (reward - pay[where]))
    pay[where] += (deviation / np.where(kernel > 0, kernel, 1.0))[where]
    kernel[absorbing], pay[absorbing] = np.eye(total)[absorbing][:, None], 0.0
    names = [str(state) for state in range(n_states)] + [_END] * (total - n_states)
    return TabularMDP(
        transitions=kernel,
        initial=initial,
        horizon=_horizon(environment, horizon),
        reward=pay,
        name=environment.spec.id if environment.spec is not None else type(table).__name__,
        state_names=tuple(names),
        action_names=_ACTION_NAMES.get(type(table).__name__, ()),
        layout=_layout(table, total),
        axes="state-action",
        reward_on="transition",
    )


def _opened(environment: Any) -> Any:
    import gymnasium

    if isinstance(environment, gymnasium.Env):
        return environment
    if not isinstance(environment, str):
        raise InputError(f"environment is {environment!r}, expected a Gymnasium environment or the id of one.")
    try:
        return gymnasium.make(environment)
    except (gymnasium.error.DependencyNotInstalled, ImportError) as error:
        raise InputError(f"Gymnasium cannot make {environment!r} without a package ({error}); install it.") from None
    except gymnasium.error.Error as error:
        raise InputError(f"Gymnasium cannot make {environment!r} ({error}); give an id that it knows.") from None


def _check_describes_everything(environment: Any) -> None:
    table = environment.unwrapped
    if not isinstance(getattr(table, "P", None), dict):
        raise InputError(
            f"{table} has no transition table P[s][a] of (probability, next state, reward, terminated), so its exact "
            "MDP is unknown; expected an environment such as FrozenLake-v1, CliffWalking-v1 or Taxi-v4."
        )
    layer = environment
    while layer is not table:
        if type(layer).__name__ not in _TRANSPARENT_WRAPPERS:
            raise InputError(
                f"the wrapper {type(layer).__name__} around {table} may change rewards, states or actions, which the "
                "transition table does not show; pass the environment without it."
            )
        layer = layer.env
    if getattr(table, "fickle_passenger", False):
        raise InputError(
            "Taxi with fickle_passenger=True changes the destination outside its transition table, so the table is not "
            "its MDP; make it with fickle_passenger=False."
        )


def _count(table: Any, name: str) -> int:
    from gymnasium.spaces import Discrete

    space = getattr(table, name)
    if not isinstance(space, Discrete) or space.start != 0:
        raise InputError(f"the {name} of {table} is {space}, expected Discrete(n) counted from 0.")
    return int(space.n)


def _outcomes(table: Any, n_states: int, n_actions: int) -> FloatArray:
    """(m, 6) rows of state, action, probability, next state, reward, terminated; those of probability 0 left out."""
    try:
        rows = np.array(
            [
                (state, action, p, target, reward, terminated)
                for state in range(n_states)
                for action in range(n_actions)
                for p, target, reward, terminated in table.P[state][action]
            ],
            dtype=np.float64,
        ).reshape(-1, 6)
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise InputError(
            f"the transition table of {table} is not P[s][a] = [(probability, next state, reward, terminated), ...] "
            f"for all {n_states} states and {n_actions} actions ({type(error).__name__}: {error})."
        ) from None
    bad = (rows[:, 3] < 0) | (rows[:, 3] >= n_states) | (rows[:, 3] % 1 != 0)
    if bad.any():
        state, action, _, target = rows[bad][0, :4]
        raise InputError(
            f"P[{state:g}][{action:g}] of {table} leads to state {target:g}, expected one of 0..{n_states - 1}."
        )
    if not (rows[:, 2] >= 0).all():
        state, action, p = rows[~(rows[:, 2] >= 0)][0, :3]
        raise InputError(f"P[{state:g}][{action:g}] of {table} has the probability {p:g}, expected values in [0, 1].")
    return rows[rows[:, 2] > 0]


def _initial(table: Any, n_states: int) -> FloatArray:
    initial = np.array(getattr(table, "initial_state_distrib", np.nan), dtype=np.float64)
    if initial.shape != (n_states,):
        raise InputError(
            f"initial_state_distrib of {table} has shape {initial.shape}, expected ({n_states},): the law of the first "
            "state; set it as an attribute of the environment."
        )
    return initial


def _horizon(environment: Any, horizon: int | None) -> int:
    if horizon is not None:
        return horizon
    limit = environment.spec.max_episode_steps if environment.spec is not None else None
    return limit if limit else int(getattr(environment.unwrapped, "horizon", DEFAULT_HORIZON))


def _layout(table: Any, n_states: int) -> tuple[str, ...]:
    """The map of FrozenLake and CliffWalking, for pictures; empty for other environments."""
    name = type(table).__name__
    if name == "FrozenLakeEnv":
        rows = tuple("".join(character.decode() for character in row) for row in table.desc)
    elif name == "CliffWalkingEnv":
        n_rows, n_columns = table.shape
        rows = ("." * n_columns,) * (n_rows - 1) + ("S" + "C" * (n_columns - 2) + "G",)
    else:
        return ()
    return rows if sum(map(len, rows)) == n_states else ()
