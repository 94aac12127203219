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
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from bridge_algos.continuous.environments import Environment, draw_starts
from bridge_algos.continuous.episodes import Episodes
from bridge_algos.continuous.moments import Moments
from bridge_algos.continuous.policies import MlpPolicy
from bridge_algos.continuous.ppo_gradient import Batch, Networks
from bridge_algos.continuous.ppo_learner import Learner, load_checkpoint, save_checkpoint
from bridge_algos.continuous.rollouts import rollout
from bridge_algos.mdp import FloatArray

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
    "ant": PpoSettings(horizon=100, episodes=80, iterations=1000, discount=0.97),
}


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
        InputError: MuJoCo is not installed, or the checkpoint is of another training.
    """
    from tqdm import tqdm

    identity = json.dumps({"environment": environment.gymnasium_id, "seed": seed, **asdict(settings)})
    learner, done = load_checkpoint(checkpoint, identity) or (_fresh(environment, settings, seed), 0)
    # More BLAS threads do not help networks this small, and might change the last bits.
    with threadpool_limits(1), tqdm(total=settings.iterations, initial=done, unit="iteration") as bar:
        for iteration in range(done, settings.iterations):
            score = _iterate(environment, settings, learner, seed, iteration, threads)
            bar.set_postfix_str(f"return {score:.2f}")
            bar.update()
            if (iteration + 1) % _CHECKPOINT_EVERY == 0 or iteration + 1 == settings.iterations:
                save_checkpoint(checkpoint, identity, learner, iteration + 1)
    return _policy(environment, settings, learner)


def _iterate(
    environment: Environment,
    settings: PpoSettings,
    learner: Learner,
    seed: int,
    iteration: int,
    threads: int | None,
) -> float:
    """One iteration; returns the mean return of its episodes."""
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(1, iteration)))
    networks, policy = _networks(environment, settings), _policy(environment, settings, learner)
    starts = draw_starts(environment, settings.episodes, rng)
    episodes = rollout(environment, policy, starts, horizon=settings.horizon, rng=rng, threads=threads)
    inputs = policy.normalised(episodes.observations)
    mask = episodes.mask
    learner.returns.add(_discounted(episodes, settings.discount)[mask][:, None])
    rewards = episodes.rewards / np.sqrt(learner.returns.variance[0] + 1e-8)
    values = networks.values(learner.parameters, inputs)
    advantages = _advantages(episodes, rewards, values, settings)
    seen, actions = inputs[:, :-1][mask], episodes.actions[mask].astype(np.float64)
    batch = Batch(
        inputs=seen,
        actions=actions,
        before=networks.log_likelihoods(learner.parameters, seen, actions),
        advantages=advantages[mask],
        targets=(advantages + values[:, :-1])[mask],
    )
    _improve(networks, settings, learner, batch, settings.rate * (1 - iteration / settings.iterations), rng)
    learner.observations.add(episodes.states[mask])
    return float(episodes.returns.mean())


def _improve(
    networks: Networks,
    settings: PpoSettings,
    learner: Learner,
    batch: Batch,
    rate: float,
    rng: np.random.Generator,
) -> None:
    """Minibatch steps of Adam on the clipped surrogate and the value error; gradients in single precision."""
    size, data = len(batch.inputs), batch.single()
    for _ in range(settings.epochs):
        for rows in np.array_split(rng.permutation(size), max(1, size // settings.minibatch)):
            gradient = networks.gradient(learner.parameters.astype(np.float32), data.part(rows), settings.clip)
            gradient *= min(1.0, 0.5 / (float(np.linalg.norm(gradient)) + 1e-12))
            learner.steps += 1
            learner.first += 0.1 * (gradient - learner.first)
            learner.second += 0.001 * (gradient * gradient - learner.second)
            deviation = np.sqrt(learner.second * (1 / (1 - 0.999**learner.steps)))
            learner.parameters -= learner.first * (rate / (1 - 0.9**learner.steps)) / (deviation + 1e-8)


def _networks(environment: Environment, settings: PpoSettings) -> Networks:
    return Networks(
        environment.observation_size,
        environment.action_size,
        settings.hidden,
        environment.low,
        environment.high,
    )


def _fresh(environment: Environment, settings: PpoSettings, seed: int) -> Learner:
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(0,)))
    parts = []
    for index, shape in enumerate(_networks(environment, settings).shapes):
        if len(shape) == 2:
            gain = {4: 0.01, 11: 1.0}.get(index, np.sqrt(2))  # nearly zero actions at first
            q, r = np.linalg.qr(rng.standard_normal((max(shape), min(shape))))
            q = q * np.sign(np.diag(r))
            parts.append(gain * (q if shape[0] >= shape[1] else q.T))
        else:
            parts.append(np.full(shape, np.log(settings.initial_std) if index == 6 else 0.0))
    vector = np.concatenate([part.ravel() for part in parts])
    zeros = np.zeros_like(vector)
    return Learner(vector, zeros, zeros.copy(), 0, Moments.none(environment.observation_size), Moments.none(1))


def _policy(environment: Environment, settings: PpoSettings, learner: Learner) -> MlpPolicy:
    networks = _networks(environment, settings)
    layers, log_std, _ = networks.split(learner.parameters)
    moments = learner.observations
    known = moments.count > 0
    return MlpPolicy(
        weights=tuple(part.copy() for part in layers[::2]),
        biases=tuple(part.copy() for part in layers[1::2]),
        std=networks.std(log_std),
        observation_mean=moments.mean.copy() if known else None,
        observation_scale=np.maximum(np.sqrt(moments.variance), _LEAST_SCALE) if known else None,
        observation_clip=_CLIP_OBSERVATIONS,
    )


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
