"""Which policy a certificate's regret is measured against, from every entry of the log that decides it.

The bounds hold against the best of the policies searched, whoever that is. It is the best stationary deterministic
policy where all policies are searched, which the data show; or where exactly those that agree with the demonstrations
are (which the data show too) and the demonstrations come from such a policy. The latter is the word of the
configuration: the expert must be ``best-stationary``, its actions recorded without noise and not read from a file, and
the embedding one in which the reward that this expert maximises is linear, so that it is the utility of the bounds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from proofs_checks.verify.facts import Facts
from proofs_checks.verify.features import IntArray

LINEAR = ("state_action_counts",)
"""Embeddings in which every reward is linear, so that the expert's criterion is the utility <phi, w*>."""

STATIONARY = ("best-stationary", "discounted-lp")
"""Experts that are one deterministic policy in every step."""

BEST = "the best stationary deterministic policy"
SEARCHED = "the best of the policies searched"


@dataclass(frozen=True)
class Comparator:
    """What regret is measured against.

    Args:
        policy: ``BEST`` or ``SEARCHED``.
        reason: why it is among the policies searched, or why no more can be said.
        assumed: what that rests on beyond the data, "" where the data show it.
    """

    policy: str
    reason: str
    assumed: str = ""

    @property
    def sentence(self) -> str:
        """What regret is measured against, as a clause."""
        return f"regret against {self.policy}: {self.reason}"


def comparator(facts: Facts) -> Comparator:
    """What the regret of a certificate is measured against."""
    _, n_states, n_actions, _ = facts.table.places.shape
    distinct = len(np.unique(facts.policies, axis=0))
    if distinct == n_actions**n_states:
        return Comparator(BEST, "it is searched because all policies are")
    if demonstrated_by_the_best(facts) and distinct == version_space_size(facts) and not disagreeing(facts).any():
        return Comparator(
            BEST,
            "it is searched because every policy that agrees with all demonstrations is",
            "the demonstrations come from a best stationary deterministic policy (up to rounding), as the "
            "configuration's expert 'best-stationary' says",
        )
    return Comparator(SEARCHED, "a log cannot show how good that is")


def demonstrated_by_the_best(facts: Facts) -> bool:
    """Whether the configuration says so: every entry that decides it."""
    config = facts.configuration
    return (
        config["expert"] == "best-stationary"
        and config["demonstrations"] is None
        and config["noise"] == 0
        and config["embedding"] in LINEAR
        and not contradictory(facts)
    )


def version_space_size(facts: Facts) -> int:
    """How many policies agree with demonstrations that do not contradict each other."""
    _, n_states, n_actions, _ = facts.table.places.shape
    unvisited = n_states - len(np.unique(facts.demonstrations[0]))
    return int(n_actions**unvisited)


def disagreeing(facts: Facts) -> NDArray[np.bool_]:
    """Which of the policies searched do not agree with every demonstration, (N,)."""
    states, actions = facts.demonstrations
    return np.asarray((facts.policies[:, states.ravel()] != actions.ravel()).any(axis=1))


def contradictory(facts: Facts) -> bool:
    """Whether two demonstrated actions differ in one state."""
    return _differing(*facts.demonstrations)


def contradictory_steps(facts: Facts) -> bool:
    """Whether two demonstrated actions differ in one state at one step."""
    states, actions = facts.demonstrations
    return any(_differing(states[:, h], actions[:, h]) for h in range(states.shape[1]))


def _differing(states: IntArray, actions: IntArray) -> bool:
    pairs = np.unique(np.stack([states.ravel(), actions.ravel()]), axis=1)
    return bool(pairs.shape[1] > len(np.unique(states)))
