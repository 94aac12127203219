r"""Proximal policy optimisation on batched rollouts: minutes where one environment at a time takes hours.

Each iteration rolls out whole episodes of the current Gaussian policy, estimates advantages (GAE), and takes
minibatch steps on the clipped surrogate (Schulman et al., 2017). As the environment receives clipped actions,
:math:`a = clip(\mu(s) + \sigma \xi)`, the likelihood is that of the clipped action, with point masses at the ends of
the range (Fujita and Maeda, 2018). Observations are normalised with running moments, which become part of the policy,
and rewards are divided by the running deviation of the discounted return.

An iteration's random numbers depend on the seed and its index only, and all learned state is a few arrays: a killed
training resumes from its last checkpoint and ends with the same policy.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from bridge_algos.continuous.environments import Environment, draw_starts
from bridge_algos.continuous.episodes import Episodes
from bridge_algos.continuous.moments import Moments
from bridge_algos.continuous.needs import need
from bridge_algos.continuous.policies import MlpPolicy
from bridge_algos.continuous.rollouts import rollout
from bridge_algos.files import atomic_write
from bridge_algos.mdp import FloatArray
from bridge_algos.npz import read_arrays
from bridge_theory.errors import InputError

_CLIP_OBSERVATIONS = 10.0
_LEAST_SCALE = 0.01
_CHECKPOINT_EVERY = 10


@dataclass(frozen=True)
class PpoSettings:
    """What determines a training, beside its environment and seed.

    Args:
        horizon: steps of an episode; values beyond it are bootstrapped.
        episodes: episodes an iteration.
        iterations: number of iterations; the learning rate falls linearly to zero over them.
        hidden: neurons of each of the two hidden layers (tanh) of the policy and of the value function.
        discount: gamma.
        trace: lambda of the generalised advantage estimate.
        clip: of the likelihood ratio.
        epochs: passes over an iteration's data.
        minibatch: steps a gradient step.
        rate: first learning rate of Adam.
        initial_std: of the actions.
    """

    horizon: int
    episodes: int
    iterations: int
    hidden: int = 64
    discount: float = 0.99
    trace: float = 0.95
    clip: float = 0.2
    epochs: int = 10
    minibatch: int = 800
    rate: float = 1e-3
    initial_std: float = 0.5


PRESETS = {
    "reacher": PpoSettings(horizon=50, episodes=128, iterations=300),
    "ant": PpoSettings(horizon=100, episodes=80, iterations=400),
}


@dataclass
class _Learner:
    """All that changes in training: a parameter vector (policy, log std, value) with Adam's moments, and scales."""

    parameters: FloatArray
    first: FloatArray
    second: FloatArray
    steps: int
    observations: Moments
    returns: Moments


def train(
    environment: Environment,
    settings: PpoSettings,
    seed: int,
    checkpoint: Path,
    threads: int | None = None,
) -> MlpPolicy:
    """Train a policy, from the checkpoint where there is one of the same environment, settings and seed.

    Args:
        environment: whose reward is maximised.
        settings: see :class:`PpoSettings`.
        seed: determines every random number.
        checkpoint: an ``.npz`` file, written every few iterations.
        threads: of the rollouts; does not change the policy.

    Raises:
        InputError: torch is not installed, or the checkpoint is of another training.
    """
    from tqdm import tqdm

    torch = need("torch")
    identity = json.dumps({"environment": environment.gymnasium_id, "seed": seed, **asdict(settings)})
    learner, done = _restored(checkpoint, identity) or (_fresh(environment, settings, seed), 0)
    threads_before = torch.get_num_threads()
    torch.set_num_threads(1)  # these networks are too small for more, which might change the last bits
    try:
        with threadpool_limits(1), tqdm(total=settings.iterations, initial=done, unit="iteration") as bar:
            for iteration in range(done, settings.iterations):
                score = _iterate(torch, environment, settings, learner, seed, iteration, threads)
                bar.set_postfix_str(f"return {score:.2f}")
                bar.update()
                if (iteration + 1) % _CHECKPOINT_EVERY == 0 or iteration + 1 == settings.iterations:
                    _keep(checkpoint, identity, learner, iteration + 1)
    finally:
        torch.set_num_threads(threads_before)
    return _policy(environment, settings, learner)


