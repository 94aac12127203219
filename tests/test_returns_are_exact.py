"""Expected returns are those of the definition, to within the stated rounding error."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from random_mdps import parting_gift, random_mdp, random_mdps

from bridge_algos.evaluation import expected_return, expected_returns, rounding_allowance
from bridge_algos.mdp import TabularMDP
from bridge_algos.occupancy import BLOCK
from bridge_algos.policies import action_probabilities, random_policies
from bridge_theory.errors import InputError


def rational_return(mdp: TabularMDP, policy) -> Fraction:
    """The sum over all paths of states and actions, in rationals: the definition, with no recursion."""
    chosen = action_probabilities(policy, mdp.n_states, mdp.n_actions, mdp.horizon)
    reward = np.broadcast_to(
        mdp.reward if mdp.reward.ndim != 2 else mdp.reward[:, :, None], (mdp.n_states, mdp.n_actions, mdp.n_states)
    )
    total = Fraction(0)
    for start in range(mdp.n_states):
        for path in product(product(range(mdp.n_actions), range(mdp.n_states)), repeat=mdp.horizon):
            probability, paid, state = Fraction(float(mdp.initial[start])), Fraction(0), start
            for h, (action, following) in enumerate(path):
                probability *= Fraction(float(chosen[h, state, action]))
                probability *= Fraction(float(mdp.transitions[state, action, following]))
                paid += Fraction(float(reward[state, action, following]))
                state = following
            total += probability * paid
    return total


@settings(derandomize=True, deadline=None, max_examples=25)
@given(mdp=random_mdps(max_states=3, max_actions=2, max_horizon=3, scales=(1e-6, 1.0, 1e6)))
def test_a_return_is_the_expectation_over_all_paths(mdp):
    rng = np.random.default_rng(mdp.n_states)
    policies = (
        random_policies(1, mdp.n_states, mdp.n_actions, rng)[0],
        rng.integers(mdp.n_actions, size=(mdp.horizon, mdp.n_states)),
        rng.dirichlet(np.ones(mdp.n_actions), size=(mdp.horizon, mdp.n_states)),
    )
    for policy in policies:
        error = abs(Fraction(expected_return(mdp, policy)) - rational_return(mdp, policy))
        assert error <= rounding_allowance(mdp)


def test_the_rounding_allowance_covers_a_long_horizon():
    mdp = TabularMDP([[[1]]], initial=[1], horizon=1000, reward=[0.1])
    error = abs(Fraction(expected_return(mdp, [0])) - 1000 * Fraction(0.1))
    assert 1e-13 < error <= rounding_allowance(mdp)


def test_the_rounding_allowance_is_small():
    mdp = random_mdp(seed=3, n_states=16, n_actions=5, horizon=10)
    assert 0 < rounding_allowance(mdp) < 1e-12 * mdp.horizon * np.abs(mdp.reward).max()


@settings(derandomize=True, deadline=None, max_examples=25)
@given(mdp=random_mdps())
def test_a_batch_agrees_with_one_at_a_time(mdp):
    policies = random_policies(20, mdp.n_states, mdp.n_actions, np.random.default_rng(0))
    single = [expected_return(mdp, policy) for policy in policies]
    assert np.abs(expected_returns(mdp, policies) - single).max() <= 2 * rounding_allowance(mdp)


def test_batches_longer_than_a_block_keep_their_order():
    mdp = random_mdp(seed=11, n_states=5, n_actions=3, horizon=4)
    policies = random_policies(2 * BLOCK + 7, 5, 3, np.random.default_rng(0))
    returns = expected_returns(mdp, policies)
    for i in (0, BLOCK - 1, BLOCK, 2 * BLOCK + 6):
        assert returns[i] == pytest.approx(expected_return(mdp, policies[i]), rel=1e-13)
    assert expected_returns(mdp, policies[:0]).shape == (0,)


@pytest.mark.parametrize("policies", [[0, 1], [[0, 1, 0]], [[0.0, 1.0]], [[0, 2]], [[0, -1]]])
def test_policies_that_do_not_fit_are_refused(policies):
    with pytest.raises(InputError, match="expected"):
        expected_returns(parting_gift(), policies)
