"""The paper's neural transition model for Gridworld: a two-layer perceptron (hidden 32, ReLU) with cross-entropy."""

from __future__ import annotations

from typing import Any

import numpy as np

from bridge_algos.continuous.needs import need
from bridge_algos.mdp import FloatArray, IntArray


def fit_transition_mlp(
    counts: IntArray, rng: np.random.Generator, hidden: int = 32, steps: int = 300, rate: float = 0.01
) -> FloatArray:
    r"""Kernel :math:`\hat P(\cdot|s,a) = softmax(MLP(e_s, e_a))` fitted to transition counts, (S, A, S).

    Trained from scratch with full-batch Adam on the cross-entropy of the observed transitions, as the paper retrains
    its model in every round; the paper states neither steps nor rate. Pairs without data get what the network makes
    of them. Without any data the kernel is uniform.

    Args:
        counts: (S, A, S) transition counts.
        rng: draws the initial weights.

    Raises:
        InputError: when torch is not installed.
    """
    torch = need("torch")
    n_states, n_actions, _ = counts.shape
    if not counts.any():
        return np.full(counts.shape, 1 / n_states)
    pairs = np.indices((n_states, n_actions)).reshape(2, -1)
    inputs = torch.from_numpy(np.concatenate([np.eye(n_states)[pairs[0]], np.eye(n_actions)[pairs[1]]], axis=1))
    targets = torch.from_numpy(counts.reshape(-1, n_states) / counts.sum())

    def layer(fan_in: int, fan_out: int) -> list[Any]:
        bound = fan_in**-0.5
        shapes = ((fan_in, fan_out), (fan_out,))
        return [torch.from_numpy(rng.uniform(-bound, bound, shape)).requires_grad_() for shape in shapes]

    weights = [*layer(n_states + n_actions, hidden), *layer(hidden, n_states)]

    def log_kernel() -> Any:
        features = torch.relu(inputs @ weights[0] + weights[1])
        return torch.log_softmax(features @ weights[2] + weights[3], dim=1)

    optimiser = torch.optim.Adam(weights, lr=rate)
    for _ in range(steps):
        optimiser.zero_grad()
        loss = -(targets * log_kernel()).sum()
        loss.backward()
        optimiser.step()
    with torch.no_grad():
        kernel = log_kernel().exp().numpy().reshape(counts.shape)
    return np.asarray(kernel / kernel.sum(axis=2, keepdims=True))
