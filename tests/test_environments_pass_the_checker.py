"""Gymnasium environments: the checker passes without a warning, steps follow the MDP's law, pictures show the state."""

import subprocess
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from scipy.stats import binom

from bridge_algos.envs import garnet, gridworld, make_mdp, mdp_from_gymnasium, register_environments, star_mdp
from bridge_algos.envs.gymnasium_env import TabularEnv
from bridge_algos.mdp import TabularMDP
from bridge_theory.errors import InputError

IDS = register_environments()
FAILURE = 1e-6


@pytest.mark.parametrize("identifier", IDS)
def test_the_checker_finds_nothing(identifier):
    """Warnings are errors in these tests, so that the checker's warnings fail them too."""
    check_env(gymnasium.make(identifier).unwrapped)


def test_registering_again_changes_nothing_and_warns_nothing():
    before = dict(gymnasium.registry)
    assert register_environments() == IDS
    assert dict(gymnasium.registry) == before
    assert {"bridge_rl/StarMDP-v0", "bridge_rl/StarMDPText-v0", "bridge_rl/Gridworld-v0"} <= set(IDS)


def test_an_id_that_names_the_module_needs_no_registration():
    code = (
        "import gymnasium\n"
        "env = gymnasium.make('bridge_algos.envs.gymnasium_env:bridge_rl/Garnet-v0', seed=3)\n"
        "assert env.spec.kwargs == {'mdp': 'garnet', 'seed': 3}, env.spec"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)


def test_options_and_specification_survive_json():
    env = gymnasium.make("bridge_rl/Chain-v0", n_states=8, horizon=20)
    assert (env.observation_space.n, env.unwrapped.horizon) == (8, 20)
    again = gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json()))
    assert np.array_equal(again.unwrapped.mdp.transitions, env.unwrapped.mdp.transitions)


def test_an_episode_is_truncated_after_the_horizon_and_never_terminated():
    env = gymnasium.make("bridge_rl/Gridworld-v0")
    env.reset(seed=0)
    ends = [env.step(0)[2:4] for _ in range(10)]
    assert ends == [(False, False)] * 9 + [(False, True)]
    with pytest.raises(InputError, match=r"step 11 of 10 is outside an episode; call reset\(\) first"):
        env.step(0)


def test_the_seed_of_reset_is_the_only_randomness():
    def episode(seed, noise):
        np.random.default_rng(noise).random()
        env = TabularEnv(garnet(6, 2, 3, np.random.default_rng(0)))
        return [env.reset(seed=seed)[0]] + [env.step(1)[0] for _ in range(10)]

    assert episode(5, 0) == episode(5, 1)
    assert len({tuple(episode(seed, 0)) for seed in range(8)}) > 1


@pytest.mark.parametrize("name", ["starmdp", "garnet"])
def test_steps_follow_the_kernel_and_starts_the_initial_law(name):
    """Exact binomial tails, at failure probability 1e-6 for all counts of a test together."""
    env = TabularEnv(name)
    mdp, rng = env.mdp, np.random.default_rng(2)
    starts, steps = np.zeros(mdp.n_states), np.zeros(mdp.transitions.shape)
    env.reset(seed=1)
    for _ in range(2000):
        state, info = env.reset()
        starts[state] += 1
        assert info["prob"] == mdp.initial[state]
        for _ in range(mdp.horizon):
            action = int(rng.integers(mdp.n_actions))
            target, _, _, _, info = env.step(action)
            steps[state, action, target] += 1
            assert info["prob"] == mdp.transitions[state, action, target]
            state = target
    visits = steps.sum(axis=2, keepdims=True)
    assert visits.min() > 100
    for counts, trials, law in ((steps, visits, mdp.transitions), (starts, starts.sum(), mdp.initial)):
        tails = np.minimum(binom.cdf(counts, trials, law), binom.sf(counts - 1, trials, law))
        assert tails.min() > FAILURE / (4 * tails.size)


@pytest.mark.parametrize("shape", ["arrival", "pair", "transition"])
def test_rewards_of_all_three_shapes_are_those_of_the_mdp(shape):
    base = garnet(4, 2, 2, np.random.default_rng(3))
    rng = np.random.default_rng(4)
    reward = rng.random({"arrival": 4, "pair": (4, 2), "transition": (4, 2, 4)}[shape])
    env = TabularEnv(TabularMDP(base.transitions, base.initial, 50, reward, reward_on=shape))
    state, _ = env.reset(seed=0)
    for step in range(50):
        action = step % 2
        target, paid, *_ = env.step(action)
        index = {"arrival": (target,), "pair": (state, action), "transition": (state, action, target)}[shape]
        assert paid == reward[index]
        state = target


