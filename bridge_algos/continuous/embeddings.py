r"""Embeddings of continuous trajectories, :math:`\phi(\tau) \in R^d` (paper, table "Continuous embedding definitions").

======================  =========================================================  ==================  =============
name                    definition                                                 d                   the paper's B
======================  =========================================================  ==================  =============
average_state_action    (1/H) sum_h (s_h, a_h)                                     d_s + d_a           sqrt(d)
final_state             s_H                                                        d_s                 sqrt(d)
reacher_reward          (1/H) sum_h (||tip - target||^2, ||a_h||^2)                2                   2 sqrt(2)
ant_reward              (1/H) sum_h (1, v_x, ||a_h||^2, 5e-4 ||contacts||^2)       4                   -
======================  =========================================================  ==================  =============

``ant_reward`` (not in the paper; the terms of Ant-v5's reward) sums over the steps until a fall. Sums are over the
steps that took place and are divided by the horizon H, as defined; the authors' published runs divide by the
number of steps instead (the same unless an episode ends early) and take the distance in ``reacher_reward`` unsquared.

The bounds B assume that all coordinates lie in [-1, 1], which MuJoCo's observations do not. So no bound is claimed
here: :mod:`bridge_algos.continuous.features` measures what was seen.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bridge_algos.continuous.episodes import Episodes
from bridge_algos.mdp import FloatArray
from bridge_theory.errors import InputError

EmbeddingFunction = Callable[[Episodes], FloatArray]


def average_state_action(episodes: Episodes) -> FloatArray:
    """Sum of states and actions over the episode, divided by H, (n, d_s + d_a)."""
    sums = [episodes.states.sum(axis=1), episodes.actions.sum(axis=1, dtype=np.float64)]
    return np.concatenate(sums, axis=1) / episodes.horizon


def final_state(episodes: Episodes) -> FloatArray:
    """The state that precedes the last action, (n, d_s)."""
    return np.asarray(episodes.observations[np.arange(len(episodes)), episodes.lengths - 1])


def reacher_reward(episodes: Episodes) -> FloatArray:
    """Mean squared distance of Reacher's fingertip to its target, and mean squared action, (n, 2)."""
    squared_distance = (episodes.states[:, :, 8:10] ** 2).sum(axis=(1, 2))
    return np.column_stack([squared_distance, _squared_actions(episodes)]) / episodes.horizon


def ant_reward(episodes: Episodes) -> FloatArray:
    """The terms of Ant's reward: survival, forward velocity, squared action, squared contact forces; (n, 4)."""
    states = episodes.states
    terms = [episodes.lengths, states[:, :, 13].sum(axis=1), _squared_actions(episodes)]
    contacts = 5e-4 * (states[:, :, 27:] ** 2).sum(axis=(1, 2))
    return np.column_stack([*terms, contacts]) / episodes.horizon


def _squared_actions(episodes: Episodes) -> FloatArray:
    return np.asarray((episodes.actions.astype(np.float64) ** 2).sum(axis=(1, 2)))


GENERAL: dict[str, EmbeddingFunction] = {
    "average_state_action": average_state_action,
    "final_state": final_state,
}
SPECIFIC: dict[str, dict[str, EmbeddingFunction]] = {
    "Reacher-v5": {"reacher_reward": reacher_reward},
    "Ant-v5": {"ant_reward": ant_reward},
}
NAMES = (*GENERAL, *(name for functions in SPECIFIC.values() for name in functions))


def embeddings_for(gymnasium_id: str) -> dict[str, EmbeddingFunction]:
    """The named embeddings that an environment has.

    >>> list(embeddings_for("Reacher-v5"))
    ['average_state_action', 'final_state', 'reacher_reward']
    """
    return GENERAL | SPECIFIC.get(gymnasium_id, {})


@dataclass(frozen=True, eq=False)
class Embedding:
    """A named embedding, divided by a scale for each coordinate.

    Args:
        name: how results call it.
        function: from episodes to (n, d).
        scale: (d,) positive; ones leave the embedding as it is.
    """

    name: str
    function: EmbeddingFunction
    scale: FloatArray

    def __call__(self, episodes: Episodes) -> FloatArray:
        return np.asarray(self.function(episodes) / self.scale)


def make_embedding(
    name: str,
    gymnasium_id: str,
    demonstrations: Episodes,
    normalise: bool = False,
    user: EmbeddingFunction | None = None,
) -> Embedding:
    """An embedding by name, or a user's function under that name.

    Args:
        demonstrations: they give d and, where ``normalise`` is set, the scale: each coordinate is divided by the
            largest absolute value that it takes in them (1 where that is zero), so that demonstrations lie in
            [-1, 1]^d. Other policies' trajectories may leave that box.
        user: a function from episodes to (n, d) that treats episodes one by one.

    Raises:
        InputError: an unknown name, or a user's function whose values are not finite numbers of shape (n, d).
    """
    known = embeddings_for(gymnasium_id)
    if user is None and name not in known:
        raise InputError(
            f"{gymnasium_id} has no embedding {name!r}; expected one of {', '.join(known)}, or a function of yours."
        )
    function = known[name] if user is None else user
    values = np.asarray(function(demonstrations))
    if values.ndim != 2 or len(values) != len(demonstrations) or not np.isfinite(values).all():
        raise InputError(
            f"the embedding {name!r} gives values of shape {values.shape} for {len(demonstrations)} episodes, expected "
            f"finite numbers of shape ({len(demonstrations)}, d)."
        )
    largest = np.abs(values).max(axis=0)
    scale = np.where(largest > 0, largest, 1.0) if normalise else np.ones(values.shape[1])
    return Embedding(name, function, scale)
