"""The best stationary deterministic policy is the best of all, and no more is claimed than was certified."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_mdps import contested_mdp, parting_gift, random_mdp, random_mdps

from bridge_algos.evaluation import expected_return, expected_returns
from bridge_algos.expert import backward_induction, best_stationary, branch_and_bound, enumerate_stationary, stationary
from bridge_algos.expert.choices import count_choices, reachable_states, relevant_actions
from bridge_algos.mdp import TabularMDP
from bridge_algos.policies import all_policies
from bridge_theory.errors import InputError


@settings(derandomize=True, deadline=None, max_examples=80)
@given(mdp=random_mdps(max_states=5, scales=(1e-6, 1.0)))
def test_enumeration_and_branch_and_bound_equal_all_policies(mdp):
    returns = expected_returns(mdp, all_policies(mdp.n_states, mdp.n_actions))
    for found in (enumerate_stationary(mdp), branch_and_bound(mdp)):
        assert found.optimal
        assert found.value == pytest.approx(expected_return(mdp, found.policy), abs=found.tolerance)
        assert returns.max() - found.tolerance <= found.value
        assert returns.max() <= found.upper


def test_branching_finds_what_rounding_misses():
    missed = 0
    for seed in range(80):
        mdp = contested_mdp(seed)
        best, found = enumerate_stationary(mdp), branch_and_bound(mdp)
        assert found.optimal
        assert found.value == pytest.approx(best.value, abs=found.tolerance)
        missed += branch_and_bound(mdp, node_limit=1).value < best.value - best.tolerance
    assert missed >= 5


@settings(derandomize=True, deadline=None, max_examples=60)
@given(seed=st.integers(0, 10**6), node_limit=st.integers(1, 60))
def test_what_is_claimed_holds_wherever_the_search_stops(seed, node_limit):
    mdp = contested_mdp(seed, n_states=6)
    best = enumerate_stationary(mdp).value
    found = branch_and_bound(mdp, node_limit)
    assert found.evaluations <= node_limit
    assert found.value - found.tolerance <= best <= found.upper
    if found.optimal:
        assert found.value >= best - found.tolerance


def test_the_limit_is_used_up_to_the_last_affordable_node():
    mdp = contested_mdp(seed=10, n_states=8)
    needed = branch_and_bound(mdp).evaluations
    assert needed > 1
    assert branch_and_bound(mdp, needed).optimal
    assert not branch_and_bound(mdp, needed - 1).optimal


def test_a_stopped_search_says_so():
    found = branch_and_bound(parting_gift(), node_limit=1)
    assert not found.optimal
    assert found.upper == pytest.approx(7)
    assert "not certified as optimal" in found.describe()
    assert f"leaves a gap of {found.gap:.3g}" in found.describe()
    certified = branch_and_bound(parting_gift())
    assert certified.optimal
    assert certified.value == 5
    assert "not certified" not in certified.describe()


def test_many_policies_are_searched_without_enumeration():
    mdp = random_mdp(seed=42 * 30, n_states=20, n_actions=4, horizon=10)
    assert count_choices(relevant_actions(mdp)) > stationary.ENUMERATION_LIMIT
    found = best_stationary(mdp)
    assert found.method == "branch and bound"
    assert found.optimal
    assert found.value <= mdp.initial @ backward_induction(mdp)[1][0] + found.tolerance
    # No single change of an action improves it.
    neighbours = np.repeat(found.policy[None], 80, axis=0)
    neighbours[np.arange(80), np.arange(80) // 4] = np.arange(80) % 4
    assert expected_returns(mdp, neighbours).max() <= found.upper
    with pytest.raises(InputError, match="use branch_and_bound"):
        enumerate_stationary(mdp)


def test_the_search_repeats_itself():
    mdp = random_mdp(seed=42 * 30, n_states=20, n_actions=4, horizon=10)
    first, second = branch_and_bound(mdp), branch_and_bound(mdp)
    assert first.evaluations == second.evaluations
    assert (first.policy == second.policy).all()


def test_choices_that_cannot_matter_are_not_counted():
    # State 2 is out of reach; in state 1 both actions do the same; state 3 is reached only after the last action.
    transitions = np.zeros((4, 2, 4))
    transitions[0, 0, 0] = transitions[0, 1, 1] = transitions[1, :, 3] = transitions[2, :, 0] = transitions[3, 0, 0] = 1
    transitions[3, 1, 3] = 1
    mdp = TabularMDP(transitions, initial=[1, 0, 0, 0], horizon=2, reward=[0, 1, 0, 2], reward_on="arrival")
    assert reachable_states(mdp).tolist() == [True, True, False, False]
    assert relevant_actions(mdp).sum(axis=1).tolist() == [2, 1, 1, 1]
    assert enumerate_stationary(mdp).evaluations == 2
    longer = TabularMDP(transitions, initial=[1, 0, 0, 0], horizon=3, reward=[0, 1, 0, 2], reward_on="arrival")
    assert reachable_states(longer).tolist() == [True, True, False, True]


def test_ties_in_enumeration_go_to_the_first_policy():
    mdp = TabularMDP(
        [[[0, 1], [1, 0]], [[1, 0], [0, 1]]], initial=[1, 0], horizon=3, reward=[1, 1], axes="state-action"
    )
    assert enumerate_stationary(mdp).policy.tolist() == [0, 0]


@pytest.mark.parametrize("node_limit", [0, -3])
def test_a_node_limit_below_one_is_refused(node_limit):
    with pytest.raises(InputError, match=r"node_limit is .* expected a whole number of at least 1"):
        branch_and_bound(parting_gift(), node_limit)
