"""Families of MDPs for worst cases and for property tests: random ones, a hard-exploration chain, a cliff."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np

from bridge_algos.envs.grid import DIRECTIONS, NO_CELL, cell_names, move_targets
from bridge_algos.mdp import TabularMDP
from bridge_theory.errors import InputError


def garnet(n_states: int, n_actions: int, branching: int, rng: np.random.Generator, horizon: int = 10) -> TabularMDP:
    r"""A random MDP: each pair leads to ``branching`` distinct states drawn uniformly.

    Their probabilities are the gaps between branching - 1 sorted uniform points of [0, 1], i.e. uniform on the simplex.
    The rewards of the pairs (S, A) are independent and uniform on [0, 1); the first state is uniform.

    Source: T. W. Archibald, K. I. M. McKinnon, L. C. Thomas, "On the generation of Markov decision processes", Journal
    of the Operational Research Society 46 (1995) 354-361.

    Args:
        n_states, n_actions: S >= 1 and A >= 1.
        branching: number of possible next states of a pair, 1..S.
        rng: the source of all randomness; the same generator state gives the same MDP.
        horizon: H >= 1.

    Raises:
        InputError: for a number out of range.

    >>> mdp = garnet(6, 2, 3, np.random.default_rng(0))
    >>> bool(((mdp.transitions > 0).sum(axis=2) == 3).all())
    True
    """
    n_states, n_actions = _whole("n_states", n_states), _whole("n_actions", n_actions)
    branching = _whole("branching", branching)
    if branching > n_states:
        raise InputError(f"branching is {branching}, expected at most the number of states, {n_states}.")
    if not isinstance(rng, np.random.Generator):
        raise InputError(f"rng is {rng!r}, expected a numpy Generator such as numpy.random.default_rng(0).")
    pairs = (n_states, n_actions)
    successors = rng.permuted(np.broadcast_to(np.arange(n_states), (*pairs, n_states)), axis=2)[..., :branching]
    cuts = np.sort(rng.random((*pairs, branching - 1)), axis=2)
    kernel = np.zeros((*pairs, n_states))
    np.put_along_axis(kernel, successors, np.diff(cuts, axis=2, prepend=0.0, append=1.0), axis=2)
    return TabularMDP(
        transitions=kernel,
        initial=np.full(n_states, 1 / n_states),
        horizon=_whole("horizon", horizon),
        reward=rng.random(pairs),
        name=f"Garnet({n_states}, {n_actions}, {branching})",
        axes="state-action",
        reward_on="pair",
    )


def chain(n_states: int = 5, slip: float = 0.2, horizon: int = 10) -> TabularMDP:
    r"""Hard exploration: n - 1 unpaid steps to the end of a chain, against a small sure pay for going back.

    ``forward`` moves one state on, at the end it stays and pays 10; ``back`` returns to the start and pays 2; with
    probability ``slip`` the other of the two happens. A uniformly random walker passes n - 1 states in a row with
    probability 2^{-(n-1)}.

    Source: M. Strens, "A Bayesian framework for reinforcement learning", ICML 2000 (its "Chain": n = 5, slip 0.2).

    Args:
        n_states: n >= 2.
        slip: in [0, 1].
        horizon: H >= 1; below n the end pays nothing.

    Raises:
        InputError: for a number out of range.

    >>> chain(3, slip=0.25).transitions[1]
    array([[0.25, 0.  , 0.75],
           [0.75, 0.  , 0.25]])
    """
    n_states, slip = _whole("n_states", n_states, least=2), _probability("slip", slip)
    forward = np.eye(n_states)[np.minimum(np.arange(n_states) + 1, n_states - 1)]
    back = np.tile(np.eye(n_states)[0], (n_states, 1))
    reward = np.zeros((n_states, 2, n_states))
    reward[:, :, 0] = 2.0
    reward[-1, :, -1] = 10.0
    return TabularMDP(
        transitions=np.stack([(1 - slip) * forward + slip * back, slip * forward + (1 - slip) * back], axis=1),
        initial=np.eye(n_states)[0],
        horizon=_whole("horizon", horizon),
        reward=reward,
        name="Chain",
        action_names=("forward", "back"),
        axes="state-action",
    )


def cliff(n_rows: int = 3, n_columns: int = 5, slip: float = 0.1, fall: float = -20.0, horizon: int = 12) -> TabularMDP:
    r"""A grid whose shortest way to the goal leads along a cliff: one wrong action costs more than the whole way.

    Start bottom left, goal bottom right, cliff cells between them. A move off the map stays in place; with probability
    ``slip`` the move is replaced by one drawn uniformly from all four. Arriving in a cliff cell pays ``fall``, and
    every action there leads back to the start; the goal is absorbing and pays 0; every other arrival pays -1.

    Source: after example 6.6 of R. Sutton and A. Barto, "Reinforcement Learning: An Introduction" (2020), with the fall
    as a state of its own, so that the reward is a function of the state arrived at.

    Args:
        n_rows: >= 2.
        n_columns: >= 3.
        slip: in [0, 1].
        fall: finite reward of falling.
        horizon: H >= 1; the goal needs at least n_columns + 1 steps.

    Raises:
        InputError: for a number out of range.

    >>> cliff(2, 4).layout
    ('....', 'SCCG')
    """
    n_rows, n_columns = _whole("n_rows", n_rows, least=2), _whole("n_columns", n_columns, least=3)
    slip = _probability("slip", slip)
    if isinstance(fall, bool) or not isinstance(fall, (int, float, np.number)):
        raise InputError(f"fall is {fall!r}, expected a number.")
    layout = ("." * n_columns,) * (n_rows - 1) + ("S" + "C" * (n_columns - 2) + "G",)
    cells = np.array(list("".join(layout)))
    n_states = len(cells)
    start, goal, is_cliff = n_states - n_columns, n_states - 1, cells == "C"
    targets = move_targets(layout)
    moves = np.eye(n_states)[np.where(targets == NO_CELL, np.arange(n_states)[:, None], targets)]
    kernel = (1 - slip) * moves + slip * moves.mean(axis=1, keepdims=True)
    kernel[is_cliff] = np.eye(n_states)[start]
    kernel[goal] = np.eye(n_states)[goal]
    reward = np.where(is_cliff, fall, -1.0)
    reward[goal] = 0.0
    return TabularMDP(
        transitions=kernel,
        initial=np.eye(n_states)[start],
        horizon=_whole("horizon", horizon),
        reward=reward,
        name="Cliff",
        state_names=cell_names(layout),
        action_names=DIRECTIONS,
        axes="state-action",
        reward_on="arrival",
        layout=layout,
    )


def _whole(name: str, value: Any, least: int = 1) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        number = least - 1
    if number < least or isinstance(value, bool):
        raise InputError(f"{name} is {value!r}, expected a whole number of at least {least}.")
    return number


def _probability(name: str, value: Any) -> float:
    real = isinstance(value, int | float | np.number) and not isinstance(value, bool | np.complexfloating)
    number = float(value) if real else -1.0
    if not 0 <= number <= 1:
        raise InputError(f"{name} is {value!r}, expected a probability between 0 and 1.")
    return number
