"""Garnet, chain and cliff are what their docstrings say, and refuse what they cannot be."""

import numpy as np
import pytest
from scipy.stats import binom, kstest

from bridge_algos.envs import chain, cliff, garnet, make_mdp, mdp_names
from bridge_theory.errors import InputError

FAILURE = 1e-6


@pytest.mark.parametrize("branching", [1, 2, 7])
def test_garnet_has_exactly_branching_successors(branching):
    mdp = garnet(7, 3, branching, np.random.default_rng(0), horizon=4)
    assert ((mdp.transitions > 0).sum(axis=2) == branching).all()
    assert mdp.reward.shape == (7, 3)
    assert 0 <= mdp.reward.min() < mdp.reward.max() < 1
    assert mdp.horizon == 4


def test_garnet_successors_and_probabilities_are_uniform():
    """Each state succeeds with probability b/S (exact binomial tails); with b = 2 the first gap is uniform."""
    n_states, n_actions, branching = 40, 100, 2
    kernel = garnet(n_states, n_actions, branching, np.random.default_rng(1)).transitions
    counts = (kernel > 0).sum(axis=(0, 1))
    law = binom(n_states * n_actions, branching / n_states)
    tails = np.minimum(law.cdf(counts), law.sf(counts - 1))
    assert tails.min() > FAILURE / (2 * n_states)
    first_gap = kernel.max(axis=2, where=np.cumsum(kernel > 0, axis=2) == 1, initial=0)
    assert kstest(first_gap.ravel(), "uniform").pvalue > FAILURE


def test_garnet_depends_on_its_generator_only():
    same = [garnet(5, 2, 3, np.random.default_rng(7)) for _ in range(2)]
    other = garnet(5, 2, 3, np.random.default_rng(8))
    assert np.array_equal(same[0].transitions, same[1].transitions)
    assert np.array_equal(same[0].reward, same[1].reward)
    assert not np.array_equal(same[0].transitions, other.transitions)


def test_chain_pays_at_the_end_after_a_whole_row_of_steps():
    """With H = n and no slip, ``forward`` throughout earns 10 once, ``back`` throughout 2 in each step."""
    n = 6
    mdp = chain(n, slip=0.0, horizon=n)
    law, earned = mdp.initial, {0: 0.0, 1: 0.0}
    for action in earned:
        law = mdp.initial
        for _ in range(n):
            earned[action] += float(law @ mdp.expected_reward[:, action])
            law = law @ mdp.transitions[:, action]
    assert earned == {0: 10.0, 1: 2.0 * n}


def test_chain_slips_to_the_other_action():
    mdp, sure = chain(4, slip=0.3), chain(4, slip=0.0)
    assert mdp.transitions == pytest.approx(0.7 * sure.transitions + 0.3 * sure.transitions[:, ::-1])


def test_cliff_falls_cost_and_lead_back_and_the_goal_absorbs():
    mdp = cliff(3, 4, slip=0.0, fall=-7.0)
    right, up = mdp.action_names.index("right"), mdp.action_names.index("up")
    start, fallen, goal = 8, 9, 11
    assert mdp.layout == ("....", "....", "SCCG")
    assert mdp.transitions[start, right, fallen] == 1
    assert mdp.reward[[start, fallen, goal]].tolist() == [-1, -7, 0]
    assert (mdp.transitions[fallen, :, start] == 1).all()
    assert (mdp.transitions[goal, :, goal] == 1).all()
    assert mdp.transitions[0, up, 0] == 1
    path = [up, right, right, right, mdp.action_names.index("down")]
    state = start
    for action in path:
        state = int(mdp.transitions[state, action].argmax())
    assert state == goal


def test_cliff_slip_is_a_uniform_move():
    sure, slippery = cliff(slip=0.0), cliff(slip=0.2)
    free = np.array([c in ".S" for row in sure.layout for c in row])
    expected = 0.8 * sure.transitions + 0.2 * sure.transitions.mean(axis=1, keepdims=True)
    assert slippery.transitions[free] == pytest.approx(expected[free])


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (
            lambda: garnet(3, 2, 4, np.random.default_rng(0)),
            "branching is 4, expected at most the number of states, 3.",
        ),
        (lambda: garnet(0, 2, 1, np.random.default_rng(0)), "n_states is 0, expected a whole number of at least 1."),
        (lambda: garnet(3, 2.5, 1, np.random.default_rng(0)), "n_actions is 2.5, expected a whole number"),
        (lambda: garnet(3, 2, 1, 0), "rng is 0, expected a numpy Generator"),
        (lambda: chain(1), "n_states is 1, expected a whole number of at least 2."),
        (lambda: chain(slip=1.5), "slip is 1.5, expected a probability between 0 and 1."),
        (lambda: chain(slip=float("nan")), "slip is nan"),
        (lambda: chain(slip="x"), "slip is 'x'"),
        (lambda: chain(horizon=0), "horizon is 0"),
        (lambda: chain(horizon=True), "horizon is True"),
        (lambda: cliff(n_columns=2), "n_columns is 2, expected a whole number of at least 3."),
        (lambda: cliff(fall=float("nan")), "reward has a value that is not finite"),
        (lambda: make_mdp("stardmp"), "no environment 'stardmp' (did you mean 'starmdp'?); expected one of chain,"),
        (lambda: make_mdp("xyzzy"), "no environment 'xyzzy'; expected one of chain,"),
        (lambda: make_mdp("starmdp", n_states=3), "starmdp has no option 'n_states'; its options are horizon."),
        (lambda: make_mdp("starmdp", horizon=0), "horizon is 0"),
        (lambda: make_mdp("garnet", seed=-1), "seed is -1, expected a whole number of at least 0."),
        (lambda: make_mdp("garnet", seed=None), "seed is None"),
    ],
)
def test_bad_arguments_get_one_sentence(call, sentence):
    with pytest.raises(InputError) as caught:
        call()
    assert sentence in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", mdp_names())
def test_every_name_makes_a_valid_mdp_and_takes_a_horizon(name):
    mdp = make_mdp(name.upper(), horizon=3)
    assert mdp.horizon == 3
    assert mdp.transitions.sum(axis=2) == pytest.approx(1)
    assert len(set(mdp.state_names)) == mdp.n_states


def test_garnet_by_name_takes_a_seed():
    first, again, other = (make_mdp("garnet", n_states=6, seed=seed).transitions for seed in (3, 3, 4))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