def _iterate(
    torch: Any,
    environment: Environment,
    settings: PpoSettings,
    learner: _Learner,
    seed: int,
    iteration: int,
    threads: int | None,
) -> float:
    """One iteration; returns the mean return of its episodes."""
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(1, iteration)))
    policy = _policy(environment, settings, learner)
    starts = draw_starts(environment, settings.episodes, rng)
    episodes = rollout(environment, policy, starts, horizon=settings.horizon, rng=rng, threads=threads)
    inputs = _normalised(policy, episodes.observations)
    learner.returns.add(_discounted(episodes, settings.discount)[episodes.mask][:, None])
    with torch.no_grad():
        networks = _Networks(torch, environment, settings, torch.from_numpy(learner.parameters).float())
        values = networks.value(torch.from_numpy(inputs).float()).numpy().astype(np.float64)
    scaled = episodes.rewards / np.sqrt(learner.returns.variance[0] + 1e-8)
    advantages = _advantages(episodes, scaled, values, settings)
    mask = episodes.mask
    batch = (inputs[:, :-1][mask], episodes.actions[mask], advantages[mask], (advantages + values[:, :-1])[mask])
    remaining = 1 - iteration / settings.iterations
    _improve(torch, environment, settings, learner, batch, settings.rate * remaining, rng)
    learner.observations.add(episodes.states[mask])
    return float(episodes.returns.mean())


def _improve(
    torch: Any,
    environment: Environment,
    settings: PpoSettings,
    learner: _Learner,
    batch: tuple[Any, ...],
    rate: float,
    rng: np.random.Generator,
) -> None:
    """Minibatch steps of Adam on the clipped surrogate and the value error."""
    inputs, actions, advantages, targets = (torch.from_numpy(np.ascontiguousarray(part)).float() for part in batch)
    vector = torch.from_numpy(learner.parameters).float().requires_grad_()
    with torch.no_grad():
        before = _Networks(torch, environment, settings, vector).log_likelihood(inputs, actions)
    for _ in range(settings.epochs):
        order = rng.permutation(len(inputs))
        for part in np.array_split(order, max(1, len(order) // settings.minibatch)):
            chosen = torch.from_numpy(part)
            networks = _Networks(torch, environment, settings, vector)
            ratio = (networks.log_likelihood(inputs[chosen], actions[chosen]) - before[chosen]).exp()
            gain = advantages[chosen]
            gain = (gain - gain.mean()) / (gain.std() + 1e-8)
            limited = ratio.clamp(1 - settings.clip, 1 + settings.clip)
            surrogate = torch.minimum(ratio * gain, limited * gain).mean()
            error = (networks.value(inputs[chosen]) - targets[chosen]).square().mean()
            (gradient,) = torch.autograd.grad(0.5 * error - surrogate, vector)
            _adam_step(torch, learner, vector, gradient.double().numpy(), rate)


def _adam_step(torch: Any, learner: _Learner, vector: Any, gradient: FloatArray, rate: float) -> None:
    gradient = gradient * min(1.0, 0.5 / (float(np.linalg.norm(gradient)) + 1e-12))
    learner.steps += 1
    learner.first += 0.1 * (gradient - learner.first)
    learner.second += 0.001 * (gradient**2 - learner.second)
    first = learner.first / (1 - 0.9**learner.steps)
    second = learner.second / (1 - 0.999**learner.steps)
    learner.parameters -= rate * first / (np.sqrt(second) + 1e-8)
    with torch.no_grad():
        vector.copy_(torch.from_numpy(learner.parameters))


class _Networks:
    """Policy and value function as functions of one parameter vector, which torch differentiates."""

    def __init__(self, torch: Any, environment: Environment, settings: PpoSettings, vector: Any) -> None:
        self._torch = torch
        self._low, self._high = torch.from_numpy(environment.low), torch.from_numpy(environment.high)
        shapes = _shapes(environment, settings)
        parts = torch.split(vector, [int(np.prod(shape)) for shape in shapes])
        tensors = [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]
        self._policy, self._log_std, self._value = tensors[:6], tensors[6], tensors[7:]

    def _mlp(self, layers: list[Any], inputs: Any) -> Any:
        hidden = self._torch.tanh(inputs @ layers[0] + layers[1])
        hidden = self._torch.tanh(hidden @ layers[2] + layers[3])
        return hidden @ layers[4] + layers[5]

    def value(self, inputs: Any) -> Any:
        return self._mlp(self._value, inputs)[..., 0]

    def log_likelihood(self, inputs: Any, actions: Any) -> Any:
        """Of clipped actions, a constant aside: densities inside the range, point masses at its ends."""
        mean, std = self._mlp(self._policy, inputs), self._log_std.exp()
        inside = -0.5 * ((actions - mean) / std).square() - self._log_std
        below = self._torch.special.log_ndtr((self._low - mean) / std)
        above = self._torch.special.log_ndtr((mean - self._high) / std)
        ends = self._torch.where(actions <= self._low, below, above)
        inner = (actions > self._low) & (actions < self._high)
        return self._torch.where(inner, inside, ends).sum(dim=-1)


def _shapes(environment: Environment, settings: PpoSettings) -> list[tuple[int, ...]]:
    d_s, d_a, hidden = environment.observation_size, environment.action_size, settings.hidden
    body = [(d_s, hidden), (hidden,), (hidden, hidden), (hidden,)]
    return [*body, (hidden, d_a), (d_a,), (d_a,), *body, (hidden, 1), (1,)]


def _fresh(environment: Environment, settings: PpoSettings, seed: int) -> _Learner:
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(0,)))
    parts = []
    for index, shape in enumerate(_shapes(environment, settings)):
        if len(shape) == 2:
            gain = {4: 0.01, 11: 1.0}.get(index, np.sqrt(2))  # nearly zero actions at first
            q, r = np.linalg.qr(rng.standard_normal((max(shape), min(shape))))
            q = q * np.sign(np.diag(r))
            parts.append(gain * (q if shape[0] >= shape[1] else q.T))
        else:
            parts.append(np.full(shape, np.log(settings.initial_std) if index == 6 else 0.0))
    vector = np.concatenate([part.ravel() for part in parts])
    zeros = np.zeros_like(vector)
    return _Learner(vector, zeros, zeros.copy(), 0, Moments.none(environment.observation_size), Moments.none(1))


