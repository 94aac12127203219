"""An environment's table as an MDP: exact against the table, right against ``env.step``, terminal states absorbing."""

import math

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box, Discrete
from scipy.stats import binom

from bridge_algos.envs import mdp_from_gymnasium
from bridge_algos.mdp import TabularMDP
from bridge_theory.errors import InputError

FAILURE = 1e-6
RAINY_TAXI = {"is_rainy": True}
CASES = [
    ("FrozenLake-v1", {}),
    ("FrozenLake-v1", {"is_slippery": False}),
    ("FrozenLake8x8-v1", {}),
    ("CliffWalking-v1", {}),
    ("CliffWalkingSlippery-v1", {}),
    ("Taxi-v4", {}),
    ("Taxi-v4", RAINY_TAXI),
]


def episode_law_by_table(env, policy, horizon):
    """Expected reward of each step and the law of the state while the episode runs, from the table alone."""
    alive = dict(enumerate(env.unwrapped.initial_state_distrib))
    for _ in range(horizon):
        pay, following = 0.0, dict.fromkeys(alive, 0.0)
        for state, mass in alive.items():
            if mass:
                for action, outcomes in env.unwrapped.P[state].items():
                    for probability, target, reward, terminated in outcomes:
                        weight = mass * policy[state, action] * probability
                        pay += weight * reward
                        if not terminated:
                            following[target] += weight
        alive = following
        yield pay, np.array(list(alive.values()))


@pytest.mark.parametrize(("identifier", "options"), CASES)
def test_every_step_is_exact_against_the_table(identifier, options):
    """Expected pay of each step, law of the running episode, and mass that ended, for a random policy."""
    env = gymnasium.make(identifier, **options)
    n_states = env.observation_space.n
    mdp = mdp_from_gymnasium(env, horizon=12)
    policy = np.random.default_rng(0).dirichlet(np.ones(mdp.n_actions), size=mdp.n_states)
    absorbing = (mdp.transitions[range(mdp.n_states), :, range(mdp.n_states)] == 1).all(axis=1)
    law = mdp.initial
    for pay, alive in episode_law_by_table(env, policy[:n_states], mdp.horizon):
        occupied = law[:, None] * policy
        assert (occupied * mdp.expected_reward).sum() == pytest.approx(pay, rel=1e-12, abs=1e-15)
        law = np.einsum("sa,sap->p", occupied, mdp.transitions)
        assert np.where(absorbing, 0, law)[:n_states] == pytest.approx(
            np.where(absorbing[:n_states], 0, alive), abs=1e-15
        )
        assert law.sum() - np.where(absorbing, 0, law).sum() == pytest.approx(1 - alive.sum(), abs=1e-12)
    assert not mdp.expected_reward[absorbing].any()


@pytest.mark.parametrize(
    ("identifier", "horizon", "episodes"),
    [
        ("FrozenLake-v1", 15, 3000),
        ("CliffWalkingSlippery-v1", 8, 3000),
        ("CliffWalking-v1", 15, 1000),
        ("Taxi-v4", 6, 2000),
    ],
)
def test_simulated_episodes_follow_the_mdp(identifier, horizon, episodes):
    """Last states within exact binomial tails and the mean return within Hoeffding's bound, jointly at 1e-6."""
    env = gymnasium.make(identifier).unwrapped
    mdp = mdp_from_gymnasium(gymnasium.make(identifier), horizon)
    policy = np.random.default_rng(1).dirichlet(np.full(mdp.n_actions, 0.5), size=mdp.n_states)
    rng = np.random.default_rng(2)
    finals, total = np.zeros(mdp.n_states), 0.0
    env.reset(seed=3)
    for _ in range(episodes):
        state, _ = env.reset()
        for _ in range(horizon):
            state, reward, terminated, _, _ = env.step(int(rng.choice(mdp.n_actions, p=policy[state])))
            total += reward
            if terminated:
                state = mdp.n_states - 1 if mdp.state_names[-1] == "end" else state
                break
        finals[state] += 1
    law, mean = mdp.initial, 0.0
    for _ in range(horizon):
        mean += float((law[:, None] * policy * mdp.expected_reward).sum())
        law = np.einsum("s,sa,sap->p", law, policy, mdp.transitions)
    law = np.minimum(law, 1.0)
    tails = np.minimum(binom.cdf(finals, episodes, law), binom.sf(finals - 1, episodes, law))
    assert tails.min() > FAILURE / (4 * mdp.n_states)
    step_range = 1 if identifier.startswith("FrozenLake") else horizon * (mdp.reward.max() - mdp.reward.min())
    assert abs(total / episodes - mean) < step_range * math.sqrt(math.log(4 / FAILURE) / (2 * episodes))


