r"""The offline confidence set: deterministic stationary policies in a Hellinger ball around the clone.

.. math:: \Pi^{off} = \{\pi : \sqrt{H^2(P^\pi_{\hat P}, P^{BC}_{\hat P})} \le radius\}   (thm:tabular_confidence_set)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import prod

import numpy as np

from bridge_algos.given import check_fields, check_policy
from bridge_algos.hellinger import disagreement_probability
from bridge_algos.mdp import Dynamics, IntArray
from bridge_algos.offline.ball_chain import ChainSample, chain_sample
from bridge_algos.offline.ball_cubes import ROUNDING_SLACK, Cubes, ball_cubes
from bridge_algos.policies import digits, random_policies
from bridge_algos.shapes import PerPolicy, Policies
from bridge_theory.errors import InputError

PROPOSED_ENTRIES = 2**22
"""Actions drawn at a time by rejection sampling, to bound its memory."""


@dataclass(frozen=True, eq=False)
class PolicySet:
    """The ball of a radius around a deterministic centre under given dynamics.

    Args:
        dynamics: the estimate P-hat (or the known P*), with d_0 and H.
        center: (S,) deterministic policy, usually the clone.
        radius: at least 0 on the scale of H = sqrt(H^2); 1 or more is the set of all policies.
    """

    dynamics: Dynamics
    center: IntArray
    radius: float

    def __post_init__(self) -> None:
        check_fields(self)
        check_policy("center", self.center, self.dynamics.n_states, self.dynamics.n_actions)

    def distances(self, policies: Policies) -> PerPolicy:
        """Hellinger distances H (not squared) of policies (N, S) to the centre, (N,)."""
        disagree = (policies != self.center).astype(np.float64)
        return np.asarray(np.sqrt(disagreement_probability(self.dynamics, self.center, disagree)))

    def contains(self, policies: IntArray) -> np.ndarray:
        """Which of the policies (N, S), or whether the one policy (S,), lies in the set; booleans (N,) or ()."""
        disagree = np.atleast_2d(policies) != self.center
        many = len(disagree) >= 2**self.dynamics.n_states
        inside = self._pattern_inside[_codes(disagree)] if many else self._inside(disagree)
        return inside if policies.ndim == 2 else inside[0]

    def _inside(self, disagree: np.ndarray) -> np.ndarray:
        hit = disagreement_probability(self.dynamics, self.center, disagree.astype(np.float64))
        return np.asarray(hit <= self.radius**2 + ROUNDING_SLACK)

    @cached_property
    def _pattern_inside(self) -> np.ndarray:
        """Membership by disagreement pattern, (2^S,): among more policies than patterns, each is judged once."""
        n_states = self.dynamics.n_states
        return self._inside((np.arange(2**n_states)[:, None] >> np.arange(n_states)) & 1 == 1)

    @cached_property
    def _listing(self) -> Cubes | InputError:
        try:
            return ball_cubes(self.dynamics, self.center, min(self.radius, 1.0) ** 2)
        except InputError as error:  # it took seconds to find out
            return error

    @property
    def is_listed(self) -> bool:
        """Whether the set can be counted and listed; where not, :meth:`chain_sample` still finds members."""
        return isinstance(self._listing, Cubes)

    @property
    def cubes(self) -> Cubes:
        """The set as disjoint cubes; see :func:`bridge_algos.offline.ball_cubes.ball_cubes`."""
        if isinstance(self._listing, InputError):
            raise InputError(str(self._listing))
        return self._listing

    def count(self) -> int:
        """The exact number of policies in the set, out of A^S, as a Python integer."""
        return sum(self.cubes.sizes())

    def enumerate(self, limit: int = 100_000) -> Policies:
        """Every policy of the set, (count, S); InputError when there are more than ``limit``."""
        count = self.count()
        if count > limit:
            raise InputError(
                f"the set has {count:,} policies, above the limit of {limit:,}; use sample() or raise the limit."
            )
        return np.concatenate([self._cube(i) for i in range(len(self.cubes.disagree))])

    def sample(self, n: int, rng: np.random.Generator) -> Policies:
        """n independent policies, uniform over the set, (n, S)."""
        sizes = self.cubes.sizes()
        total = sum(sizes)
        shares = np.array([size / total for size in sizes])
        chosen = rng.choice(len(sizes), size=n, p=shares / shares.sum())
        disagree, free = self.cubes.disagree[chosen], self.cubes.free[chosen]
        n_actions = self.dynamics.n_actions
        anything = rng.integers(n_actions, size=disagree.shape)
        shift = rng.integers(1, max(n_actions, 2), size=disagree.shape)
        other = (self.center + shift) % n_actions
        return np.where(free, anything, np.where(disagree, other, self.center))

    def rejection_sample(self, proposals: int, rng: np.random.Generator) -> Policies:
        """Those of ``proposals`` uniform random policies that lie in the set, without repetitions (the paper's way).

        None or hardly any, where the set is a small part of all policies, as it soon is with many states.
        """
        size = max(1, PROPOSED_ENTRIES // self.dynamics.n_states)
        kept = []
        for start in range(0, proposals, size):
            n = min(size, proposals - start)
            candidates = random_policies(n, self.dynamics.n_states, self.dynamics.n_actions, rng)
            kept.append(candidates[self.contains(candidates)])
        return np.unique(np.concatenate(kept), axis=0)

    def chain_sample(self, n: int, rng: np.random.Generator) -> ChainSample:
        """At most n different members, the centre among them, however large the set: see
        :mod:`bridge_algos.offline.ball_chain`."""
        return chain_sample(self.dynamics, self.center, min(self.radius, 1.0) ** 2, n, rng)

    def _cube(self, index: int) -> IntArray:
        n_actions = self.dynamics.n_actions
        choices = [
            np.arange(n_actions)
            if free
            else np.delete(np.arange(n_actions), center)
            if disagree
            else np.array([center])
            for free, disagree, center in zip(
                self.cubes.free[index], self.cubes.disagree[index], self.center, strict=True
            )
        ]
        sizes = [len(actions) for actions in choices]
        taken = digits(np.arange(prod(sizes)), sizes)
        return np.stack([actions[row] for actions, row in zip(choices, taken.T, strict=True)], axis=1)


def _codes(disagree: np.ndarray) -> IntArray:
    """Each row of booleans (N, S), S < 64, as the whole number whose bits it is."""
    octets = np.packbits(disagree, axis=1, bitorder="little").astype(np.int64)
    return np.asarray((octets << (8 * np.arange(octets.shape[1]))).sum(axis=1))
