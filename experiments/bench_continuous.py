"""Batched rollouts against one environment at a time, in one run on one machine, and the goals they should meet.

The job is the features of 500 policies on 200 trajectories each (two hidden layers, 64 neurons on Reacher, 256 on Ant,
as in the paper's appendix "Continuous implementation"). Three ways are timed on a part of it, one after the other and
several times over, and scaled to the job; each repetition gives its own ratios, of which the median and the range are
shown, because other programs may be using the machine. Goals are held against the wall clock; the same ratios by CPU
time stand beside them, as these depend less on what else is running.

- "Step by step": ``env.step`` of ``gymnasium.make`` in a Python loop, the policy a torch module that is asked for one
  state at a time.
- "Batched": this package's ``candidate_features`` on two threads.
- "Raw limit": ``mj_step`` alone on two threads, driven through the very trajectories of the batched way, by a call from
  Python for each environment step (which took 8 % of it on Reacher and 2 % on Ant when it was measured).
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from bridge_algos.continuous.embeddings import average_state_action
from bridge_algos.continuous.environments import Environment, draw_starts, make_environment
from bridge_algos.continuous.episodes import Episodes
from bridge_algos.continuous.features import candidate_features
from bridge_algos.continuous.needs import need
from bridge_algos.continuous.policies import MlpPolicy
from bridge_algos.continuous.rollouts import rollout
from bridge_algos.continuous.starts import Starts
from bridge_algos.mdp import FloatArray
from experiments.bench import Row

POLICIES, TRAJECTORIES, THREADS = 500, 200, 2
JOBS = (("reacher", 64, 50, 8.0), ("ant", 256, 100, 2.5))


def main(argv: list[str] | None = None) -> int:
    """Print the report; exit status 3 when a goal is missed."""
    p = argparse.ArgumentParser(prog="python -m experiments.bench_continuous", description=__doc__)
    p.add_argument("--quick", action="store_true", help="fewer repetitions")
    repetitions = 3 if p.parse_args(argv).quick else 7
    missed = 0
    for name, hidden, horizon, goal in JOBS:
        for row in _compare(make_environment(name), hidden, horizon, goal, repetitions):
            print(row, flush=True)
            missed += not row.met
    print(f"\n{missed} goals missed; absolute times depend on the machine and its load, ratios much less")
    return 3 if missed else 0


def _compare(environment: Environment, hidden: int, horizon: int, goal: float, repetitions: int) -> list[Row]:
    """Seconds a step of the three ways and their ratios, repetition by repetition."""
    starts = draw_starts(environment, TRAJECTORIES, np.random.default_rng(0))
    policy = _random_policy(environment, hidden)
    episodes = rollout(environment, policy, starts, horizon=horizon, threads=THREADS)
    steps = int(episodes.lengths.sum())
    few = 4 if environment.name == "ant" else 20
    copies = 1 if environment.name == "ant" else 4
    ways: dict[str, tuple[Callable[[], object], int]] = {
        "step by step": (
            lambda: _step_by_step(environment, policy, starts.seeds[:few].tolist(), horizon),
            int(episodes.lengths[:few].sum()),
        ),
        "batched": (
            lambda: candidate_features(
                environment,
                [policy] * copies,
                starts,
                {"average_state_action": average_state_action},
                horizon=horizon,
                cache=None,
                threads=THREADS,
            ),
            copies * steps,
        ),
        "raw limit": (lambda: _raw_steps(environment, starts, episodes), steps),
    }
    with threadpool_limits(1):
        _step_by_step(environment, policy, starts.seeds[:1].tolist(), horizon)  # torch is loaded and warm
        times = np.array([[_times(work, count) for work, count in ways.values()] for _ in range(repetitions)])
    typical = np.median(times, axis=0)
    rows = [
        Row(f"{environment.name}, {name}: wall-clock a step", 1e6 * wall, unit="us")
        for name, (wall, _) in zip(ways, typical, strict=True)
    ]
    rows += [
        Row(f"  the whole job, {name} (extrapolated)", POLICIES * steps * wall, unit="s")
        for name, (wall, _) in zip(ways, typical, strict=True)
    ]
    gain, excess = times[:, 0] / times[:, 1], times[:, 1] / times[:, 2]
    return [
        *rows,
        _ratio("step by step / batched", gain[:, 0], goal),
        _ratio("the same by CPU time, two threads", THREADS * gain[:, 1]),
        _ratio("batched / raw limit", excess[:, 0], 2.0, larger_is_better=False),
        _ratio("the same by CPU time", excess[:, 1]),
    ]


def _ratio(what: str, values: FloatArray, goal: float | None = None, larger_is_better: bool = True) -> Row:
    spread = f"{values.min():.2f} to {values.max():.2f}"
    return Row(f"  {what}, median ({spread})", float(np.median(values)), goal, larger_is_better=larger_is_better)


def _times(work: Callable[[], object], steps: int) -> tuple[float, float]:
    """Seconds a step, by the wall clock and by the CPU time of all threads."""
    wall, cpu = time.perf_counter(), time.process_time()
    work()
    return (time.perf_counter() - wall) / steps, (time.process_time() - cpu) / steps


def _random_policy(environment: Environment, hidden: int) -> MlpPolicy:
    """Weights small enough that the ant stands: every episode then has all its steps."""
    rng = np.random.default_rng(1)
    sizes = [environment.observation_size, hidden, hidden, environment.action_size]
    weights = [0.3 * rng.normal(size=(a, b)) / a**0.5 for a, b in pairwise(sizes)]
    return MlpPolicy(tuple(weights), tuple(np.zeros(b) for b in sizes[1:]))


def _step_by_step(environment: Environment, policy: MlpPolicy, seeds: list[int], horizon: int) -> FloatArray:
    """The features as a plain loop computes them, a trajectory and a state at a time."""
    gymnasium, torch = need("gymnasium"), need("torch")
    module = _as_torch(torch, policy)
    env = gymnasium.make(environment.gymnasium_id)
    features = []
    for seed in seeds:
        observation, _ = env.reset(seed=seed)
        total = np.zeros(environment.observation_size + environment.action_size)
        for _ in range(horizon):
            with torch.no_grad():
                mean = module(torch.as_tensor(observation, dtype=torch.float32)).numpy()
            action = np.clip(mean, environment.low, environment.high)
            total += np.concatenate([observation, action])
            observation, _, terminated, truncated, _ = env.step(action)
            if terminated or truncated:
                break
        features.append(total / horizon)
    env.close()
    return np.asarray(np.mean(features, axis=0))


def _as_torch(torch: Any, policy: MlpPolicy) -> Any:
    layers: list[Any] = []
    for weight, bias in zip(policy.weights, policy.biases, strict=True):
        linear = torch.nn.Linear(*weight.shape)
        linear.weight.data, linear.bias.data = torch.from_numpy(weight.T).float(), torch.from_numpy(bias).float()
        layers += [linear, torch.nn.Tanh()]
    return torch.nn.Sequential(*layers[:-1])


def _raw_steps(environment: Environment, starts: Starts, episodes: Episodes) -> None:
    """MuJoCo alone, with the model as Gymnasium has it: the recorded actions from the recorded starts."""
    mujoco = need("mujoco")
    model, frames = environment.reference.model, environment.reference.frame_skip

    def drive(rows: range) -> None:
        data = mujoco.MjData(model)
        for row in rows:
            mujoco.mj_resetData(model, data)
            data.qpos[:], data.qvel[:] = np.split(starts.states[row], [model.nq])
            for action in episodes.actions[row, : episodes.lengths[row]]:
                data.ctrl[:] = action
                mujoco.mj_step(model, data, nstep=frames)

    with ThreadPoolExecutor(THREADS) as pool:
        list(pool.map(drive, [range(first, len(starts), THREADS) for first in range(THREADS)]))


if __name__ == "__main__":
    sys.exit(main())
