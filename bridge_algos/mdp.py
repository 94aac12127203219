"""Finite-horizon tabular Markov decision processes and what is wrong with one, said in sentences.

A trajectory has H state-action pairs (s_1, a_1), ..., (s_H, a_H) (section "Problem formulation" of the paper). Step h
pays the reward of the transition s_h, a_h -> s_{h+1}; the arrival after the last action is paid too, as by the ``step``
of an environment, although s_{H+1} is not part of the trajectory.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridge_algos.conventions import settled
from bridge_algos.given import check_fields
from bridge_theory.errors import InputError

ROW_SUM_TOLERANCE = 1e-9

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Indices = IntArray | int


@dataclass(frozen=True, eq=False)
class Dynamics:
    """How states follow one another: kernel, initial law and horizon.

    Args:
        transitions: (S, A, S) kernel P(s'|s, a); rows are probability vectors. Hellinger distances also take a
            time-dependent kernel (H - 1, S, A, S).
        initial: (S,) law d_0 of the first state.
        horizon: H >= 1, the number of state-action pairs in a trajectory.
    """

    transitions: FloatArray
    initial: FloatArray
    horizon: int

    def __post_init__(self) -> None:
        check_fields(self)
        shape = self.transitions.shape
        if len(shape) not in (3, 4) or shape[-3] != shape[-1]:
            raise InputError(f"a kernel has shape {shape}, expected (S, A, S), or (H - 1, S, A, S) by step.")
        if len(shape) == 4 and shape[0] != self.horizon - 1:
            raise InputError(
                f"a time-dependent kernel has {shape[0]} steps, expected H - 1 = {self.horizon - 1}: one for each "
                "transition between the H states of a trajectory."
            )

        if self.initial.shape != shape[-1:]:
            raise InputError(f"initial has shape {self.initial.shape}, expected ({shape[-1]},), one entry a state.")
        for name, rows in (("transitions", self.transitions), ("initial", self.initial)):
            if (np.abs(rows.sum(axis=-1) - 1) > ROW_SUM_TOLERANCE).any():
                raise InputError(f"{name} has a row that does not sum to 1 within {ROW_SUM_TOLERANCE:g}; normalise it.")

    @property
    def n_states(self) -> int:
        return int(self.transitions.shape[-1])

    @property
    def n_actions(self) -> int:
        return int(self.transitions.shape[-2])

    @cached_property
    def cumulative(self) -> FloatArray:
        """Running sums of the kernel's rows, which end in exactly 1: what sampling compares uniform numbers with."""
        return running_sums(self.transitions)

    @cached_property
    def cumulative_initial(self) -> FloatArray:
        """The same of the first state's law."""
        return running_sums(self.initial)

    def under(self, transitions: FloatArray) -> Dynamics:
        """The same initial law and horizon with another kernel (for example an estimate)."""
        return Dynamics(transitions, self.initial, self.horizon)


def running_sums(probabilities: FloatArray) -> FloatArray:
    """Cumulative probabilities along the last axis, scaled to end in exactly 1."""
    cumulative = np.cumsum(probabilities, axis=-1)
    return np.asarray(cumulative / cumulative[..., -1:])


@dataclass(frozen=True, eq=False)
class TabularMDP:
    r"""A finite MDP (S, A, P, d_0, H) with a reward, validated on construction.

    Args:
        transitions: (S, A, S) kernel P(s'|s, a), or (A, S, S) with ``axes="action-state"``; kept as (S, A, S).
        initial: (S,) law of the first state.
        horizon: H >= 1.
        reward: (S,) reward of a state, or (S, A) of the pair, or of the transition in the shape of ``transitions``.
        name, state_names, action_names: labels for tables and pictures.
        axes: ``"state-action"`` or ``"action-state"``, what the first two axes are; needed where S = A alone.
        reward_on: ``"arrival"`` or ``"departure"``, whether (S,) rewards are paid to those who arrive in a state or to
            those who act in it, which is kept as a reward of the pair; ``"pair"`` for (S, A), needed where S = A alone;
            ``"transition"``.

    Raises:
        InputError: with every fault that :func:`check_mdp` finds.

    >>> kernel = [[[0.5, 0.5]], [[0.0, 1.0]]]
    >>> mdp = TabularMDP(transitions=kernel, initial=[1, 0], horizon=2, reward=[0, 1], reward_on="arrival")
    >>> mdp.n_states, mdp.n_actions, mdp.horizon
    (2, 1, 2)
    >>> mdp.expected_reward.ravel()
    array([0.5, 1. ])
    >>> TabularMDP(transitions=kernel, initial=[1, 0], horizon=2, reward=[0, 1], reward_on="departure").reward.ravel()
    array([0., 1.])
    """

    transitions: FloatArray
    initial: FloatArray
    horizon: int
    reward: FloatArray
    name: str = "mdp"
    state_names: tuple[str, ...] = ()
    action_names: tuple[str, ...] = ()
    layout: tuple[str, ...] = field(default=(), repr=False)
    """Rows of a character map for pictures, one character a state in reading order; empty when the MDP is no grid."""
    axes: str = ""
    reward_on: str = ""

    def __post_init__(self) -> None:
        faults = check_mdp(self.transitions, self.initial, self.horizon, self.reward, self.axes, self.reward_on)
        if faults:
            raise InputError(f"the MDP {self.name!r} is not valid: " + " ".join(faults))
        kernel, pay = (np.asarray(array, dtype=np.float64) for array in (self.transitions, self.reward))
        kernel, pay, paid_on, _ = settled(kernel, pay, self.axes, self.reward_on)
        for name, values in (("transitions", kernel), ("initial", self.initial), ("reward", pay)):
            array = np.array(values, dtype=np.float64, order="C")
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        object.__setattr__(self, "axes", "state-action")
        object.__setattr__(self, "reward_on", paid_on)
        object.__setattr__(self, "horizon", int(self.horizon))
        for name, count in (("state_names", self.n_states), ("action_names", self.n_actions)):
            given = tuple(str(label) for label in getattr(self, name)) or tuple(f"{name[0]}{i}" for i in range(count))
            if len(given) != count:
                raise InputError(f"{name} of {self.name!r} has {len(given)} entries, expected {count}, one for each.")
            object.__setattr__(self, name, given)
        cells = sum(len(row) for row in self.layout)
        if self.layout and (cells != self.n_states or len(set(map(len, self.layout))) != 1):
            raise InputError(
                f"layout of {self.name!r} has rows of {[len(row) for row in self.layout]} characters, expected a "
                f"rectangle of {self.n_states}, one for each state."
            )

    @property
    def n_states(self) -> int:
        return int(self.transitions.shape[0])

    @property
    def n_actions(self) -> int:
        return int(self.transitions.shape[1])

    @cached_property
    def dynamics(self) -> Dynamics:
        return Dynamics(self.transitions, self.initial, self.horizon)

    @cached_property
    def expected_reward(self) -> FloatArray:
        """(S, A) expected reward of a pair, E[r(s, a, s')]."""
        if self.reward.ndim == 1:
            return np.asarray(self.transitions @ self.reward)
        if self.reward.ndim == 2:
            return self.reward
        return np.asarray(np.einsum("sap,sap->sa", self.transitions, self.reward))

    def realised_rewards(self, states: Indices, actions: Indices, arrivals: Indices) -> FloatArray:
        """Rewards of transitions s, a -> s', element by element, in whichever form the reward was given."""
        index: tuple[Indices, ...] = ((arrivals,), (states, actions), (states, actions, arrivals))[self.reward.ndim - 1]
        return np.asarray(self.reward[index])

    @classmethod
    def from_gymnasium(cls, environment: Any, horizon: int | None = None) -> TabularMDP:
        """The MDP behind a Gymnasium environment that has a transition table (``bridge_algos.envs.from_gymnasium``)."""
        from bridge_algos.envs.from_gymnasium import mdp_from_gymnasium

        return mdp_from_gymnasium(environment, horizon)


def check_mdp(
    transitions: ArrayLike,
    initial: ArrayLike,
    horizon: int,
    reward: ArrayLike,
    axes: str = "",
    reward_on: str = "",
) -> list[str]:
    """What is wrong with an MDP, one sentence a fault; an empty list when nothing is.

    The arguments are those of :class:`TabularMDP`.

    >>> check_mdp([[[0.5, 0.4]], [[0, 1]]], [1, 0], 0, [0, 1], reward_on="arrival")
    ['horizon is 0, expected a whole number of at least 1.',
     'transitions[0, 0] sums to 0.9, expected 1 within 1e-09.']
    """
    faults = []
    if isinstance(horizon, bool) or not isinstance(horizon, (int, np.integer)) or horizon < 1:
        faults.append(f"horizon is {horizon!r}, expected a whole number of at least 1.")
    try:
        kernel, start, pay = (_real(array) for array in (transitions, initial, reward))
    except (TypeError, ValueError):
        return [
            *faults,
            "transitions, initial and reward must be arrays of numbers; at least one is ragged or not numeric.",
        ]
    if kernel.ndim != 3 or kernel.shape[axes == "action-state"] != kernel.shape[2] or 0 in kernel.shape:
        shape = "(A, S, S)" if axes == "action-state" else "(S, A, S), or (A, S, S) with axes='action-state',"
        return [*faults, f"transitions has shape {kernel.shape}, expected {shape} with S and A at least 1."]
    if not 1 <= pay.ndim <= 3 or 0 in pay.shape:
        return [*faults, f"reward has shape {pay.shape}, expected one to three axes (state, pair or transition)."]
    kernel, pay, _, ambiguities = settled(kernel, pay, axes, reward_on)
    faults += ambiguities
    n_states, n_actions, _ = kernel.shape
    if start.shape != (n_states,):
        return [*faults, f"initial has shape {start.shape}, expected ({n_states},), one probability a state."]
    faults += _probability_faults("transitions", kernel) + _probability_faults("initial", start)
    shapes = [(n_states,), (n_states, n_actions), (n_states, n_actions, n_states)]
    if pay.shape not in shapes:
        faults.append(f"reward has shape {pay.shape}, expected one of {shapes} (state, pair or transition).")
    elif not np.isfinite(pay).all():
        faults.append(f"reward has a value that is not finite at {_first(~np.isfinite(pay))}; give finite numbers.")
    return faults


def _real(array: ArrayLike) -> FloatArray:
    given = np.asarray(array)
    if given.dtype.kind not in "biufO":  # NumPy would drop imaginary parts, and count the days of dates
        raise TypeError(f"{given.dtype} is not numeric")
    return given.astype(np.float64)


def _probability_faults(name: str, array: FloatArray) -> list[str]:
    if not np.isfinite(array).all():
        return [f"{name}{_first(~np.isfinite(array))} is not a finite number, expected a probability."]
    if (array < 0).any():
        where = _first(array < 0)
        return [f"{name}{where} is {array[tuple(where)]:g}, a negative probability; expected values in [0, 1]."]
    sums = np.asarray(array.sum(axis=-1))
    wrong = np.abs(sums - 1) > ROW_SUM_TOLERANCE
    if not wrong.any():
        return []
    where = _first(wrong)
    total = float(sums[tuple(where)])
    if array.ndim == 3 and total == 0:
        return [f"{name}{where} is all zero, so that no trajectory through it reaches the horizon; make it absorbing."]
    return [f"{name}{where if where else ''} sums to {total:.12g}, expected 1 within {ROW_SUM_TOLERANCE:g}."]


def _first(mask: NDArray[np.bool_]) -> list[int]:
    return [int(i) for i in np.argwhere(mask)[0]]
