"""A run in the symbols of the theory."""

from __future__ import annotations

from bridge_algos.offline.radius import minimum_visitation
from bridge_algos.run.config import RunConfig
from bridge_algos.run.world import World
from bridge_theory.setting import Setting


def theory_setting(config: RunConfig, world: World) -> Setting:
    """The parameters of the formulas that a run determines, but T; decimals of the configuration are exact decimals.

    gamma_min is that of the run's expert under the real dynamics, which only the true world knows.
    """
    mdp = world.mdp
    return Setting(
        S=mdp.n_states,
        A=mdp.n_actions,
        H=mdp.horizon,
        n=config.n_demonstrations if world.demonstrations is None else len(world.demonstrations),
        K=config.comparisons,
        d=world.embedding.dimension,
        B=world.embedding.bound,
        W=world.weight_bound if config.weight_bound is None else repr(config.weight_bound),
        lam=repr(config.lam),
        gamma_min=minimum_visitation(mdp.dynamics, world.expert.policy),
        delta=repr(config.delta),
    )
