"""Policies made elsewhere: networks of Stable-Baselines3, and torch modules.

Files of torch and Stable-Baselines3 are pickles, which may run any program when they are loaded. Of an SB3 zip only
the weights are read, by ``torch.load(weights_only=True)``, which builds tensors and nothing else, and its settings as
JSON text. Everything else is refused with a word on what to do.
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bridge_algos.continuous.needs import need
from bridge_algos.continuous.policies import MlpPolicy, Policy
from bridge_algos.mdp import FloatArray
from bridge_theory.errors import InputError

_HIDDEN = ("mlp_extractor.policy_net.", "actor.mu.", "actor.latent_pi.")


def policy_from_module(module: Any) -> Policy:
    """A torch module in memory, from (m, d_s) observations to (m, d_a) actions, as a policy; its dtype is kept."""
    torch = need("torch")
    first = next(iter(module.parameters()), None)
    dtype = torch.float64 if first is None else first.dtype

    def act(observations: FloatArray) -> FloatArray:
        with torch.no_grad():
            return np.asarray(module(torch.from_numpy(observations).to(dtype)).cpu().numpy(), dtype=np.float64)

    return act


def policy_from_sb3_zip(path: str | Path) -> MlpPolicy:
    """The actor's network of a PPO, A2C, TD3, DDPG or SAC model that Stable-Baselines3 saved as a zip.

    Only plain networks are read: linear layers with one activation, observations not normalised. SB3 keeps the
    statistics of ``VecNormalize`` in a pickle of its own, which is not read; give them with
    ``dataclasses.replace(policy, observation_mean=..., observation_scale=..., observation_clip=10.0)``.

    Raises:
        InputError: the file is missing, no such zip, or holds another kind of network.
    """
    torch = need("torch")
    try:
        with zipfile.ZipFile(path) as archive:
            weights, settings = archive.read("policy.pth"), json.loads(archive.read("data"))
        state = torch.load(io.BytesIO(weights), map_location="cpu", weights_only=True)
        arrays = {name: value.double().numpy() for name, value in state.items() if hasattr(value, "double")}
    except FileNotFoundError:
        raise InputError(f"{path} does not exist; give the path of a zip that Stable-Baselines3 saved.") from None
    except Exception as error:  # torch and zipfile raise many kinds on damaged files
        reason = str(error).partition("\n")[0]
        raise InputError(f"{path} is not a zip of a Stable-Baselines3 model with plain weights ({reason}).") from None
    return policy_from_sb3_state(arrays, _activation(settings, str(path)), str(path))


def policy_from_sb3_state(state: Mapping[str, FloatArray], activation: str | None, source: str) -> MlpPolicy:
    """The actor in a state dictionary of an SB3 policy.

    Args:
        state: arrays by name, such as "actor.mu.0.weight" of shape (fan_out, fan_in).
        activation: of the hidden layers; None for the algorithm's default.
        source: names the model in messages.

    Raises:
        InputError: no known actor is in it.
    """
    hidden = next((prefix for prefix in _HIDDEN if f"{prefix}0.weight" in state), None)
    if hidden is None:
        raise InputError(f"{source} holds no actor of linear layers (PPO, A2C, TD3, DDPG or SAC with MlpPolicy).")
    numbers = sorted(int(name[len(hidden) : -len(".weight")]) for name in state if _is_weight(name, hidden))
    layers = [f"{hidden}{number}" for number in numbers]
    stochastic = hidden.startswith("mlp_extractor")
    if not hidden.startswith("actor.mu."):
        layers.append("action_net" if stochastic else "actor.mu")
    missing = [name for layer in layers for name in (f"{layer}.weight", f"{layer}.bias") if name not in state]
    if missing:
        raise InputError(f"{source} lacks {', '.join(missing)}; expected linear layers with biases.")
    return MlpPolicy(
        weights=tuple(np.ascontiguousarray(state[f"{layer}.weight"].T) for layer in layers),
        biases=tuple(state[f"{layer}.bias"] for layer in layers),
        std=np.exp(state["log_std"]) if stochastic and "log_std" in state and state["log_std"].ndim == 1 else None,
        activation=activation or ("tanh" if stochastic else "relu"),
        squashed=not stochastic,
    )


def _is_weight(name: str, prefix: str) -> bool:
    return name.startswith(prefix) and name.endswith(".weight") and name[len(prefix) : -len(".weight")].isdigit()


def _activation(settings: Mapping[str, Any], source: str) -> str | None:
    """The activation that SB3's settings name in plain text, or None where they name none."""
    options = settings.get("policy_kwargs") if isinstance(settings, Mapping) else None
    named = str(options.get("activation_fn", "")) if isinstance(options, Mapping) else ""
    if not named:
        return None
    for word, activation in (("Tanh", "tanh"), ("ReLU", "relu")):
        if f".{word}'" in named:
            return activation
    raise InputError(f"{source} uses the activation {named}, expected Tanh or ReLU.")
