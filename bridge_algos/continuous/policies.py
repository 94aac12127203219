"""Small multilayer perceptrons as policies."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bridge_algos.mdp import FloatArray
from bridge_theory.errors import InputError

Policy = Callable[[FloatArray], FloatArray]
"""Any function from (m, d_s) observations to (m, d_a) mean actions, row by row; one with a ``std`` is a Gaussian."""


def _relu(x: FloatArray) -> FloatArray:
    return np.maximum(x, 0.0)


ACTIVATIONS: dict[str, Callable[[FloatArray], FloatArray]] = {"tanh": np.tanh, "relu": _relu}

OPTIONAL = ("std", "observation_mean", "observation_scale", "action_low", "action_high", "squash_clip")
"""The arrays that a policy may have besides its weights and biases."""


@dataclass(frozen=True, eq=False)
class MlpPolicy:
    r"""A Gaussian policy :math:`a \sim N(\mu(s), diag(std^2))` whose mean is a multilayer perceptron.

    Hidden layers have the activation. The last one has none, or the hyperbolic tangent where ``squashed``, which is
    then rescaled from [-1, 1] to the action range where one is given. The input is the observation, normalised where a
    mean and a scale are given: ``clip((o - mean) / scale, -clip, clip)``. Everything is computed in float64 with NumPy.

    Args:
        weights: (fan_in, fan_out) of each layer.
        biases: (fan_out,) of each layer.
        std: (d_a,) standard deviations of the actions, or None for a deterministic policy.
        activation: "tanh" or "relu".
        observation_mean: (d_s,) or None.
        observation_scale: (d_s,) positive, or None.
        observation_clip: bound on the normalised inputs.
        squashed: whether the mean is the hyperbolic tangent of the last layer.
        action_low, action_high: (d_a,) the range that a squashed mean is rescaled to; both None for [-1, 1].
        squash_clip: (d_a,) positive bound on the last layer before it is squashed, or None.

    Raises:
        InputError: shapes that do not fit, an unknown activation, an empty range, values that are not finite, or a
            range or a ``squash_clip`` without ``squashed``.

    >>> policy = MlpPolicy((np.ones((3, 2)), np.ones((2, 1))), (np.zeros(2), np.zeros(1)))
    >>> policy(np.zeros((4, 3))).shape, policy.parameters.shape
    ((4, 1), (11,))
    """

    weights: tuple[FloatArray, ...]
    biases: tuple[FloatArray, ...]
    std: FloatArray | None = None
    activation: str = "tanh"
    observation_mean: FloatArray | None = None
    observation_scale: FloatArray | None = None
    observation_clip: float = np.inf
    squashed: bool = False
    action_low: FloatArray | None = None
    action_high: FloatArray | None = None
    squash_clip: FloatArray | None = None

    def __post_init__(self) -> None:
        if self.activation not in ACTIVATIONS:
            raise InputError(f"the activation is {self.activation!r}, expected one of {', '.join(ACTIVATIONS)}.")
        shapes = [np.shape(weight) for weight in self.weights]
        chained = all(len(shape) == 2 for shape in shapes) and all(
            left[1] == right[0] for left, right in pairwise(shapes)
        )
        if not shapes or not chained or [np.shape(b) for b in self.biases] != [shape[1:] for shape in shapes]:
            raise InputError(
                f"the layers have weights of shapes {shapes} and biases of {[np.shape(b) for b in self.biases]}, "
                "expected (fan_in, fan_out) and (fan_out,), each layer taking what the one before gives."
            )
        inputs, outputs = shapes[0][:1], shapes[-1][1:]
        expected = dict.fromkeys(OPTIONAL, outputs) | {"observation_mean": inputs, "observation_scale": inputs}
        given = {name: value for name in OPTIONAL if (value := getattr(self, name)) is not None}
        for name, value in given.items():
            if np.shape(value) != expected[name]:
                raise InputError(f"{name} has shape {np.shape(value)}, expected {expected[name]}.")
        if not all(np.isfinite(value).all() for value in (*self.weights, *self.biases, *given.values())):
            raise InputError("the policy has parameters that are not finite; it cannot be used.")
        positive = {name: given[name] for name in ("observation_scale", "squash_clip") if name in given}
        for name, value in (positive | {"observation_clip": self.observation_clip}).items():
            if not np.min(value) > 0:
                raise InputError(f"{name} goes down to {np.min(value)}, expected above zero.")
        self._check_squashing(given)

    def _check_squashing(self, given: Mapping[str, FloatArray]) -> None:
        named = [name for name in ("action_low", "action_high", "squash_clip") if name in given]
        if named and not self.squashed:
            raise InputError(f"{named[0]} is given, but only squashed means are rescaled; leave it out.")
        if ("action_low" in given) != ("action_high" in given):
            raise InputError(f"of the action range only {named[0]} is given, expected action_low and action_high.")
        if "action_low" in given and not (given["action_low"] < given["action_high"]).all():
            raise InputError("action_low is not below action_high in each coordinate; expected a range of actions.")

    @property
    def observation_size(self) -> int:
        return int(self.weights[0].shape[0])

    @property
    def action_size(self) -> int:
        return int(self.weights[-1].shape[1])

    def __call__(self, observations: FloatArray) -> FloatArray:
        """Mean actions (m, d_a) of (m, d_s) observations, not clipped to any range."""
        x = self.normalised(observations)
        activation = ACTIVATIONS[self.activation]
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            x = activation(x @ weight + bias)
        x = x @ self.weights[-1] + self.biases[-1]
        return np.asarray(self._squash(x) if self.squashed else x)

    def _squash(self, x: FloatArray) -> FloatArray:
        if self.squash_clip is not None:
            x = np.clip(x, -self.squash_clip, self.squash_clip)
        if self.action_low is None or self.action_high is None:
            return np.tanh(x)
        return self.action_low + 0.5 * (np.tanh(x) + 1.0) * (self.action_high - self.action_low)

    def normalised(self, observations: FloatArray) -> FloatArray:
        """The network's inputs: observations (..., d_s), normalised and clipped."""
        x = observations
        if self.observation_mean is not None:
            x = x - self.observation_mean
        if self.observation_scale is not None:
            x = x / self.observation_scale
        if np.isfinite(self.observation_clip):
            x = np.clip(x, -self.observation_clip, self.observation_clip)
        return x

    @property
    def parameters(self) -> FloatArray:
        """All weights and biases as one vector (P,): first layer's weights, its biases, and so on."""
        layers = zip(self.weights, self.biases, strict=True)
        return np.concatenate([part.ravel() for layer in layers for part in layer], dtype=np.float64)

    def with_parameters(self, parameters: FloatArray) -> MlpPolicy:
        """The policy of the same architecture, normalisation and std with other weights and biases (P,)."""
        size = sum(weight.size + weight.shape[1] for weight in self.weights)
        if np.shape(parameters) != (size,):
            raise InputError(f"the parameters have shape {np.shape(parameters)}, expected ({size},).")
        weights, biases, at = [], [], 0
        for weight in self.weights:
            fan_in, fan_out = weight.shape
            weights.append(parameters[at : at + fan_in * fan_out].reshape(fan_in, fan_out))
            at += fan_in * fan_out
            biases.append(parameters[at : at + fan_out])
            at += fan_out
        return replace(self, weights=tuple(weights), biases=tuple(biases))

    def with_normalisation(self, mean: FloatArray, scale: FloatArray, clip: float) -> MlpPolicy:
        """The policy with other statistics of its observations: ``clip((o - mean) / scale, -clip, clip)``."""
        return replace(self, observation_mean=mean, observation_scale=scale, observation_clip=clip)

    def digest(self) -> str:
        """A hexadecimal name of the content: equal policies have equal ones."""
        content = hashlib.sha256(f"{self.activation} {self.observation_clip} {self.squashed}".encode())
        for array in (*self.weights, *self.biases, self.std, self.observation_mean, self.observation_scale):
            values: NDArray[np.float64] = np.zeros(0) if array is None else np.ascontiguousarray(array, np.float64)
            content.update(f"{values.shape}".encode() + values.tobytes())
        for name in ("action_low", "action_high", "squash_clip"):
            if (array := getattr(self, name)) is not None:  # policies without them keep the digests they always had
                content.update(f"{name} {array.shape}".encode() + np.ascontiguousarray(array, np.float64).tobytes())
        return content.hexdigest()
