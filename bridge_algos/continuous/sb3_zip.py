"""Experts from zips of Stable-Baselines3: used with every setting that decides an action, or refused.

The zip and the statistics of ``VecNormalize`` hold pickles, which may run any program when they are loaded; none is.
Of the zip only the weights are read, by ``torch.load(weights_only=True)``, which builds tensors and nothing else, and
the settings, as JSON text. The statistics come from a file of plain arrays beside it, ``NAME-statistics.npz`` for
``NAME.zip``, which these lines write where ``VecNormalize`` is at hand::

    venv = VecNormalize.load("vecnormalize.pkl", DummyVecEnv([make_env]))  # a pickle: only your own
    np.savez("NAME-statistics.npz", mean=venv.obs_rms.mean, var=venv.obs_rms.var,
             epsilon=venv.epsilon, clip_obs=venv.clip_obs)

and ``np.savez("NAME-statistics.npz", normalised=False)`` says that the observations were not normalised.
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bridge_algos.continuous.environments import Environment
from bridge_algos.continuous.needs import need
from bridge_algos.continuous.policies import MlpPolicy
from bridge_algos.continuous.sb3_network import policy_from_sb3_state
from bridge_algos.continuous.sb3_settings import Settings, settings_of
from bridge_algos.mdp import FloatArray
from bridge_algos.npz import read_arrays
from bridge_theory.errors import InputError

_STATISTICS = ("mean", "var", "epsilon", "clip_obs")


def policy_from_sb3_zip(path: str | Path, environment: Environment) -> MlpPolicy:
    """The policy that a PPO, A2C, TD3, DDPG or SAC model with ``MlpPolicy`` predicts with; see this module.

    Args:
        path: a zip that ``model.save`` wrote; statistics of observations lie beside it.
        environment: whose observations and action range must be those that the model was trained with.

    Raises:
        InputError: the file is missing, no such zip, holds another kind of policy or a setting that is not known here,
            was trained with another range of actions, or needs statistics that are missing.
    """
    weights, texts = _members(Path(path))
    settings = settings_of(texts, str(path), environment)
    policy = policy_from_sb3_state(weights, str(path), **_fields(settings, environment))
    return _normalised(policy, Path(path), settings)


def statistics_path(path: Path) -> Path:
    """Where the statistics of a zip's observations lie.

    >>> statistics_path(Path("experts/best.zip")).name
    'best-statistics.npz'
    """
    return path.with_name(f"{path.stem}-statistics.npz")


def _members(path: Path) -> tuple[dict[str, FloatArray], Any]:
    """The arrays of the weights, and the settings' text as JSON."""
    torch = need("torch")
    try:
        with zipfile.ZipFile(path) as archive:
            content, texts = archive.read("policy.pth"), json.loads(archive.read("data"))
    except FileNotFoundError:
        raise InputError(f"{path} does not exist; give the path of a zip that Stable-Baselines3 saved.") from None
    except Exception:  # damaged files make zipfile and json raise many kinds
        raise InputError(
            f"{path} is no readable zip of Stable-Baselines3, expected the members 'policy.pth' and 'data'; save the "
            "model again."
        ) from None
    try:
        state = torch.load(io.BytesIO(content), map_location="cpu", weights_only=True)
        return {name: value.double().numpy() for name, value in state.items()}, texts
    except Exception:  # whatever torch advises here is not repeated: it may be to load the file unsafely
        raise InputError(
            f"the weights in {path} are no plain tensors: they are damaged, or loading them would run a program, which "
            "was not done; expected a model that Stable-Baselines3 saved."
        ) from None


def _fields(settings: Settings, environment: Environment) -> dict[str, Any]:
    """The fields of a policy that the settings decide, and the weights do not show."""
    fields: dict[str, Any] = {"activation": settings.activation, "squashed": settings.squashed}
    if settings.squashed:
        if not ((environment.low == -1).all() and (environment.high == 1).all()):
            fields["action_low"] = environment.low.astype(np.float64)
            fields["action_high"] = environment.high.astype(np.float64)
        if settings.squash_clip is not None:
            fields["squash_clip"] = np.full(environment.action_size, settings.squash_clip)
    return fields


def _normalised(policy: MlpPolicy, path: Path, settings: Settings) -> MlpPolicy:
    """The policy with the normalisation of its observations."""
    beside = statistics_path(path)
    if not beside.exists():
        if settings.normalisation == "none":
            return policy
        known = "was trained with" if settings.normalisation == "used" else "does not tell whether it was trained with"
        raise InputError(
            f"{path} {known} VecNormalize, and the file {beside} is missing; write it by np.savez({str(beside)!r}, "
            "mean=venv.obs_rms.mean, var=venv.obs_rms.var, epsilon=venv.epsilon, clip_obs=venv.clip_obs), or, where "
            f"observations were not normalised, np.savez({str(beside)!r}, normalised=False)."
        )
    arrays = read_arrays(beside, ())
    if set(arrays) == {"normalised"} and arrays["normalised"].shape == () and not arrays["normalised"]:
        return policy
    if set(arrays) != set(_STATISTICS):
        raise InputError(
            f"{beside} holds the arrays {', '.join(sorted(arrays)) or 'none'}, expected {', '.join(_STATISTICS)}, or "
            "normalised=False alone."
        )
    return _with_statistics(policy, arrays, beside)


def _with_statistics(policy: MlpPolicy, arrays: Mapping[str, Any], beside: Path) -> MlpPolicy:
    shapes = {"mean": (policy.observation_size,), "var": (policy.observation_size,), "epsilon": (), "clip_obs": ()}
    for name, shape in shapes.items():
        if arrays[name].shape != shape or arrays[name].dtype.kind not in "iuf":
            raise InputError(
                f"{name} in {beside} has shape {arrays[name].shape} of {arrays[name].dtype}, expected real numbers of "
                f"shape {shape}."
            )
    if np.isnan(arrays["clip_obs"]) or not (arrays["var"] + arrays["epsilon"] > 0).all() or not arrays["clip_obs"] > 0:
        raise InputError(f"{beside} must have var + epsilon and clip_obs above zero; save the statistics again.")
    return policy.with_normalisation(
        mean=arrays["mean"].astype(np.float64),
        scale=np.sqrt(arrays["var"].astype(np.float64) + float(arrays["epsilon"])),
        clip=float(arrays["clip_obs"]),
    )