def _policy(environment: Environment, settings: PpoSettings, learner: _Learner) -> MlpPolicy:
    shapes = _shapes(environment, settings)
    cuts = np.cumsum([int(np.prod(shape)) for shape in shapes])[:6]
    parts = [part.reshape(shape) for part, shape in zip(np.split(learner.parameters, cuts), shapes[:6], strict=False)]
    log_std = learner.parameters[cuts[-1] : cuts[-1] + environment.action_size]
    moments = learner.observations
    known = moments.count > 0
    return MlpPolicy(
        weights=tuple(part.copy() for part in parts[0:6:2]),
        biases=tuple(part.copy() for part in parts[1:6:2]),
        std=np.exp(log_std),
        observation_mean=moments.mean.copy() if known else None,
        observation_scale=np.maximum(np.sqrt(moments.variance), _LEAST_SCALE) if known else None,
        observation_clip=_CLIP_OBSERVATIONS,
    )


def _normalised(policy: MlpPolicy, observations: FloatArray) -> FloatArray:
    if policy.observation_mean is None or policy.observation_scale is None:
        return np.clip(observations, -policy.observation_clip, policy.observation_clip)
    scaled = (observations - policy.observation_mean) / policy.observation_scale
    return np.clip(scaled, -policy.observation_clip, policy.observation_clip)


def _discounted(episodes: Episodes, discount: float) -> FloatArray:
    """(n, H): discounted sums of the rewards up to each step, whose deviation scales the rewards."""
    sums = np.zeros_like(episodes.rewards)
    running = np.zeros(len(episodes))
    for h in range(episodes.horizon):
        running = sums[:, h] = discount * running + episodes.rewards[:, h]
    return sums


def _advantages(episodes: Episodes, rewards: FloatArray, values: FloatArray, settings: PpoSettings) -> FloatArray:
    """Generalised advantage estimates (n, H); a cut episode goes on with its value, a terminated one with nothing."""
    n, steps = rewards.shape
    advantages = np.zeros((n, steps))
    carried = np.zeros(n)
    for h in reversed(range(steps)):
        last, running = episodes.lengths == h + 1, episodes.lengths > h
        following = np.where(last & episodes.terminated, 0.0, values[:, h + 1])
        surprise = rewards[:, h] + settings.discount * following - values[:, h]
        carried = np.where(running, surprise + settings.discount * settings.trace * np.where(last, 0.0, carried), 0.0)
        advantages[:, h] = carried
    return advantages


def _keep(checkpoint: Path, identity: str, learner: _Learner, done: int) -> None:
    arrays: dict[str, Any] = {"identity": np.array(identity), "done": np.array(done)}
    for field in fields(_Learner):
        value = getattr(learner, field.name)
        if isinstance(value, Moments):
            arrays |= {f"{field.name}.{part.name}": np.asarray(getattr(value, part.name)) for part in fields(Moments)}
        else:
            arrays[field.name] = np.asarray(value)
    with atomic_write(checkpoint) as handle:
        np.savez(handle, **arrays)


def _restored(checkpoint: Path, identity: str) -> tuple[_Learner, int] | None:
    if not checkpoint.exists():
        return None
    arrays = read_arrays(checkpoint, ("identity", "done", "parameters", "first", "second", "steps"))
    if str(arrays["identity"]) != identity:
        raise InputError(f"{checkpoint} is of another training ({arrays['identity']}); move it away to start anew.")
    observations, returns = (
        Moments(float(arrays[f"{name}.count"]), arrays[f"{name}.mean"], arrays[f"{name}.squares"])
        for name in ("observations", "returns")
    )
    first, second = arrays["first"], arrays["second"]
    learner = _Learner(arrays["parameters"], first, second, int(arrays["steps"]), observations, returns)
    return learner, int(arrays["done"])
