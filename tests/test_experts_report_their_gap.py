"""Every expert states its evaluation score, and that it is not the maximiser where it is not."""

import subprocess
import sys

import pytest
from hypothesis import given, settings
from random_mdps import parting_gift, random_mdps

from bridge_algos.expert import KINDS, branch_and_bound, experts, make_expert
from bridge_theory.errors import InputError


def test_a_discounted_expert_is_not_always_the_maximiser():
    expert = make_expert(parting_gift(), "discounted-lp")
    assert expert.policy.tolist() == [0, 0]
    assert (expert.expected_return, expert.gap_to_stationary, expert.gap_to_time_dependent) == pytest.approx((3, 2, 4))
    assert expert.objective == pytest.approx(100)
    assert not expert.is_maximiser
    assert "not the maximiser of the evaluation score, the gap is 2" in expert.describe()
    assert "discount 0.99" in expert.describe()


def test_a_time_dependent_expert_can_be_better_than_every_stationary_policy():
    expert = make_expert(parting_gift(), "finite-horizon-lp")
    assert expert.policy[:, 0].tolist() == [0, 0, 1]
    assert (expert.expected_return, expert.gap_to_stationary, expert.gap_to_time_dependent) == pytest.approx((7, -2, 0))
    assert expert.is_maximiser


def test_the_best_stationary_expert_is_the_maximiser():
    expert = make_expert(parting_gift(), "best-stationary")
    assert expert.policy.tolist() == [1, 0]
    assert (expert.expected_return, expert.gap_to_stationary, expert.gap_to_time_dependent) == pytest.approx((5, 0, 2))
    assert (expert.is_maximiser, expert.status, expert.certificate) == (True, "optimal", None)


@pytest.mark.parametrize("kind", ["discounted-lp", "best-stationary"])
def test_an_unfinished_search_never_makes_a_maximiser(monkeypatch, kind):
    monkeypatch.setattr(experts, "best_stationary", lambda mdp: branch_and_bound(mdp, node_limit=1))
    expert = make_expert(parting_gift(), kind)
    assert not expert.is_maximiser
    assert "not certified as optimal" in expert.describe()
    assert expert.status == ("node limit" if kind == "best-stationary" else "optimal")


@settings(derandomize=True, deadline=None, max_examples=40)
@given(mdp=random_mdps())
def test_gaps_are_those_of_the_returns(mdp):
    made = {kind: make_expert(mdp, kind) for kind in KINDS}
    best = made["best-stationary"].expected_return
    for expert in made.values():
        assert expert.gap_to_stationary == pytest.approx(best - expert.expected_return, abs=expert.tolerance)
        assert expert.gap_to_time_dependent >= -expert.tolerance
        assert expert.is_maximiser == (expert.expected_return >= best - 1e-9)
        assert ("not the maximiser" in expert.describe()) != expert.is_maximiser
    assert made["finite-horizon-lp"].expected_return >= best - 1e-9


def test_an_unknown_kind_is_refused():
    with pytest.raises(InputError, match="the expert kind is 'optimal', expected one of discounted-lp, "):
        make_expert(parting_gift(), "optimal")


def test_importing_experts_loads_no_solver():
    heavy = "{'cvxpy', 'scipy.sparse', 'torch', 'gymnasium', 'matplotlib'}"
    code = f"import bridge_algos.expert, sys; sys.exit(bool({heavy} & set(sys.modules)))"
    subprocess.run([sys.executable, "-c", code], check=True)