@pytest.mark.parametrize("name", ["starmdp", "gridworld-text", "chain", "cliff", "garnet"])
def test_the_table_P_gives_the_mdp_back(name):
    mdp = make_mdp(name)
    again = mdp_from_gymnasium(TabularEnv(mdp))
    assert np.array_equal(again.transitions, mdp.transitions)
    assert np.array_equal(again.initial, mdp.initial)
    assert again.horizon == mdp.horizon
    assert again.expected_reward == pytest.approx(mdp.expected_reward, abs=1e-14)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: TabularEnv("starmpd"), "did you mean 'starmdp'"),
        (lambda: TabularEnv(star_mdp(), n_states=3), "belong to a name"),
        (
            lambda: TabularEnv("starmdp", render_mode="human"),
            "render_mode is 'human', expected one of ['ansi', 'rgb_array'] or None.",
        ),
        (lambda: TabularEnv("starmdp").step(0), "call reset() first"),
        (lambda: _reset("starmdp").step(4), "action is 4, expected a whole number in 0..3."),
        (lambda: TabularEnv("starmdp", render_mode="ansi").render(), "call reset() first"),
    ],
)
def test_mistakes_get_one_sentence(make, sentence):
    with pytest.raises(InputError) as caught:
        make()
    assert sentence in str(caught.value)


def _reset(name: str, **options) -> TabularEnv:
    env = TabularEnv(name, **options)
    env.reset(seed=0)
    return env


def test_text_shows_map_position_and_last_action():
    env = _reset("gridworld", render_mode="ansi")
    assert env.render().splitlines()[:2] == ["Gridworld, step 0 of 10", "[S] .  .  ."]
    env.step(1)
    lines = env.render().splitlines()
    assert lines[0] == "Gridworld, step 1 of 10: right, reward 0"
    assert sum(line.count("[") for line in lines) == 1
    assert lines[-1] == f"state {env.mdp.state_names[env.state]}"


@pytest.mark.parametrize("name", ["gridworld", "starmdp", "garnet", "frozenlake", "cliffwalking", "taxi"])
def test_images_are_images_and_move_with_the_agent(name):
    env = _reset(name, render_mode="rgb_array")
    before = env.render()
    assert before.dtype == np.uint8
    assert before.ndim == 3
    assert before.shape[2] == 3
    env.state = (env.state + 1) % env.mdp.n_states
    after = env.render()
    assert after.shape == before.shape
    assert not np.array_equal(after, before)


def test_the_agent_is_drawn_in_its_cell():
    """Most of the agent's blue lies in the cell of its state."""
    from bridge_algos.envs.render_image import draw

    mdp = gridworld()
    for state in (0, 7, 12, 15):
        image = draw(mdp, state, None, 0.0, 0)
        blue = np.argwhere((np.abs(image.astype(int) - [0x00, 0x72, 0xB2]) < 12).all(axis=2))
        grid_top = image.shape[0] - 4 * 115 - 11
        row, column = (blue.mean(axis=0) - [grid_top, 10]) // 115
        assert (int(row), int(column)) == divmod(state, 4)


def test_drawing_touches_no_global_state_of_matplotlib():
    code = (
        "import sys; from bridge_algos.envs.gymnasium_env import TabularEnv\n"
        "env = TabularEnv('starmdp', render_mode='rgb_array'); env.reset(seed=0); env.render()\n"
        "assert 'matplotlib.pyplot' not in sys.modules and 'pygame' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize(("number", "expected"), [(0.0, 1), (np.nextafter(1.0, 0.0), 2)])
def test_states_of_probability_zero_are_never_drawn(number, expected):
    """Not even by the smallest and the largest number that a generator can return."""

    class Extreme(np.random.Generator):
        def random(self, *args, **kwargs):
            return number

    env = TabularEnv(TabularMDP(np.tile([0.0, 0.3, 0.7, 0.0], (4, 1, 1)), [0.0, 0.3, 0.7, 0.0], 2, np.zeros(4)))
    env.np_random = Extreme(np.random.PCG64(0))
    assert env.reset()[0] == expected
    assert env.step(0)[0] == expected
