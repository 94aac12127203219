"""The settings of a Stable-Baselines3 model, read as text: each is understood, harmless, or a reason to refuse.

SB3 writes a model's attributes as JSON. What JSON cannot hold is a pickle in base64, which is never loaded, beside the
texts of its entries: of ``policy_kwargs``, of the spaces, and of the policy's class, whose module it names.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from bridge_algos.continuous.environments import Environment
from bridge_algos.mdp import FloatArray
from bridge_theory.errors import InputError

_MODULES = {
    "stable_baselines3.common.policies": "gaussian",  # PPO and A2C
    "stable_baselines3.sac.policies": "sac",
    "stable_baselines3.td3.policies": "td3",  # and DDPG
}
_ACTIVATIONS = {f"<class 'torch.nn.modules.activation.{name}'>": name.lower() for name in ("Tanh", "ReLU")}
_BOXES = ("<class 'gymnasium.spaces.box.Box'>", "<class 'gym.spaces.box.Box'>")
_FLATTEN = "<class 'stable_baselines3.common.torch_layers.FlattenExtractor'>"
_HARMLESS = (
    *("net_arch", "n_critics", "ortho_init", "optimizer_class", "optimizer_kwargs"),  # the weights say what they made
    *("use_sde", "log_std_init", "full_std", "use_expln"),  # of the spread, which mean actions do not have
    *("normalize_images", "share_features_extractor"),  # of images, and of an extractor, which are refused
)
"""Entries of ``policy_kwargs`` that leave the mean action of the given weights as it is."""

_UNDERSTOOD: dict[str, tuple[Callable[[Any], bool], str]] = {
    "activation_fn": (lambda value: str(value) in _ACTIVATIONS, "torch's Tanh or ReLU"),
    "squash_output": (lambda value: isinstance(value, bool), "true or false"),
    "clip_mean": (lambda value: isinstance(value, int | float), "a number"),
    "features_extractor_class": (lambda value: value == _FLATTEN, "FlattenExtractor"),
    "features_extractor_kwargs": (lambda value: not value, "none"),
}
"""Entries that decide something, or are accepted with one value only."""


@dataclass(frozen=True)
class Settings:
    """What the settings decide about actions.

    Args:
        activation: of the hidden layers.
        squashed: whether the mean is a hyperbolic tangent, rescaled to the action range.
        squash_clip: bound on the mean before that, or None.
        normalisation: whether ``VecNormalize`` was used in training: "none", "used" or "unknown".
    """

    activation: str
    squashed: bool
    squash_clip: float | None
    normalisation: Literal["none", "used", "unknown"]


def settings_of(texts: Any, source: str, environment: Environment) -> Settings:
    """The settings in the JSON of a zip's ``data``.

    Raises:
        InputError: a setting is missing or not known here, or is of another environment.
    """
    if not isinstance(texts, Mapping):
        raise InputError(f"the settings in {source} are no JSON object; save the model again.")
    module = str(_entry(texts, "policy_class", "__module__"))
    if module not in _MODULES:
        raise InputError(
            f"the policy in {source} is a class of the module {module!r}, expected MlpPolicy of PPO, A2C, "
            "TD3, DDPG or SAC of Stable-Baselines3."
        )
    _check_spaces(texts, source, environment)
    kind = _MODULES[module]
    options = _options(texts, source)
    squashed = kind != "gaussian" or options.get("squash_output", False)
    clips = kind == "sac" and bool(texts.get("use_sde", options.get("use_sde", False)))
    default = "tanh" if kind == "gaussian" else "relu"
    clip = options.get("clip_mean", 2.0) if clips else 0.0
    return Settings(
        activation=_ACTIVATIONS[options["activation_fn"]] if "activation_fn" in options else default,
        squashed=squashed,
        squash_clip=clip if clip > 0 else None,
        normalisation=_normalisation(texts, kind),
    )


def _options(texts: Mapping[str, Any], source: str) -> dict[str, Any]:
    """``policy_kwargs``, after making sure that each entry is understood or harmless."""
    given = texts.get("policy_kwargs")
    if not isinstance(given, Mapping):
        raise InputError(f"the settings in {source} have no policy_kwargs; save the model again.")
    options = {name: value for name, value in given.items() if name not in (":type:", ":serialized:")}
    for name, value in options.items():
        if name in _HARMLESS:
            continue
        if name not in _UNDERSTOOD:
            raise InputError(f"{source} has the policy setting {name!r}, which is not known here; it cannot be used.")
        fits, expected = _UNDERSTOOD[name]
        if not fits(value):
            raise InputError(f"{source} has the policy setting {name}={value}, expected {expected}.")
    return options


def _normalisation(texts: Mapping[str, Any], kind: str) -> Literal["none", "used", "unknown"]:
    """SB3 keeps the unnormalised observations of a model in ``VecNormalize``; off-policy ones have them always."""
    if "_last_original_obs" not in texts:
        return "unknown"
    if texts["_last_original_obs"] is None:
        return "none"
    return "used" if kind == "gaussian" else "unknown"


def _check_spaces(texts: Mapping[str, Any], source: str, environment: Environment) -> None:
    sizes = {"observation": environment.observation_size, "action": environment.action_size}
    for name, size in sizes.items():
        kind, shape = (_entry(texts, f"{name}_space", key) for key in (":type:", "_shape"))
        if kind not in _BOXES or not isinstance(shape, list) or len(shape) != 1:
            raise InputError(
                f"{source} has {name}s of another kind ({kind}, shape {shape}), expected a Box of one dimension."
            )
        if shape != [size]:
            raise InputError(
                f"the model in {source} has {shape[0]}-dimensional {name}s, expected {size}, as {environment.name} has."
            )
    low, high = (_numbers(_entry(texts, "action_space", key)) for key in ("low", "high"))
    if low is None or high is None:
        raise InputError(f"{source} does not tell the range of actions it was trained with; save the model again.")
    fits = all(
        len(theirs) == len(ours) and np.allclose(theirs, ours, rtol=1e-6, atol=1e-7)
        for theirs, ours in ((low, environment.low), (high, environment.high))
    )
    if not fits:
        raise InputError(
            f"{source} was trained with actions from {low.min():g} to {high.max():g}, expected the range of "
            f"{environment.name}, {environment.low.min():g} to {environment.high.max():g}."
        )


def _numbers(text: Any) -> FloatArray | None:
    """The numbers of a NumPy array's text, ``"[-1. -1.]"``; None where it is another text, or abbreviated."""
    try:
        return np.array([float(part) for part in str(text).strip("[]").split()] or None, dtype=np.float64)
    except (TypeError, ValueError):
        return None


def _entry(texts: Mapping[str, Any], name: str, key: str) -> Any:
    part = texts.get(name)
    return part.get(key) if isinstance(part, Mapping) else None
