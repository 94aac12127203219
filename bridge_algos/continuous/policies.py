"""Small multilayer perceptrons as policies."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
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


@dataclass(frozen=True, eq=False)
class MlpPolicy:
    r"""A Gaussian policy :math:`a \sim N(\mu(s), diag(std^2))` whose mean is a multilayer perceptron.

    Hidden layers have the activation, the last one none, or the hyperbolic tangent where ``squashed``. The input is
    the observation, normalised where a mean and a scale are given: ``clip((o - mean) / scale, -clip, clip)``.
    Everything is computed in float64 with NumPy.

    Args:
        weights: (fan_in, fan_out) of each layer.
        biases: (fan_out,) of each layer.
        std: (d_a,) standard deviations of the actions, or None for a deterministic policy.
        activation: "tanh" or "relu".
        observation_mean: (d_s,) or None.
        observation_scale: (d_s,) positive, or None.
        observation_clip: bound on the normalised inputs.
        squashed: whether the mean is the hyperbolic tangent of the last layer.

    Raises:
        InputError: shapes that do not fit, an unknown activation, or values that are not finite.

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
        expected = {"std": shapes[-1][1:], "observation_mean": shapes[0][:1], "observation_scale": shapes[0][:1]}
        for name, shape in expected.items():
            value = getattr(self, name)
            if value is not None and np.shape(value) != shape:
                raise InputError(f"{name} has shape {np.shape(value)}, expected {shape}.")
        extra = [value for value in map(self.__dict__.get, expected) if value is not None]
        if not all(np.isfinite(value).all() for value in (*self.weights, *self.biases, *extra)):
            raise InputError("the policy has parameters that are not finite; it cannot be used.")
        if self.observation_scale is not None and np.min(self.observation_scale) <= 0:
            raise InputError(f"observation_scale goes down to {np.min(self.observation_scale)}, expected above zero.")

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
        return np.asarray(np.tanh(x) if self.squashed else x)

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

    def digest(self) -> str:
        """A hexadecimal name of the content: equal policies have equal ones."""
        content = hashlib.sha256(f"{self.activation} {self.observation_clip} {self.squashed}".encode())
        for array in (*self.weights, *self.biases, self.std, self.observation_mean, self.observation_scale):
            values: NDArray[np.float64] = np.zeros(0) if array is None else np.ascontiguousarray(array, np.float64)
            content.update(f"{values.shape}".encode() + values.tobytes())
        return content.hexdigest()
