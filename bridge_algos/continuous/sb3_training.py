"""Stable-Baselines3's algorithms with the hyper-parameters the paper names: the faithful way, minutes to hours.

PPO for Reacher has the settings of RL Baselines3 Zoo (its entry for ``Reacher-v2``); the shipped expert ``reacher-zoo``
is what it trains in 17 minutes. TD3 for Ant has the settings of the authors' public code, which are the algorithm's
defaults but for the steps before learning and the noise of the actions; it was never run to the end here.
Stable-Baselines3 keeps its checkpoints as pickles, which this package does not write: a killed training starts anew,
and only the policy so far is kept. It also seeds the global generators of NumPy and torch.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from bridge_algos.continuous.environments import Environment
from bridge_algos.continuous.needs import need
from bridge_algos.continuous.policies import MlpPolicy
from bridge_algos.continuous.sb3_network import policy_from_sb3_state
from bridge_theory.errors import InputError

STEPS = 1_000_000
REACHER_PPO: dict[str, Any] = {
    "batch_size": 32,
    "n_steps": 512,
    "gamma": 0.9,
    "learning_rate": 0.000104019,
    "ent_coef": 7.52585e-08,
    "clip_range": 0.3,
    "n_epochs": 5,
    "gae_lambda": 1.0,
    "max_grad_norm": 0.9,
    "vf_coef": 0.950368,
}
ANT_TD3: dict[str, Any] = {"learning_starts": 10_000, "action_noise": 0.1}
_SNAPSHOT_EVERY = 20_480


def train_with_sb3(
    environment: Environment, seed: int, steps: int = STEPS, keep: Callable[[MlpPolicy], None] | None = None
) -> MlpPolicy:
    """Train PPO (Reacher) or TD3 (Ant) with Stable-Baselines3, one environment step at a time.

    Args:
        environment: "reacher" or "ant".
        seed: of the algorithm and its environment.
        steps: environment steps, 1e6 as in the Zoo.
        keep: receives the policy every 20,480 steps.

    Raises:
        InputError: Stable-Baselines3 is not installed, or the Zoo's settings are for other environments.
    """
    sb3 = need("stable_baselines3", "sb3")
    vec_env = need("stable_baselines3.common.vec_env", "sb3")
    gymnasium = need("gymnasium")
    if environment.name not in ("reacher", "ant"):
        raise InputError(f"the settings of RL Baselines3 Zoo here are for reacher and ant, not {environment.name!r}.")
    envs: Any = vec_env.DummyVecEnv([lambda: gymnasium.make(environment.gymnasium_id)])
    if environment.name == "reacher":
        envs = vec_env.VecNormalize(envs, gamma=REACHER_PPO["gamma"])
        model = sb3.PPO("MlpPolicy", envs, seed=seed, device="cpu", **REACHER_PPO)
    else:
        noise = sb3.common.noise.NormalActionNoise(np.zeros(8), np.full(8, ANT_TD3["action_noise"]))
        model = sb3.TD3("MlpPolicy", envs, seed=seed, device="cpu", **(ANT_TD3 | {"action_noise": noise}))
    done = 0
    while done < steps:
        chunk = min(_SNAPSHOT_EVERY, steps - done)
        model.learn(chunk, reset_num_timesteps=False, progress_bar=False)
        done += chunk
        policy = _policy(model, envs)
        if keep is not None:
            keep(policy)
    return policy


def _policy(model: Any, envs: Any) -> MlpPolicy:
    state = {name: value.numpy().astype(np.float64) for name, value in model.policy.state_dict().items()}
    policy = policy_from_sb3_state(state, "the trained model")
    moments = getattr(envs, "obs_rms", None)
    if moments is None:
        return policy
    return policy.with_normalisation(
        moments.mean.copy(), np.sqrt(moments.var + envs.epsilon), clip=float(envs.clip_obs)
    )
