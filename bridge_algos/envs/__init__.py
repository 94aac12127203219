"""Tabular environments: the paper's two, families for worst cases, and any Gymnasium environment with a table.

Importing this package loads NumPy only. ``bridge_algos.envs.gymnasium_env`` has the Gymnasium environment itself.
"""

from bridge_algos.envs.families import chain, cliff, garnet
from bridge_algos.envs.from_gymnasium import mdp_from_gymnasium
from bridge_algos.envs.gridworld import gridworld
from bridge_algos.envs.registration import register_environments
from bridge_algos.envs.registry import make_mdp, mdp_names
from bridge_algos.envs.star import star_mdp

__all__ = [
    "chain",
    "cliff",
    "garnet",
    "gridworld",
    "make_mdp",
    "mdp_from_gymnasium",
    "mdp_names",
    "register_environments",
    "star_mdp",
]
