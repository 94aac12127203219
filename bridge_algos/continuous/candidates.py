r"""The finite set of policies that the online stage searches: the clone, and the clone with noise on its parameters.

The set of all policies has no count here, so the paper searches a proxy
:math:`\tilde\Pi = \{\hat\pi, \hat\pi + small noise\} \cup \{\hat\pi + large noise\}` (appendix "Continuous
implementation"): near-copies of the clone, some of which improve on it, and policies that do worse to much worse.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bridge_algos.continuous.policies import MlpPolicy, Policy
from bridge_algos.mdp import FloatArray
from bridge_theory.errors import InputError


@dataclass(frozen=True, eq=False)
class Candidates(Sequence[Policy]):
    """The clone, its noisy copies, and the expert where it is included; copies are made when they are asked for.

    Args:
        clone: candidate 0.
        noise: (small + large,) standard deviation of the noise on every weight and bias of candidate 1, 2, ...
        seeds: one source of noise a copy.
        expert: the last candidate, or None where it is not included.
    """

    clone: MlpPolicy
    noise: FloatArray
    seeds: Sequence[np.random.SeedSequence]
    expert: Policy | None = None

    def __len__(self) -> int:
        return 1 + len(self.noise) + (self.expert is not None)

    def __getitem__(self, index: int) -> Policy:  # type: ignore[override]
        if not 0 <= index < len(self):
            raise IndexError(index)
        if index == 0:
            return self.clone
        if index <= len(self.noise):
            parameters = self.clone.parameters
            draw = np.random.default_rng(self.seeds[index - 1]).standard_normal(len(parameters))
            return self.clone.with_parameters(parameters + self.noise[index - 1] * draw)
        assert self.expert is not None
        return self.expert


def make_candidates(
    clone: MlpPolicy,
    rng: np.random.Generator,
    *,
    small: int = 100,
    large: int = 400,
    sigma: float = 0.01,
    large_factor: float = 5.0,
    expert: Policy | None = None,
) -> Candidates:
    """The clone, ``small`` copies with noise sigma and ``large`` ones with noise ``large_factor`` sigma.

    Args:
        clone: the cloned policy.
        rng: each copy's noise comes from a child of its seed sequence.
        sigma: standard deviation of the Gaussian noise on each weight and bias.
        expert: included as the last candidate where given. The published runs include it; a learner that has only the
            expert's demonstrations does not have it.

    Raises:
        InputError: for a negative number of copies, or a noise that is not positive.
    """
    if small < 0 or large < 0:
        raise InputError(f"{small} and {large} noisy copies were asked for, expected numbers of at least 0.")
    if not (sigma > 0 and large_factor > 0):
        raise InputError(f"the noise is {sigma} and its factor {large_factor}, expected positive numbers.")
    seeds = rng.bit_generator.seed_seq.spawn(small + large)  # type: ignore[attr-defined]
    noise = np.concatenate([np.full(small, sigma), np.full(large, large_factor * sigma)])
    return Candidates(clone, noise, seeds, expert)


def feature_ball(features: FloatArray, center: FloatArray, radius: float) -> NDArray[np.bool_]:
    r"""Which features (N, d) lie in the offline set :math:`\|\phi(\pi) - \phi(\hat\pi)\|_2 < radius`, (N,) booleans.

    The paper's continuous stand-in for the Hellinger ball. The features are estimates, so that membership near the
    sphere is one too. The clone itself is inside for every positive radius.
    """
    if not radius > 0:
        raise InputError(f"the radius of the offline set is {radius}, expected a positive number.")
    return np.asarray(np.linalg.norm(features - center, axis=1) < radius)
