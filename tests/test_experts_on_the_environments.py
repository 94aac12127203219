"""Experts of the paper's environments and of ones that we did not write, with their certified optima."""

import numpy as np
import pytest

from bridge_algos.envs.registry import make_mdp
from bridge_algos.evaluation import expected_returns
from bridge_algos.expert import KINDS, branch_and_bound, make_expert
from bridge_algos.policies import all_policies

# Best stationary deterministic and best time-dependent return.
OPTIMA = {
    "starmdp": (46.09662542999999, 46.10571632999999),
    "gridworld": (34.22704465411132, 34.228998769892286),
    "frozenlake": (0.7401648977587051, 0.7441902878292697),
    "cliffwalking": (-13.0, -13.0),
}


@pytest.mark.parametrize("name", OPTIMA)
@pytest.mark.parametrize("kind", KINDS)
def test_every_expert_is_certified(name, kind):
    stationary, time_dependent = OPTIMA[name]
    expert = make_expert(make_mdp(name), kind)
    assert expert.status == "optimal"
    assert expert.best_stationary.optimal
    assert expert.best_stationary.value == pytest.approx(stationary, rel=1e-12)
    assert expert.best_time_dependent == pytest.approx(time_dependent, rel=1e-12)
    # The published runs' discounted expert is a maximiser of the evaluation score here.
    assert expert.is_maximiser
    expected = time_dependent if kind == "finite-horizon-lp" else stationary
    assert expert.expected_return == pytest.approx(expected, rel=1e-12)


def test_starmdp_is_settled_by_all_its_policies():
    mdp = make_mdp("starmdp")
    returns = expected_returns(mdp, all_policies(5, 4))
    assert returns.size == 1024
    assert np.max(returns) == pytest.approx(OPTIMA["starmdp"][0], rel=1e-12)
    assert branch_and_bound(mdp).value == pytest.approx(np.max(returns), rel=1e-12)


def test_the_discounted_expert_of_a_larger_lake_is_not_the_maximiser():
    expert = make_expert(make_mdp("frozenlake8x8"), "discounted-lp")
    assert expert.best_stationary.optimal
    assert not expert.is_maximiser
    assert expert.gap_to_stationary == pytest.approx(0.893568385974862 - 0.8629553799611125, abs=1e-6)
    assert "not the maximiser of the evaluation score, the gap is 0.0306" in expert.describe()
