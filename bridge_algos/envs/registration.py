"""The package's environments under Gymnasium ids.

Gymnasium (1.4) loads no plugins by itself: either call :func:`register_environments` first, or name the
module in the id, ``gymnasium.make("bridge_algos.envs.gymnasium_env:bridge_rl/StarMDP-v0")``, whose import registers.
"""

from __future__ import annotations

NAMESPACE = "bridge_rl"

GYMNASIUM_NAMES = {
    "StarMDP-v0": "starmdp",
    "StarMDPText-v0": "starmdp-text",
    "Gridworld-v0": "gridworld",
    "GridworldText-v0": "gridworld-text",
    "Chain-v0": "chain",
    "Cliff-v0": "cliff",
    "Garnet-v0": "garnet",
}


def register_environments() -> tuple[str, ...]:
    """Register every environment of the package with Gymnasium and return the ids; once or often, with one effect.

    Options of ``make_mdp`` go through ``gymnasium.make``: ``gymnasium.make("bridge_rl/Chain-v0", n_states=8)``. No time
    limit is registered, as the environments end after their own horizon.
    """
    from gymnasium.envs.registration import register, registry

    ids = []
    for name, mdp in GYMNASIUM_NAMES.items():
        identifier = f"{NAMESPACE}/{name}"
        if identifier not in registry:
            register(identifier, entry_point="bridge_algos.envs.gymnasium_env:TabularEnv", kwargs={"mdp": mdp})
        ids.append(identifier)
    return tuple(ids)
