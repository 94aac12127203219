"""Any tabular MDP as a Gymnasium environment, with a text and an image rendering."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium.spaces import Discrete
from numpy.typing import NDArray

from bridge_algos.envs.registration import register_environments
from bridge_algos.envs.registry import make_mdp
from bridge_algos.mdp import TabularMDP
from bridge_theory.errors import InputError


class TabularEnv(gymnasium.Env):  # type: ignore[misc]
    """A Gymnasium environment with the law of a tabular MDP.

    Observations and actions are whole numbers. An episode is truncated after H steps, never terminated: the horizon is
    a limit of time, no property of a state. All randomness comes from the generator that ``reset(seed=...)`` seeds.

    Args:
        mdp: the MDP, or a name that :func:`bridge_algos.envs.registry.make_mdp` knows.
        render_mode: None, ``"ansi"`` (text) or ``"rgb_array"`` (an image, (height, width, 3) of uint8).
        options: with a name, the options of ``make_mdp``.

    Attributes:
        P: the transition table as in Gymnasium's toy_text, ``P[s][a]`` a list of (probability, next state, reward,
            terminated), outcomes of probability 0 left out.
        initial_state_distrib: (S,) law of the first state.
        horizon: H.

    Raises:
        InputError: an unknown name, option or render mode; a step that is no action; a step before ``reset`` or after
            the end.

    >>> env = TabularEnv("starmdp-text", render_mode="ansi")
    >>> state, info = env.reset(seed=0)
    >>> print(env.render())
    StarMDP (text), step 0 of 8
    state s0
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["ansi", "rgb_array"], "render_fps": 2}

    def __init__(self, mdp: TabularMDP | str, render_mode: str | None = None, **options: Any) -> None:
        if isinstance(mdp, str):
            mdp = make_mdp(mdp, **options)
        elif options:
            raise InputError(f"options {sorted(options)} belong to a name; the MDP {mdp.name!r} was given itself.")
        if render_mode is not None and render_mode not in self.metadata["render_modes"]:
            raise InputError(
                f"render_mode is {render_mode!r}, expected one of {self.metadata['render_modes']} or None."
            )
        self.mdp = mdp
        self.render_mode = render_mode
        self.observation_space = Discrete(mdp.n_states)
        self.action_space = Discrete(mdp.n_actions)
        self.initial_state_distrib = mdp.initial
        self.horizon = mdp.horizon
        self.state: int | None = None
        self.last_action: int | None = None
        self.last_reward = 0.0
        self.steps = 0

    @cached_property
    def P(self) -> dict[int, dict[int, list[tuple[float, int, float, bool]]]]:
        kernel, mdp = self.mdp.transitions, self.mdp
        return {
            state: {
                action: [
                    (
                        float(kernel[state, action, target]),
                        target,
                        float(mdp.realised_rewards(state, action, target)),
                        False,
                    )
                    for target in np.flatnonzero(kernel[state, action]).tolist()
                ]
                for action in range(mdp.n_actions)
            }
            for state in range(mdp.n_states)
        }

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[int, dict[str, Any]]:
        super().reset(seed=seed)
        self.state = _draw(self.mdp.initial, self.np_random)
        self.last_action, self.last_reward, self.steps = None, 0.0, 0
        return self.state, {"prob": float(self.mdp.initial[self.state])}

    def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
        if self.state is None or self.steps >= self.horizon:
            raise InputError(f"step {self.steps + 1} of {self.horizon} is outside an episode; call reset() first.")
        if not self.action_space.contains(action):
            raise InputError(f"action is {action!r}, expected a whole number in 0..{self.mdp.n_actions - 1}.")
        law = self.mdp.transitions[self.state, action]
        target = _draw(law, self.np_random)
        self.last_reward = float(self.mdp.realised_rewards(self.state, int(action), target))
        self.state, self.last_action = target, int(action)
        self.steps += 1
        return target, self.last_reward, False, self.steps == self.horizon, {"prob": float(law[target])}

    def render(self) -> str | NDArray[np.uint8] | None:
        if self.render_mode is None:
            gymnasium.logger.warn("render() does nothing without a render_mode; make the environment with 'ansi'.")
            return None
        if self.state is None:
            raise InputError("there is nothing to render before the first reset(); call reset() first.")
        from bridge_algos.envs import render_image, render_text

        frame = (self.mdp, self.state, self.last_action, self.last_reward, self.steps)
        return render_text.draw(*frame) if self.render_mode == "ansi" else render_image.draw(*frame)


def _draw(law: NDArray[np.float64], rng: np.random.Generator) -> int:
    cumulative = np.cumsum(law)
    return int(np.searchsorted(cumulative / cumulative[-1], rng.random(), side="right"))


register_environments()  # so that gymnasium.make("bridge_algos.envs.gymnasium_env:bridge_rl/...") finds the id
