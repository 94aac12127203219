"""The actor in the weights of a Stable-Baselines3 policy: every array of it is used, or the policy is refused."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from bridge_algos.continuous.policies import MlpPolicy
from bridge_algos.mdp import FloatArray
from bridge_theory.errors import InputError

_IGNORED = ("mlp_extractor.value_net.", "value_net.", "critic.", "critic_target.", "actor_target.", "actor.log_std")
"""Arrays of the value networks, of copies, and of the spread that a squashed actor draws with: no mean needs them."""


def policy_from_sb3_state(state: Mapping[str, FloatArray], source: str, **settings: Any) -> MlpPolicy:
    """The actor in a state dictionary of an SB3 policy of PPO, A2C, TD3, DDPG or SAC.

    Args:
        state: arrays by name, such as "actor.mu.0.weight" of shape (fan_out, fan_in).
        source: names the model in messages.
        settings: fields of :class:`MlpPolicy` that the weights do not show, such as ``activation`` and ``squashed``;
            by default the algorithm's: a Gaussian mean with tanh layers for PPO and A2C, squashed with relu layers
            for the others.

    Raises:
        InputError: no known actor is in it, or arrays that such an actor does not have.
    """
    stochastic = "action_net.weight" in state
    layers = _actor_critic_layers(state) if stochastic else _actor_layers(state)
    missing = [name for layer in layers for name in (f"{layer}.weight", f"{layer}.bias") if name not in state]
    if not layers or missing:
        lacking = f" (it lacks {', '.join(missing)})" if missing else ""
        raise InputError(
            f"{source} holds no actor of linear layers with biases{lacking}; expected PPO, A2C, TD3, DDPG or SAC with "
            "MlpPolicy."
        )
    used = {f"{layer}.{part}" for layer in layers for part in ("weight", "bias")} | {"log_std"}
    foreign = [name for name in state if name not in used and not name.startswith(_IGNORED)]
    if foreign:
        raise InputError(
            f"{source} has arrays that no plain actor has, such as {foreign[0]}; expected MlpPolicy without a features "
            "extractor or layers of its own."
        )
    std = state.get("log_std")
    defaults = {"activation": "tanh" if stochastic else "relu", "squashed": not stochastic}
    return MlpPolicy(
        weights=tuple(np.ascontiguousarray(state[f"{layer}.weight"].T) for layer in layers),
        biases=tuple(state[f"{layer}.bias"] for layer in layers),
        std=np.exp(std) if std is not None and std.ndim == 1 else None,
        **(defaults | settings),
    )


def _actor_critic_layers(state: Mapping[str, FloatArray]) -> list[str]:
    return [*_numbered(state, "mlp_extractor.policy_net."), "action_net"]


def _actor_layers(state: Mapping[str, FloatArray]) -> list[str]:
    """Of TD3 and DDPG one sequence; of SAC a body and a last layer, which is a sequence where its mean is clipped."""
    body, last = _numbered(state, "actor.latent_pi."), _numbered(state, "actor.mu.")
    return [*body, "actor.mu"] if "actor.mu.weight" in state else [*body, *last]


def _numbered(state: Mapping[str, FloatArray], prefix: str) -> list[str]:
    """``prefix`` 0, 2, 4, ...: linear layers with an activation between them."""
    count = sum(name.startswith(prefix) and name.endswith(".weight") for name in state)
    return [f"{prefix}{2 * index}" for index in range(count)]