def optimal(mdp):
    """Values (H + 1, S) and greedy actions (H, S) by backward induction."""
    values, actions = np.zeros((mdp.horizon + 1, mdp.n_states)), np.zeros((mdp.horizon, mdp.n_states), dtype=int)
    for h in reversed(range(mdp.horizon)):
        q = mdp.expected_reward + mdp.transitions @ values[h + 1]
        values[h], actions[h] = q.max(axis=1), q.argmax(axis=1)
    return values, actions


@pytest.mark.parametrize(("identifier", "options", "best"), [("Taxi-v4", {}, None), ("CliffWalking-v1", {}, -13)])
def test_optimal_play_earns_its_value_from_every_start(identifier, options, best):
    """Deterministic environments: the return of ``env.step`` equals the value, start by start."""
    env = gymnasium.make(identifier, **options).unwrapped
    mdp = mdp_from_gymnasium(gymnasium.make(identifier, **options), horizon=30)
    values, actions = optimal(mdp)
    env.reset(seed=0)
    starts = np.flatnonzero(mdp.initial)
    for start in starts:
        env.s, state, earned = start, start, 0
        for h in range(mdp.horizon):
            state, reward, terminated, _, _ = env.step(actions[h, state])
            earned += reward
            if terminated:
                break
        assert terminated
        assert earned == pytest.approx(values[0, start], abs=1e-12)
        assert best is None or earned == best
    assert mdp.initial @ values[0] == pytest.approx(np.mean(values[0, starts]))


def test_frozen_lake_value_is_the_known_one():
    """The discounted-free value of 4x4 FrozenLake within 100 steps; Gymnasium's source states an optimum of 0.74."""
    mdp = mdp_from_gymnasium("FrozenLake-v1")
    assert mdp.initial @ optimal(mdp)[0][0] == pytest.approx(0.74, abs=0.005)


def test_states_horizons_and_names():
    lake, cliff, taxi = (mdp_from_gymnasium(name) for name in ("FrozenLake-v1", "CliffWalking-v1", "Taxi-v4"))
    assert (lake.n_states, lake.horizon, lake.layout[0]) == (16, 100, "SFFF")
    assert (cliff.n_states, cliff.horizon, cliff.layout[3]) == (48, 100, "SCCCCCCCCCCG")
    assert (taxi.n_states, taxi.horizon, taxi.state_names[-1]) == (501, 200, "end")
    assert taxi.action_names == ("south", "north", "east", "west", "pickup", "dropoff")
    assert (cliff.transitions[47, :, 47] == 1).all()
    assert not cliff.expected_reward[47].any()
    assert mdp_from_gymnasium(gymnasium.make("FrozenLake-v1", max_episode_steps=7)).horizon == 7
    assert TabularMDP.from_gymnasium("CliffWalking-v1", 9).horizon == 9


def test_rewards_that_differ_for_one_transition_are_averaged():
    """Slippery CliffWalking, moving down at the start: right falls (-100), down and left bump into the border (-1)."""
    mdp = mdp_from_gymnasium("CliffWalkingSlippery-v1")
    assert mdp.transitions[36, 2, 36] == pytest.approx(1)
    assert mdp.reward[36, 2, 36] == pytest.approx(-34)


class TableEnv(gymnasium.Env):
    """A bare environment around a table."""

    def __init__(self, table, initial, n_actions=1, n_states=None):
        self.P, self.initial_state_distrib = table, np.array(initial, dtype=float)
        self.observation_space, self.action_space = Discrete(n_states or len(initial)), Discrete(n_actions)


