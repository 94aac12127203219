r"""A Gibbs chain over the Hellinger ball around a deterministic policy, for balls too large to be listed.

Under one kernel, H^2 between a deterministic policy and the centre is :math:`F(D)`, the probability that the centre's
trajectory hits the set D of states where the two disagree (audit T14), and F is monotone. A policy of the ball is such
a set with :math:`F(D) \le r^2` and one of the A - 1 other actions in each of its states, so that a uniform policy has a
set of weight :math:`(A-1)^{|D|}` and uniform other actions in it. The chain visits the states in turn: where
:math:`D \cup \{s\}` fits, s joins D with probability (A - 1)/A, else it leaves. That keeps the weights; the empty set,
which is the centre, can be reached from every set and every set from it, so that the law of D tends to the weights.
Nothing bounds how many sweeps that takes: members are certain, their uniformity is not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bridge_algos.given import checked
from bridge_algos.hellinger import disagreement_probability
from bridge_algos.mdp import Dynamics
from bridge_algos.offline.ball_cubes import ROUNDING_SLACK
from bridge_algos.shapes import Policies, Policy
from bridge_theory.errors import InputError

CHAINS = 32
"""Chains that run side by side, each from the centre."""

BURN_IN = 20
"""Sweeps through all states before the first policies are taken."""

LEAST_SWEEPS = 10
"""Sweeps after which policies are taken, whatever that costs."""

WORK_LIMIT = 2e10
"""Multiplications after which no further sweep is made: some seconds."""

REFUSED_WORK = 1e12
"""Multiplications at which not even the fewest sweeps are made: many minutes."""


@dataclass(frozen=True, eq=False)
class ChainSample:
    """What a chain found.

    Args:
        policies: (N, S) different members of the ball, the centre first, the others in the order of their discovery.
        chains, burn_in, sweeps: chains side by side, sweeps before the first policies were taken, and sweeps after
            which one was taken from each chain.
    """

    policies: Policies
    chains: int
    burn_in: int
    sweeps: int


class BallChain:
    """Chains over the disagreement sets of a ball, all in the empty set at first.

    Args:
        dynamics: the estimate, with d_0 and H.
        center: (S,) deterministic policy.
        squared_radius: r^2 in [0, 1].
        chains: how many chains run side by side.
    """

    def __init__(self, dynamics: Dynamics, center: Policy, squared_radius: float, chains: int) -> None:
        self.center, self.n_actions = center, dynamics.n_actions
        self._limit = squared_radius + ROUNDING_SLACK
        alone = disagreement_probability(dynamics, center, np.eye(dynamics.n_states))
        self._met = np.flatnonzero(alone > 0)  # the others change no law, and are as free as if they were alone
        self._unmet = np.flatnonzero(alone == 0)
        self._joining = np.flatnonzero((alone > 0) & (alone <= self._limit))
        kernel = dynamics.transitions[self._met, center[self._met]][:, None, self._met]  # the centre's only action
        self._dynamics = Dynamics(kernel, dynamics.initial[self._met], dynamics.horizon)
        self._only = np.zeros(len(self._met), dtype=np.int64)
        self.disagree: NDArray[np.bool_] = np.zeros((chains, dynamics.n_states), dtype=np.bool_)
        self.work_per_sweep = 2.0 * chains * dynamics.horizon * len(self._joining) * len(self._met) ** 2

    def sweep(self, rng: np.random.Generator) -> None:
        """Visit every state once: it joins each chain's set with probability (A - 1)/A where it fits, else leaves."""
        sets, share = self.disagree, 1 - 1 / self.n_actions
        sets[:, self._unmet] = rng.random((len(sets), len(self._unmet))) < share
        for state in self._joining:
            wanted = np.flatnonzero(rng.random(len(sets)) < share)
            sets[:, state] = False
            sets[wanted, state] = True
            inside = sets[np.ix_(wanted, self._met)].astype(np.float64)
            fits = disagreement_probability(self._dynamics, self._only, inside) <= self._limit
            sets[wanted, state] = fits

    def policies(self, rng: np.random.Generator) -> Policies:
        """A policy of each chain's set, (chains, S): uniform among the other actions where it disagrees."""
        shift = rng.integers(1, max(self.n_actions, 2), size=self.disagree.shape)
        return np.where(self.disagree, (self.center + shift) % self.n_actions, self.center)


@checked
def chain_sample(
    dynamics: Dynamics, center: Policy, squared_radius: float, n: int, rng: np.random.Generator
) -> ChainSample:
    """At most n different policies with H^2 <= r^2 to the centre, the centre among them.

    Args:
        center: (S,) deterministic policy.
        squared_radius: r^2 in [0, 1].
        n: at least 1. Fewer are found where the ball is small, or where they take more than ``WORK_LIMIT``.
        rng: the source of all randomness.

    Raises:
        InputError: when the fewest sweeps take more than ``REFUSED_WORK`` multiplications.
    """
    chain = BallChain(dynamics, center, squared_radius, CHAINS)
    if (BURN_IN + LEAST_SWEEPS) * chain.work_per_sweep > REFUSED_WORK:
        raise InputError(
            f"sampling the ball over {dynamics.n_states} states at horizon {dynamics.horizon} takes more than "
            f"{REFUSED_WORK:.0e} multiplications; shorten the horizon, or use radius=zero."
        )
    affordable = int(WORK_LIMIT / max(chain.work_per_sweep, 1.0)) - BURN_IN
    most = max(LEAST_SWEEPS, min(affordable, 4 * n // CHAINS))
    for _ in range(BURN_IN):
        chain.sweep(rng)
    found, sweeps = {center.tobytes(): center}, 0
    while sweeps < most and len(found) < n:
        chain.sweep(rng)
        sweeps += 1
        for policy in chain.policies(rng):
            if len(found) < n:
                found.setdefault(policy.tobytes(), policy)
    return ChainSample(np.stack(list(found.values())), CHAINS, BURN_IN, sweeps)
