"""Random MDPs that meet the awkward cases: ties, unreachable states, equal actions, every reward form, any scale."""

import numpy as np
from hypothesis import strategies as st

from bridge_algos.mdp import TabularMDP


def random_mdp(seed: int, n_states: int, n_actions: int, horizon: int, scale: float = 1.0) -> TabularMDP:
    rng = np.random.default_rng(seed)
    successors = 1 + seed % n_states
    shape = (n_states, n_actions, n_states)
    weights = rng.integers(1, 5, size=shape) if seed % 2 else rng.random(shape)
    rank = rng.random(shape).argsort(axis=-1)
    transitions = np.where(rank < successors, weights, 0.0)
    transitions /= transitions.sum(axis=-1, keepdims=True)
    paid = [shape[:1], shape[:2], shape][seed % 3]
    reward = rng.integers(-1, 3, size=paid) if seed % 5 < 3 else rng.normal(size=paid)
    initial = np.eye(n_states)[0] if seed % 7 < 4 else np.full(n_states, 1 / n_states)
    reward_on = ("arrival", "pair", "transition")[seed % 3]
    name = f"random {seed}"
    return TabularMDP(transitions, initial, horizon, scale * reward, name, axes="state-action", reward_on=reward_on)


def random_mdps(max_states: int = 6, max_actions: int = 3, max_horizon: int = 6, scales: tuple[float, ...] = (1.0,)):
    return st.builds(
        random_mdp,
        seed=st.integers(0, 10**6),
        n_states=st.integers(1, max_states),
        n_actions=st.integers(1, max_actions),
        horizon=st.integers(1, max_horizon),
        scale=st.sampled_from(scales),
    )


def parting_gift(horizon: int = 3) -> TabularMDP:
    """Stay for a reward of 1 a step, or leave once for 5: best is to leave last, which no stationary policy can."""
    return TabularMDP(
        transitions=[[[1, 0], [0, 1]], [[0, 1], [0, 1]]],
        initial=[1, 0],
        horizon=horizon,
        reward=[[1, 5], [0, 0]],
        axes="state-action",
        reward_on="pair",
    )


def contested_mdp(seed: int, n_states: int = 7, n_actions: int = 3, horizon: int = 6) -> TabularMDP:
    """Few moves and whole rewards: the best action often depends on the time left, so that stationarity costs."""
    rng = np.random.default_rng(seed)
    transitions = np.zeros((n_states, n_actions, n_states))
    for state in range(n_states):
        for action in range(n_actions):
            likely, other = rng.choice(n_states, 2, replace=False)
            transitions[state, action, [likely, other]] = [0.9, 0.1] if seed % 2 else [1.0, 0.0]
    reward = rng.integers(-2, 6, size=(n_states, n_actions))
    return TabularMDP(transitions, np.full(n_states, 1 / n_states), horizon, reward, name=f"contested {seed}")