def test_a_terminal_state_absorbs_whatever_its_own_row_says():
    mdp = mdp_from_gymnasium(TableEnv({0: {0: [(1.0, 1, 5.0, True)]}, 1: {0: [(1.0, 0, 7.0, False)]}}, [1, 0]), 3)
    assert mdp.transitions[:, 0].tolist() == [[0, 1], [0, 1]]
    assert mdp.expected_reward.ravel().tolist() == [5, 0]


def test_ending_in_a_state_that_also_runs_on_leads_to_an_extra_state():
    table = {0: {0: [(0.5, 1, 1.0, True), (0.5, 1, 2.0, False)]}, 1: {0: [(1.0, 1, 3.0, False)]}}
    mdp = mdp_from_gymnasium(TableEnv(table, [1, 0]), 2)
    assert mdp.state_names == ("0", "1", "end")
    assert mdp.transitions[0, 0].tolist() == [0, 0.5, 0.5]
    assert mdp.expected_reward.ravel().tolist() == [1.5, 3, 0]


def test_ending_in_the_first_state_leads_to_an_extra_state():
    mdp = mdp_from_gymnasium(TableEnv({0: {0: [(1.0, 0, 1.0, True)]}}, [1]), 5)
    assert mdp.transitions[:, 0].tolist() == [[0, 1], [0, 1]]
    assert mdp.expected_reward.ravel().tolist() == [1, 0]


def test_an_own_time_limit_or_transparent_wrapper_is_no_obstacle():
    env = gymnasium.wrappers.RecordEpisodeStatistics(gymnasium.make("FrozenLake-v1"))
    assert mdp_from_gymnasium(env).horizon == 100


def _frozen(**changes):
    env = TableEnv({0: {0: [(1.0, 0, 0.0, False)]}}, [1.0])
    for name, value in changes.items():
        setattr(env, name, value)
    return env


@pytest.mark.parametrize(
    ("environment", "sentence"),
    [
        ("CartPole-v1", "has no transition table P[s][a]"),
        ("FrozenLake-v99", "Gymnasium cannot make 'FrozenLake-v99'"),
        ("no_such_module:Env-v0", "Gymnasium cannot make"),
        (None, "environment is None, expected a Gymnasium environment or the id of one."),
        (lambda: gymnasium.make("Taxi-v4", fickle_passenger=True), "fickle_passenger=True changes the destination"),
        (
            lambda: gymnasium.wrappers.TransformReward(gymnasium.make("Taxi-v4"), lambda r: 2 * r),
            "the wrapper TransformReward",
        ),
        (lambda: _frozen(observation_space=Box(0, 1)), "the observation_space of"),
        (lambda: _frozen(action_space=Discrete(1, start=1)), "expected Discrete(n) counted from 0."),
        (lambda: _frozen(P={}), "for all 1 states and 1 actions (KeyError"),
        (
            lambda: _frozen(P={0: {0: [(1.0, 0)]}}),
            "is not P[s][a] = [(probability, next state, reward, terminated), ...]",
        ),
        (lambda: _frozen(P={0: {0: [(1.0, 1, 0.0, False)]}}), "P[0][0] of"),
        (lambda: _frozen(P={0: {0: [(-1.0, 0, 0.0, False)]}}), "has the probability -1"),
        (lambda: _frozen(P={0: {0: [(0.5, 0, 0.0, False)]}}), "transitions[0, 0] sums to 0.5"),
        (lambda: _frozen(P={0: {0: []}}), "all zero"),
        (lambda: _frozen(initial_state_distrib=[0.5, 0.5]), "initial_state_distrib of"),
    ],
)
def test_what_has_no_exact_mdp_gets_one_sentence(environment, sentence):
    with pytest.raises(InputError) as caught:
        mdp_from_gymnasium(environment() if callable(environment) else environment)
    assert sentence in str(caught.value)
    assert "\n" not in str(caught.value)
