"""The forms a policy may take, and the one form that general code works with.

Deterministic stationary policies are integer vectors (S,), batches of them integer arrays (N, S); stochastic stationary
ones are (S, A); time-dependent ones are integer (H, S) or stochastic (H, S, A).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridge_algos.given import checked
from bridge_algos.mdp import FloatArray
from bridge_algos.shapes import Policies
from bridge_theory.errors import InputError


@checked
def action_probabilities(policy: ArrayLike, n_states: int, n_actions: int, horizon: int) -> FloatArray:
    """Any single policy as the array pi_h(a|s) of shape (H, S, A).

    Integer arrays are deterministic: (S,) stationary, (H, S) time-dependent. Float arrays are stochastic: (S, A)
    stationary, (H, S, A) time-dependent.

    Raises:
        InputError: for another shape, an action out of range, or rows that are not probability vectors.

    >>> action_probabilities([1, 0], n_states=2, n_actions=2, horizon=1)
    array([[[0., 1.],
            [1., 0.]]])
    """
    array = np.asarray(policy)
    if array.dtype.kind in "iu":
        expected: tuple[tuple[int, ...], ...] = ((n_states,), (horizon, n_states))
        check_actions(array, n_actions)
        probabilities = np.eye(n_actions)[array] if array.shape in expected else array
    elif array.dtype.kind != "f":
        raise InputError(f"a policy holds {array.dtype}, expected actions as integers or probabilities as floats.")
    else:
        expected = ((n_states, n_actions), (horizon, n_states, n_actions))
        probabilities = array.astype(np.float64)
    if array.shape not in expected:
        kind = "deterministic (integers)" if array.dtype.kind in "iu" else "stochastic (floats)"
        raise InputError(f"a {kind} policy has shape {array.shape}, expected one of {list(expected)}.")
    if not np.isfinite(probabilities).all() or (probabilities < 0).any():
        raise InputError("a stochastic policy has an entry that is negative or not finite; expected probabilities.")
    if np.abs(probabilities.sum(axis=-1) - 1).max() > 1e-9:
        raise InputError("a stochastic policy has a row that does not sum to 1 within 1e-09; normalise its rows.")
    if probabilities.ndim == 2:
        probabilities = np.broadcast_to(probabilities, (horizon, *probabilities.shape))
    return np.asarray(probabilities)


def check_actions(policies: NDArray[np.integer], n_actions: int) -> None:
    """Raise InputError unless every action is in range."""
    if policies.size and (policies.min() < 0 or policies.max() >= n_actions):
        raise InputError(
            f"a deterministic policy has actions {int(policies.min())}..{int(policies.max())}, "
            f"expected values in 0..{n_actions - 1}."
        )


@checked
def all_policies(n_states: int, n_actions: int) -> Policies:
    """All A^S deterministic stationary policies, (A^S, S), the last state's action running fastest."""
    return digits(np.arange(n_actions**n_states), [n_actions] * n_states)


def digits(numbers: NDArray[np.int64], bases: Sequence[int]) -> NDArray[np.int64]:
    """Whole numbers (N,) written with one base a place, (N, places), the last place running fastest.

    NumPy's own ways to run through a product stop at 32 or 64 places; states may be more.

    >>> digits(np.arange(6), [2, 3])[3:]
    array([[1, 0],
           [1, 1],
           [1, 2]])
    """
    written = np.empty((len(numbers), len(bases)), dtype=np.int64)
    for place in reversed(range(len(bases))):
        numbers, written[:, place] = np.divmod(numbers, bases[place])
    return written


@checked
def random_policies(n: int, n_states: int, n_actions: int, rng: np.random.Generator) -> Policies:
    """n independent uniform deterministic stationary policies, (n, S)."""
    return rng.integers(n_actions, size=(n, n_states), dtype=np.int64)
