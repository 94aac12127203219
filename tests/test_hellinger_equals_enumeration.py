"""The Hellinger recursion equals the sum over all trajectories, exactly in rationals."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from conftest import random_dynamics
from hypothesis import given
from hypothesis import strategies as st

from bridge_algos.hellinger import bhattacharyya, disagreement_probability, squared_hellinger
from bridge_algos.hellinger_exact import (
    enumerated_bhattacharyya,
    exact_bhattacharyya,
    exact_sqrt,
    trajectory_law,
)
from bridge_algos.mdp import Dynamics
from bridge_algos.policies import all_policies
from bridge_theory.errors import InputError

# rows whose entries are squares of rationals, so that every root is rational
SQUARE_ROWS = [
    (Fraction(9, 25), Fraction(16, 25)),
    (Fraction(16, 25), Fraction(9, 25)),
    (Fraction(25, 169), Fraction(144, 169)),
    (Fraction(1), Fraction(0)),
    (Fraction(0), Fraction(1)),
]
rows = st.sampled_from(SQUARE_ROWS)
stochastic_policies = st.tuples(rows, rows)
kernels = st.tuples(st.tuples(rows, rows), st.tuples(rows, rows))
starts = st.integers(0, 7).map(lambda k: (Fraction(k, 7), Fraction(7 - k, 7)))


def as_floats(kernel: object) -> np.ndarray:
    return np.array(kernel, dtype=float)


@given(starts, st.integers(1, 4), kernels, kernels, stochastic_policies, stochastic_policies)
def test_recursion_equals_enumeration_in_rationals(start, horizon, kernel1, kernel2, policy1, policy2) -> None:
    recursion = exact_bhattacharyya(start, horizon, (kernel1, kernel2), (policy1, policy2))
    laws = [trajectory_law(start, horizon, k, p) for k, p in ((kernel1, policy1), (kernel2, policy2))]
    assert all(sum(each.values()) == 1 for each in laws)
    assert recursion == enumerated_bhattacharyya(*laws)
    first, second = (Dynamics(as_floats(k), as_floats(start), horizon) for k in (kernel1, kernel2))
    estimate = bhattacharyya(first, as_floats(policy1), second, as_floats(policy2))
    assert estimate == pytest.approx(float(recursion), abs=1e-13)


@given(st.integers(0, 10**6), st.integers(1, 5))
def test_deterministic_policies_under_one_kernel(seed: int, horizon: int) -> None:
    dynamics = random_dynamics(np.random.default_rng(seed), 3, 2, horizon)
    policies = all_policies(3, 2)
    center = policies[seed % 8]
    fast = disagreement_probability(dynamics, center, (policies != center).astype(float))
    slow = [squared_hellinger(dynamics, center, dynamics, p) for p in policies]
    np.testing.assert_allclose(fast, slow, atol=1e-12)
    assert fast[seed % 8] == 0.0


def test_the_papers_matrix_without_transposition_is_wrong() -> None:
    """Two states 0 -> 1 -> 1, policies equal: the printed X_1 = M X_0 gives H^2 = 1, the truth is 0 (audit K5)."""
    move = np.array([[0.0, 1.0], [0.0, 1.0]])
    dynamics = Dynamics(move[:, None, :], np.array([1.0, 0.0]), 2)
    assert squared_hellinger(dynamics, [0, 0], dynamics, [0, 0]) == 0.0
    assert 1 - (move @ dynamics.initial).sum() == 1.0


def test_time_dependent_kernels(rng: np.random.Generator) -> None:
    first, second = (random_dynamics(rng, 2, 2, 3) for _ in range(2))
    kernels1 = np.stack([first.transitions, second.transitions])
    kernels2 = np.stack([second.transitions, first.transitions])
    start = first.initial
    one, two = Dynamics(kernels1, start, 3), Dynamics(kernels2, start, 3)
    policy = np.full((2, 2), 0.5)
    brute = 0.0
    for path in product(range(2), repeat=5):
        s1, a1, s2, a2, s3 = path
        p = [start[s1] * 0.25 * k[0][s1, a1, s2] * k[1][s2, a2, s3] for k in (kernels1, kernels2)]
        brute += np.sqrt(p[0] * p[1])
    assert bhattacharyya(one, policy, two, policy) == pytest.approx(brute, abs=1e-12)


def test_irrational_roots_and_unequal_sizes_are_refused(rng: np.random.Generator) -> None:
    with pytest.raises(InputError, match="not rational"):
        exact_sqrt(Fraction(1, 2))
    with pytest.raises(InputError, match="different size"):
        bhattacharyya(random_dynamics(rng, 2, 2, 3), [0, 0], random_dynamics(rng, 2, 2, 4), [0, 0])


def test_a_kernel_by_step_has_one_kernel_for_each_transition(rng: np.random.Generator) -> None:
    kernel, start = random_dynamics(rng, 2, 2, 3).transitions, np.array([1.0, 0.0])
    for steps in (1, 3):
        with pytest.raises(InputError, match=rf"has {steps} steps, expected H - 1 = 2"):
            Dynamics(np.stack([kernel] * steps), start, 3)
    with pytest.raises(InputError, match=r" with 3 or 4 axes, got float64 of shape \(2, 2\)"):
        Dynamics(np.eye(2), start, 3)
    assert Dynamics(np.stack([kernel] * 2), start, 3).n_actions == 2
