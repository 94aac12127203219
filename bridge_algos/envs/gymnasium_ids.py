"""What Gymnasium knows of a name without making the environment: it needs no simulator for that."""

from __future__ import annotations

import re

TABLES = {
    "frozenlake": "FrozenLake-v1",
    "frozenlake8x8": "FrozenLake8x8-v1",
    "cliffwalking": "CliffWalking-v1",
    "taxi": "Taxi-v4",
}
"""Tabular environments of Gymnasium, by the names that they have here."""
_OWN = "gymnasium.envs."
_MUJOCO = f"{_OWN}mujoco"


def mujoco_id(name: str) -> str | None:
    """The newest id of a MuJoCo environment whose name is meant, in any case and without a version; or None.

    >>> mujoco_id("hopper"), mujoco_id("half-cheetah"), mujoco_id("starmdp")
    ('Hopper-v5', 'HalfCheetah-v5', None)
    """
    import gymnasium

    def plain(text: str) -> str:
        return re.sub(r"[^a-z0-9]", "", re.sub(r"-v\d+$", "", text).lower())

    found = [
        (spec.version or 0, spec.id)
        for spec in gymnasium.registry.values()
        if str(spec.entry_point).startswith(_MUJOCO) and plain(spec.id) == plain(name)
    ]
    return max(found)[1] if found else None


def why_not_mujoco(identifier: str) -> str | None:
    """Why an id cannot be a MuJoCo environment's, or None; one that a module registers is known only when it is made.

    >>> why_not_mujoco("Hopper-v5")
    >>> why_not_mujoco("CartPole-v1")
    "'CartPole-v1' is not simulated by MuJoCo"
    >>> print(why_not_mujoco("hopper"))
    there is no environment 'hopper' (did you mean Hopper-v5?)
    """
    import gymnasium

    if ":" in identifier:
        return None
    spec = gymnasium.registry.get(identifier)
    if spec is None:
        meant = mujoco_id(identifier)
        return f"there is no environment {identifier!r}" + (f" (did you mean {meant}?)" if meant else "")
    entry = str(spec.entry_point)
    if entry.startswith(_OWN) and not entry.startswith(_MUJOCO):
        table = next((name for name, own in TABLES.items() if own == identifier), None)
        return f"{identifier!r} is not simulated by MuJoCo" + (f" (it is tabular: {table!r} here)" if table else "")
    return None
