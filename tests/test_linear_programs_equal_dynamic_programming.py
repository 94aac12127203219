"""Backward induction, policy iteration and the linear programs find the same optima, and certify them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_mdps import parting_gift, random_mdp, random_mdps

from bridge_algos.evaluation import expected_return, rounding_allowance
from bridge_algos.expert import backward_induction, make_expert, policy_iteration
from bridge_algos.expert.dynamic_programming import discounted_values
from bridge_algos.expert.linear_program import discounted_program, finite_horizon_program, solve_program
from bridge_algos.mdp import TabularMDP
from bridge_algos.policies import all_policies
from bridge_theory.errors import InputError

SCALES = (1e-8, 1.0, 1e8)


@settings(derandomize=True, deadline=None, max_examples=60)
@given(mdp=random_mdps(scales=SCALES))
def test_finite_horizon(mdp):
    expert = make_expert(mdp, "finite-horizon-lp")
    policy, values = backward_induction(mdp)
    optimum = mdp.initial @ values[0]
    certificate = expert.certificate
    assert certificate.lower <= optimum <= certificate.upper
    assert certificate.gap <= 1e-9 * mdp.horizon * max(np.abs(mdp.reward).max(), 1e-300) + 4 * rounding_allowance(mdp)
    assert expert.objective == expert.expected_return == expected_return(mdp, expert.policy)
    assert abs(expert.gap_to_time_dependent) <= certificate.gap
    assert optimum - expected_return(mdp, policy) <= 1e-12 * mdp.horizon * np.abs(values).max()


@settings(derandomize=True, deadline=None, max_examples=60)
@given(mdp=random_mdps(scales=SCALES), discount=st.sampled_from((0.0, 0.5, 0.9, 0.99, 0.999)))
def test_discounted(mdp, discount):
    expert = make_expert(mdp, "discounted-lp", discount=discount)
    _, values = policy_iteration(mdp, discount)
    assert expert.certificate.lower <= mdp.initial @ values <= expert.certificate.upper
    assert expert.objective == pytest.approx(mdp.initial @ values, rel=1e-9, abs=1e-9 * np.abs(values).max())
    assert expert.policy.shape == (mdp.n_states,)


@settings(derandomize=True, deadline=None, max_examples=30)
@given(mdp=random_mdps(max_states=4), discount=st.sampled_from((0.0, 0.9, 0.99)))
def test_policy_iteration_is_best_in_every_state(mdp, discount):
    _, values = policy_iteration(mdp, discount)
    policies = all_policies(mdp.n_states, mdp.n_actions)
    best = np.max([discounted_values(mdp, policy, discount) for policy in policies], axis=0)
    np.testing.assert_allclose(values, best, rtol=1e-10, atol=1e-10 * np.abs(best).max())


@settings(derandomize=True, deadline=None, max_examples=30)
@given(mdp=random_mdps(), discount=st.sampled_from((0.0, 0.9, 0.99)))
def test_the_answer_is_feasible_and_complementary(mdp, discount):
    for program in (finite_horizon_program(mdp), discounted_program(mdp, discount)):
        solution = solve_program(program, "HIGHS")
        occupancy, slack = solution.occupancy.ravel(), program.flow.T @ solution.values.ravel() - program.reward
        assert occupancy.min() >= 0
        assert np.abs(program.flow @ occupancy - program.inflow).max() <= 1e-9
        assert slack.min() >= -1e-9
        assert np.abs(occupancy * slack).max() <= 1e-8
        assert program.inflow @ solution.values.ravel() == pytest.approx(solution.objective, rel=1e-9, abs=1e-9)


def test_ties_go_to_the_lowest_action_even_when_rounding_differs():
    # 0.1 + 0.2 is above 0.3 in binary.
    mdp = TabularMDP([[[1], [1]]], initial=[1], horizon=4, reward=[[0.3, 0.1 + 0.2]])
    assert mdp.reward.argmax() == 1
    assert (backward_induction(mdp)[0] == 0).all()
    assert (policy_iteration(mdp, 0.99)[0] == 0).all()


def test_states_without_occupancy_take_the_action_of_dynamic_programming():
    # State 2 is out of reach, and its second action is the better one.
    transitions = [[[0, 1, 0], [1, 0, 0]], [[0, 1, 0], [1, 0, 0]], [[1, 0, 0], [0, 1, 0]]]
    mdp = TabularMDP(transitions, initial=[1, 0, 0], horizon=3, reward=[0, 1, 0], reward_on="arrival")
    assert make_expert(mdp, "finite-horizon-lp").policy.tolist() == [[0, 0, 1]] * 3
    assert make_expert(mdp, "discounted-lp").policy.tolist() == [0, 0, 1]


@pytest.mark.parametrize("solver", ["HIGHS", "highs", "CLARABEL", "SCS", "SCIPY"])
def test_installed_solvers_agree(solver):
    mdp = random_mdp(seed=4, n_states=6, n_actions=3, horizon=5)
    for kind in ("finite-horizon-lp", "discounted-lp"):
        expert = make_expert(mdp, kind, solver=solver)
        assert expert.solver == solver.upper()
        assert expert.expected_return == pytest.approx(make_expert(mdp, kind).expected_return, rel=1e-12)


@pytest.mark.parametrize("discount", [-0.1, 1.0, 1.5, float("nan")])
def test_a_discount_out_of_range_is_refused(discount):
    with pytest.raises(InputError, match=r"discount is .* expected a number in"):
        make_expert(parting_gift(), "discounted-lp", discount=discount)
