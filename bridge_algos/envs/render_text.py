"""One state of an episode as text."""

from __future__ import annotations

from bridge_algos.mdp import TabularMDP


def draw(mdp: TabularMDP, state: int, action: int | None, reward: float, step: int) -> str:
    """Step counter, last action and reward, state; for a grid its map with the agent's cell in brackets.

    >>> from bridge_algos.envs.gridworld import gridworld
    >>> print(draw(gridworld("text"), 3, 1, -1.0, 3))
    Gridworld (text), step 3 of 10: right, reward -1
     S  .  - [-]
     .  .  -  -
     .  #  .  .
     .  .  .  G
    state (0,3)
    """
    lines = [caption(mdp, action, reward, step)]
    cell = 0
    for row in mdp.layout:
        marked = [f"[{character}]" if cell + i == state else f" {character} " for i, character in enumerate(row)]
        lines.append("".join(marked).rstrip())
        cell += len(row)
    return "\n".join([*lines, f"state {mdp.state_names[state]}"])


def caption(mdp: TabularMDP, action: int | None, reward: float, step: int) -> str:
    """Name, step counter and what happened last."""
    last = "" if action is None else f": {mdp.action_names[action]}, reward {reward:.4g}"
    return f"{mdp.name}, step {step} of {mdp.horizon}{last}"
