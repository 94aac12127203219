"""A solver's answer counts for what its numbers show: wrong ones are refused, whatever the solver claims."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_mdps import random_mdp, random_mdps
from sympy import Matrix, Rational, eye

from bridge_algos.evaluation import rounding_allowance
from bridge_algos.expert import SolverError, backward_induction, experts, linear_program, make_expert
from bridge_algos.expert.certificate import certify_finite_horizon
from bridge_algos.expert.linear_program import finite_horizon_program, solve_program
from bridge_theory.errors import InputError

MDP = random_mdp(seed=6, n_states=5, n_actions=3, horizon=4)
KINDS = ("finite-horizon-lp", "discounted-lp")


def other_actions(solution):
    return replace(solution, occupancy=np.roll(solution.occupancy, 1, axis=-1))


def more_occupancy(solution):
    return replace(solution, occupancy=1.001 * solution.occupancy)


def negative_occupancy(solution):
    return replace(solution, occupancy=solution.occupancy - 1e-3)


def lower_values(solution):
    return replace(solution, values=solution.values - 1e-2)


def raised_start(solution):
    values = solution.values.copy()
    values[(0, 0) if values.ndim == 2 else 0] += 1e-3
    return replace(solution, values=values)


def no_numbers(solution):
    return replace(solution, values=np.full_like(solution.values, np.nan))


def other_objective(solution):
    return replace(solution, objective=solution.objective + 1e-3)


CORRUPTIONS = {
    other_actions: "primal-dual gap",
    more_occupancy: "primal infeasibility",
    negative_occupancy: "primal infeasibility",
    lower_values: "dual infeasibility",
    raised_start: "primal-dual gap",
    no_numbers: "not finite",
    other_objective: "claimed objective",
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("corruption", CORRUPTIONS, ids=lambda corruption: corruption.__name__)
def test_corrupted_answers_are_refused(monkeypatch, kind, corruption):
    make_expert(MDP, kind)
    monkeypatch.setattr(
        experts, "solve_program", lambda program, solver: corruption(linear_program.solve_program(program, solver))
    )
    with pytest.raises(SolverError, match=CORRUPTIONS[corruption]):
        make_expert(MDP, kind)


@pytest.mark.parametrize(("kind", "routine"), [(KINDS[0], "backward_induction"), (KINDS[1], "policy_iteration")])
def test_dynamic_programming_must_agree(monkeypatch, kind, routine):
    correct = getattr(experts, routine)

    def too_low(*arguments):
        policy, values = correct(*arguments)
        return policy, values - 1e-6

    monkeypatch.setattr(experts, routine, too_low)
    with pytest.raises(SolverError, match="dynamic programming"):
        make_expert(MDP, kind)


@settings(derandomize=True, deadline=None, max_examples=40)
@given(mdp=random_mdps(), seed=st.integers(0, 1000))
def test_an_inaccurate_answer_still_encloses_the_optimum(mdp, seed):
    """Infeasibility within tolerance is repaired and accounted for, never counted as quality."""
    rng = np.random.default_rng(seed)
    program = finite_horizon_program(mdp)
    solution = solve_program(program, "HIGHS")
    noisy = replace(solution, values=solution.values + rng.uniform(-5e-8, 5e-8, size=solution.values.shape))
    policy, values = backward_induction(mdp)
    optimum = float(mdp.initial @ values[0])
    certificate = certify_finite_horizon(mdp, program, noisy, policy, optimum)
    assert certificate.lower <= optimum <= certificate.upper
    # The repair costs at most the largest violation a step.
    unrepaired = float(mdp.initial @ noisy.values[0])
    repair = mdp.horizon * certificate.dual_infeasibility
    assert certificate.upper <= unrepaired + repair + 4 * rounding_allowance(mdp)


def rational(array) -> list:
    return [rational(row) for row in array] if np.ndim(array) else Rational(*float(array).as_integer_ratio())


def rational_model(mdp):
    """Initial law, (S, A) rewards as matrices by action, and kernels by action, in rationals."""
    actions = range(mdp.n_actions)
    kernels = [Matrix(rational(mdp.transitions[:, action])) for action in actions]
    if mdp.reward.ndim == 1:
        rewards = [kernel * Matrix(rational(mdp.reward)) for kernel in kernels]
    elif mdp.reward.ndim == 2:
        rewards = [Matrix(rational(mdp.reward[:, action])) for action in actions]
    else:
        paid = [Matrix(rational(mdp.reward[:, action])) for action in actions]
        ones = Matrix([1] * mdp.n_states)
        rewards = [kernel.multiply_elementwise(pay) * ones for kernel, pay in zip(kernels, paid, strict=True)]
    return Matrix(rational(mdp.initial)).T, rewards, kernels


@settings(derandomize=True, deadline=None, max_examples=20)
@given(mdp=random_mdps(max_states=3, max_horizon=4))
def test_the_enclosure_holds_in_exact_arithmetic(mdp):
    initial, rewards, kernels = rational_model(mdp)
    values = Matrix([0] * mdp.n_states)
    for _ in range(mdp.horizon):
        backups = [reward + kernel * values for reward, kernel in zip(rewards, kernels, strict=True)]
        values = Matrix([max(column) for column in zip(*backups, strict=True)])
    optimum = (initial * values)[0]
    certificate = make_expert(mdp, "finite-horizon-lp").certificate
    assert Rational(certificate.lower) <= optimum <= Rational(certificate.upper)


@settings(derandomize=True, deadline=None, max_examples=20)
@given(mdp=random_mdps(max_states=3), discount=st.sampled_from((0.5, 0.99, 0.99999)))
def test_the_discounted_enclosure_holds_in_exact_arithmetic(mdp, discount):
    initial, rewards, kernels = rational_model(mdp)
    expert = make_expert(mdp, "discounted-lp", discount=discount)
    states = range(mdp.n_states)
    kernel = Matrix([kernels[expert.policy[state]].row(state) for state in states])
    reward = Matrix([rewards[expert.policy[state]][state] for state in states])
    own = (initial * (eye(mdp.n_states) - rational(discount) * kernel).LUsolve(reward))[0]
    assert Rational(expert.certificate.lower) <= own <= Rational(expert.certificate.upper)


@pytest.mark.parametrize(
    ("solver", "limits", "status"),
    [("SCS", {"max_iters": 1}, "optimal_inaccurate"), ("OSQP", {"max_iter": 1}, "user_limit")],
)
def test_any_status_but_optimal_is_an_error(monkeypatch, solver, limits, status):
    monkeypatch.setitem(linear_program.ACCURACY, solver, limits)
    with pytest.raises(SolverError, match=f"status '{status}', expected 'optimal'"):
        make_expert(MDP, "finite-horizon-lp", solver=solver)


def test_a_solver_that_is_not_installed_is_one_sentence():
    with pytest.raises(
        InputError, match=r"the solver 'NOSUCH' is not installed; expected one of .*HIGHS.*\.$"
    ) as refusal:
        make_expert(MDP, "discounted-lp", solver="NOSUCH")
    assert "\n" not in str(refusal.value)
