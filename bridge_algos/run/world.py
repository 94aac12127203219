"""What all seeds of a run share: the environment, its expert, and the policy that regret is measured against."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridge_algos.embeddings import Embedding, make_embedding
from bridge_algos.envs.registry import make_mdp
from bridge_algos.expert.experts import Expert, make_expert
from bridge_algos.mdp import FloatArray, IntArray, TabularMDP
from bridge_algos.offline.radius import named_radii
from bridge_algos.online.oracles import BradleyTerryOracle, Oracle, ReturnOracle
from bridge_algos.run.config import RunConfig
from bridge_theory.errors import InputError


@dataclass(frozen=True, eq=False)
class World:
    """Environment, expert and yardsticks of a run.

    Args:
        w_star: (d,) true weights when the utility is linear in the embedding, else None.
        utility_scale: utility per unit of reward, <phi(pi), w*> = utility_scale J(pi); NaN without w*.
        weight_bound: W.
        radii: the offline radius by name; see :mod:`bridge_algos.offline.radius`.
    """

    mdp: TabularMDP
    expert: Expert
    embedding: Embedding
    w_star: FloatArray | None
    utility_scale: float
    weight_bound: float
    radii: dict[str, float]

    @property
    def optimum(self) -> IntArray:
        """(S,) the best stationary deterministic policy found, which pseudo-regret is measured against."""
        return self.expert.best_stationary.policy


def build_world(config: RunConfig) -> World:
    """Environment, expert and yardsticks of a configuration; deterministic."""
    mdp = make_mdp(config.environment, **config.environment_options)
    expert = make_expert(mdp, config.expert, discount=config.discount)
    embedding = make_embedding(config.embedding, mdp.n_states, mdp.n_actions, mdp.horizon)
    weight_bound = 1 / embedding.bound if config.weight_bound is None else config.weight_bound
    w_star, scale = None, np.nan
    if config.embedding == "state_action_counts":
        w_star, scale = _utility(mdp, weight_bound)
    radii = named_radii(mdp.dynamics, expert.policy, config.n_demonstrations, config.delta)
    return World(mdp, expert, embedding, w_star, scale, weight_bound, radii)


def build_oracle(config: RunConfig, world: World) -> Oracle:
    """The configured teacher."""
    if config.oracle == "returns":
        return _return_oracle(config.oracle_options)
    if world.w_star is None:
        raise InputError(
            f"the Bradley-Terry oracle needs rewards that are linear in the embedding, but {config.embedding!r} counts "
            "no pairs; use the embedding 'state_action_counts'."
        )
    return BradleyTerryOracle(world.embedding, world.w_star)


def _return_oracle(options: dict[str, float]) -> ReturnOracle:
    try:
        return ReturnOracle(**options)
    except TypeError:
        known = ", ".join(ReturnOracle.__dataclass_fields__)
        raise InputError(f"unknown oracle option in {sorted(options)}; expected some of {known}.") from None


def _utility(mdp: TabularMDP, weight_bound: float) -> tuple[FloatArray, float]:
    """w* proportional to the expected reward, of norm W; a constant shift of the reward changes no preference."""
    reward = mdp.expected_reward.ravel()
    norm = float(np.linalg.norm(reward))
    if norm == 0:
        raise InputError(f"every expected reward of {mdp.name!r} is zero, so that no preference can be expressed.")
    scale = weight_bound / norm
    return scale * reward, scale
