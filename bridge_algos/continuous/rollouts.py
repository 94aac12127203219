"""Closed-loop rollouts of many policies, in blocks of fixed shape, on threads.

A work item is one policy on a block of at most 50 initial states; a thread runs it from start to end. The shape of
every matrix product is thus fixed, whatever the number of threads, policies or initial states, and so are all numbers.
Only the current blocks' observations are in memory.
"""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import fields
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from bridge_algos.continuous.environments import Block, Environment
from bridge_algos.continuous.episodes import Episodes
from bridge_algos.continuous.policies import Policy
from bridge_algos.continuous.starts import Starts
from bridge_algos.mdp import FloatArray
from bridge_theory.errors import InputError

BLOCK = 50
_QUEUED_PER_THREAD = 4


def rollout(
    environment: Environment,
    policy: Policy,
    starts: Starts,
    *,
    horizon: int | None = None,
    rng: np.random.Generator | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> Episodes:
    """One episode of a policy from each start; the arguments are those of :func:`map_rollouts`."""
    items = _items(environment, [policy], [starts], lambda episodes: episodes, horizon, rng, threads, progress)
    blocks = [episodes for _, episodes in items]
    return Episodes(*(np.concatenate([getattr(block, field.name) for block in blocks]) for field in fields(Episodes)))


def map_rollouts(
    environment: Environment,
    policies: Sequence[Policy],
    starts: Starts | Sequence[Starts],
    function: Callable[[Episodes], FloatArray],
    *,
    horizon: int | None = None,
    rng: np.random.Generator | None = None,
    threads: int | None = None,
    progress: bool = False,
) -> FloatArray:
    """What a function makes of each episode of each policy, (N, n, k), without keeping the episodes.

    Args:
        environment: the environment.
        policies: N policies, made as they are needed (a lazy sequence keeps memory small).
        starts: n initial states, common to all policies, or n for each of them, one entry a policy.
        function: from episodes to (m, k) numbers, row i from episode i; called on blocks, from several threads.
        horizon: steps H at most; None for the environment's own limit.
        rng: None for mean actions; a generator for actions of Gaussian policies, one child generator a policy.
        threads: None for all cores; does not change the numbers.
        progress: whether to show a progress bar.

    Raises:
        InputError: a horizon out of range, lists of starts that do not fit the policies, a policy without ``std``
            though ``rng`` is given, or a policy whose actions have another shape or are not finite.
    """
    results: list[list[FloatArray]] = [[] for _ in range(len(policies))]  # a lazy sequence is not to be gone through
    own = [starts] * len(policies) if isinstance(starts, Starts) else list(starts)
    if len(own) != len(policies) or len({len(each) for each in own}) > 1:
        raise InputError(
            f"{len(own)} lists of initial states were given for {len(policies)} policies, expected one common to all, "
            "or one for each policy, equally long."
        )
    for index, values in _items(environment, policies, own, function, horizon, rng, threads, progress):
        results[index].append(values)
    return np.stack([np.concatenate(blocks) for blocks in results])


def _items(
    environment: Environment,
    policies: Sequence[Policy],
    starts: list[Starts],
    function: Callable[[Episodes], Any],
    horizon: int | None,
    rng: np.random.Generator | None,
    threads: int | None,
    progress: bool,
) -> Iterator[tuple[int, Any]]:
    """(policy's index, the function's value on a block) for all blocks of all policies, in order."""
    from tqdm import tqdm

    steps = _checked_horizon(environment, horizon)
    workers = threads or os.cpu_count() or 1
    own = threading.local()

    def work(policy: Policy, part: Starts, generator: np.random.Generator | None) -> Any:
        if not hasattr(own, "block"):
            own.block = environment.new_block(min(BLOCK, len(starts[0])))
        return function(_run(environment, own.block, policy, part, steps, generator))

    bar = tqdm(total=len(policies) * len(starts[0]), unit="episode", disable=not progress)
    pool = ThreadPoolExecutor(workers)
    # More BLAS threads would only take the cores from the pool's, and might change the last bits.
    with bar, threadpool_limits(1, user_api="blas"):
        try:
            queue: deque[tuple[int, int, Future[Any]]] = deque()
            for index, part, policy, generator in _blocks(policies, starts, rng):
                queue.append((index, len(part), pool.submit(work, policy, part, generator)))
                while len(queue) > _QUEUED_PER_THREAD * workers:
                    yield _finished(*queue.popleft(), bar)
            while queue:
                yield _finished(*queue.popleft(), bar)
        finally:
            pool.shutdown(cancel_futures=True)


def _blocks(
    policies: Sequence[Policy], starts: list[Starts], rng: np.random.Generator | None
) -> Iterator[tuple[int, Starts, Policy, np.random.Generator | None]]:
    generators = [None] * len(policies) if rng is None else rng.spawn(len(policies))
    for index, generator in enumerate(generators):
        policy, own = policies[index], starts[index]
        parts = [own[first : first + BLOCK] for first in range(0, len(own), BLOCK)]
        children = [None] * len(parts) if generator is None else generator.spawn(len(parts))
        for part, child in zip(parts, children, strict=True):
            yield index, part, policy, child


def _finished(index: int, count: int, future: Future[Any], bar: Any) -> tuple[int, Any]:
    try:
        value = future.result()
    except InputError as error:
        raise InputError(f"policy {index}: {error}") from None
    bar.update(count)
    return index, value


def _checked_horizon(environment: Environment, horizon: int | None) -> int:
    if horizon is None:
        return environment.max_steps
    if not 1 <= horizon <= environment.max_steps:
        raise InputError(
            f"the horizon is {horizon}, expected 1 to {environment.max_steps}, where {environment.name} is truncated."
        )
    return horizon


def _run(
    environment: Environment,
    block: Block,
    policy: Policy,
    starts: Starts,
    horizon: int,
    rng: np.random.Generator | None,
) -> Episodes:
    """One block of episodes of one policy. The policy always sees BLOCK rows, of which some may be empty or ended."""
    n, d_a = len(starts), environment.action_size
    low, high = environment.low.astype(np.float64), environment.high.astype(np.float64)
    noise = None if rng is None else _std(policy, d_a) * rng.standard_normal((horizon, BLOCK, d_a))
    observations = np.zeros((n, horizon + 1, environment.observation_size))
    actions = np.zeros((n, horizon, d_a), dtype=np.float32)
    rewards, lengths, terminated = np.zeros((n, horizon)), np.full(n, horizon), np.zeros(n, dtype=np.bool_)
    seen = np.zeros((BLOCK, environment.observation_size))
    running = np.arange(n)
    observations[:, 0] = block.reset(starts, running)
    for h in range(horizon):
        seen[running] = observations[running, h]
        wanted = _checked_actions(policy(seen), running, d_a)
        if noise is not None:
            wanted = wanted + noise[h]
        actions[running, h] = np.clip(wanted, low, high)[running]
        arrived, rewards[running, h], ended = block.step(actions[running, h], running)
        observations[running, h + 1] = arrived
        if ended.any():
            terminated[running[ended]], lengths[running[ended]] = True, h + 1
            running = running[~ended]
            if not len(running):
                break
    if not (np.isfinite(rewards).all() and np.isfinite(observations).all()):
        raise InputError(f"under it {environment.name} gives observations or rewards that are not finite.")
    return Episodes(observations, actions, rewards, lengths, terminated)


def _std(policy: Policy, d_a: int) -> FloatArray:
    std = getattr(policy, "std", None)
    if std is None or np.shape(std) != (d_a,):
        raise InputError(f"it has no std of shape ({d_a},), as sampled actions need; leave out rng for mean actions.")
    return np.asarray(std)


def _checked_actions(wanted: FloatArray, running: Any, d_a: int) -> FloatArray:
    if np.shape(wanted) != (BLOCK, d_a):
        raise InputError(f"it answers {BLOCK} observations with shape {np.shape(wanted)}, expected ({BLOCK}, {d_a}).")
    if not np.isfinite(wanted[running]).all():
        raise InputError("it answers with actions that are not finite; its parameters or observations have diverged.")
    return wanted
