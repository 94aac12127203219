r"""Log-loss behavioural cloning of episodes: a Gaussian policy by maximum likelihood.

The policy is :math:`a \sim N(\mu_\theta(s), diag(e^{2 \ell}))` with a multilayer perceptron :math:`\mu_\theta` of two
hidden layers of the same width and free log-deviations :math:`\ell`; the loss is the mean of
:math:`-\log \pi(a_h | s_h)` over all recorded steps (paper, appendix "Continuous implementation"; log-loss BC of Foster
et al. 2024), minimised by Adam over shuffled batches.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from bridge_algos.continuous.episodes import Episodes
from bridge_algos.continuous.needs import need
from bridge_algos.continuous.policies import MlpPolicy
from bridge_algos.mdp import FloatArray
from bridge_theory.errors import InputError

INITIAL_LOG_STD = -2.0
Statistics = tuple[FloatArray, FloatArray]
_CONSTANT = 1e-6
"""A coordinate that deviates less is taken as constant: divided by so little, the next value would be cut."""
CLIP = 10.0
"""Normalised observations are cut at this many standard deviations, as Stable-Baselines3 does."""


@dataclass(frozen=True, eq=False)
class Clone:
    """A cloned policy with its learning curves.

    Args:
        policy: the Gaussian policy.
        likelihood: (epochs,) mean log-likelihood of a recorded action under the policy after each epoch, in nats.
        validation: (epochs,) the same on episodes that were not trained on; nan without such episodes.
    """

    policy: MlpPolicy
    likelihood: FloatArray
    validation: FloatArray


def clone(
    demonstrations: Episodes,
    rng: np.random.Generator,
    *,
    hidden: int,
    validation: Episodes | None = None,
    statistics: Statistics | None = None,
    epochs: int = 100,
    batch: int = 32,
    rate: float = 1e-3,
) -> Clone:
    """Fit a Gaussian policy to demonstrations by log-loss.

    Everything is computed in float64 on one thread, and all randomness (initial weights, order of the steps) is drawn
    from ``rng``, so that the numbers depend on nothing else.

    Args:
        demonstrations: n episodes; steps after an episode's end do not count.
        rng: the source of all randomness; torch's own generators are not touched.
        hidden: width of both hidden layers, which have rectified linear units.
        validation: episodes on which the likelihood is reported; they decide nothing.
        statistics: mean and scale, (d_s,) each, by which the policy standardises its observations; None for none.
        epochs, batch, rate: of Adam.

    Raises:
        InputError: torch is not installed, a size is not positive, or the episodes have other dimensions.
    """
    torch = need("torch")
    for name, size in (("hidden", hidden), ("epochs", epochs), ("batch", batch)):
        if size < 1:
            raise InputError(f"{name} is {size}, expected a whole number of at least 1.")
    states, actions = _steps(demonstrations)
    d_s, d_a = states.shape[1], actions.shape[1]
    held_out = None if validation is None else _steps(validation)
    if held_out is not None and (held_out[0].shape[1], held_out[1].shape[1]) != (d_s, d_a):
        raise InputError(
            f"the validation episodes have {held_out[0].shape[1]}-dimensional observations and "
            f"{held_out[1].shape[1]}-dimensional actions, expected {d_s} and {d_a}, as in the demonstrations."
        )
    mean, scale = statistics or (None, None)
    threads = torch.get_num_threads()
    torch.set_num_threads(1)  # more threads would add in another order, and so change the last digits
    try:
        sizes = (d_s, hidden, hidden, d_a)
        layers = [_layer(torch, rng, *pair) for pair in pairwise(sizes)]
        log_std = torch.full((d_a,), INITIAL_LOG_STD, dtype=torch.float64, requires_grad=True)
        optimiser = torch.optim.Adam([*(part for layer in layers for part in layer), log_std], lr=rate)

        def policy() -> MlpPolicy:
            arrays = [tuple(part.detach().numpy().copy() for part in layer) for layer in layers]
            weights, biases = zip(*arrays, strict=True)
            std = np.exp(log_std.detach().numpy())
            clip = CLIP if statistics else np.inf
            return MlpPolicy(weights, biases, std, "relu", mean, scale, clip)

        inputs = torch.from_numpy(_normalised(states, mean, scale))
        targets = torch.from_numpy(actions)
        likelihood, on_validation = np.empty(epochs), np.full(epochs, np.nan)
        for epoch in range(epochs):
            order = torch.from_numpy(rng.permutation(len(states)))
            for first in range(0, len(states), batch):
                part = order[first : first + batch]
                optimiser.zero_grad()
                loss = -_log_density(torch, layers, log_std, inputs[part], targets[part]).mean()
                loss.backward()
                optimiser.step()
            current = policy()
            likelihood[epoch] = log_likelihood(current, states, actions)
            if held_out is not None:
                on_validation[epoch] = log_likelihood(current, *held_out)
    finally:
        torch.set_num_threads(threads)
    return Clone(current, likelihood, on_validation)


def demonstrated_statistics(demonstrations: Episodes) -> Statistics:
    """Mean and deviation of the demonstrated observations, (d_s,) each; 1 for a coordinate that does not vary."""
    states = _steps(demonstrations)[0]
    deviation = states.std(axis=0)
    return states.mean(axis=0), np.where(deviation > _CONSTANT, deviation, 1.0)


def log_likelihood(policy: MlpPolicy, states: FloatArray, actions: FloatArray) -> float:
    """Mean log-density of actions (m, d_a) at states (m, d_s) under a Gaussian policy, in nats."""
    if policy.std is None:
        raise InputError("the policy has no std, so that its actions have no density; give a Gaussian policy.")
    z = (actions - policy(states)) / policy.std
    return float(-(z**2 / 2 + np.log(policy.std) + np.log(2 * np.pi) / 2).sum(axis=1).mean())


def _normalised(states: FloatArray, mean: FloatArray | None, scale: FloatArray | None) -> FloatArray:
    """What the network of a policy with these statistics sees."""
    if mean is None or scale is None:
        return states
    return np.asarray(np.clip((states - mean) / scale, -CLIP, CLIP))


def _steps(episodes: Episodes) -> tuple[FloatArray, FloatArray]:
    """The states and actions of all steps that took place."""
    taken = episodes.mask
    return episodes.observations[:, :-1][taken], episodes.actions[taken].astype(np.float64)


def _layer(torch: Any, rng: np.random.Generator, fan_in: int, fan_out: int) -> tuple[Any, Any]:
    bound = fan_in**-0.5
    shapes = ((fan_in, fan_out), (fan_out,))
    weight, bias = (torch.from_numpy(rng.uniform(-bound, bound, shape)).requires_grad_() for shape in shapes)
    return weight, bias


def _log_density(torch: Any, layers: list[tuple[Any, Any]], log_std: Any, inputs: Any, targets: Any) -> Any:
    x = inputs
    for weight, bias in layers[:-1]:
        x = torch.relu(torch.addmm(bias, x, weight))
    mean = torch.addmm(layers[-1][1], x, layers[-1][0])
    z = (targets - mean) * torch.exp(-log_std)
    return -(z**2 / 2 + log_std + np.log(2 * np.pi) / 2).sum(dim=1)
