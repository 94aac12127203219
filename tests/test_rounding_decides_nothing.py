"""A round's choices do not depend on the order of floating-point operations; sampling and storing keep every number."""

import numpy as np
import pytest
from conftest import random_dynamics
from hypothesis import given
from hypothesis import strategies as st

from bridge_algos.mdp import TabularMDP
from bridge_algos.online.cholesky import inverse_root, log_det
from bridge_algos.online.memory import Rows
from bridge_algos.online.policy_filter import first_best, surviving, widest_pair
from bridge_algos.policies import random_policies
from bridge_algos.trajectories import sample_each, sample_trajectories
from bridge_theory.errors import ComputationError


@given(st.integers(0, 10**6), st.sampled_from([3, 20, 150]), st.booleans())
def test_ties_are_decided_alike_whatever_the_rounding(seed: int, n: int, with_bonus: bool) -> None:
    """Policies that differ in unreachable states alone have equal features, up to rounding: here copies of a few."""
    rng = np.random.default_rng(seed)
    copies = rng.integers(max(2, n // 5), size=n)
    z = rng.normal(size=(n, 4))[copies]
    bonus, scores = with_bonus * 0.1 * rng.random(n)[copies], rng.normal(size=n)[copies]

    def choices(size: float) -> tuple[int, tuple[int, int], tuple[int, int], list[bool]]:
        def noisy(values: np.ndarray) -> np.ndarray:
            return values + size * rng.uniform(-1, 1, values.shape)

        points, b, s = noisy(z), noisy(bonus), noisy(scores)
        kept = surviving(s + b, s - b, points, 0.3).tolist()
        return first_best(s), widest_pair(points, 0.3, b), widest_pair(points, 0.3, b, s), kept

    exactly = choices(0.0)
    for _ in range(5):
        assert choices(1e-15) == exactly


@given(st.integers(0, 10**6), st.integers(1, 4), st.integers(1, 12))
def test_a_batch_of_policies_draws_what_one_after_another_draws(seed: int, m: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    dynamics = random_dynamics(rng, 5, 3, 6)
    mdp = TabularMDP(dynamics.transitions, dynamics.initial, 6, rng.normal(size=(5, 3, 5)))
    policies = random_policies(m, 5, 3, rng)
    together, one_by_one = np.random.default_rng(seed), np.random.default_rng(seed)
    batch = sample_each(mdp, policies, n, together)
    for i, policy in enumerate(policies):
        alone = sample_trajectories(mdp, policy, n, one_by_one)
        part = batch[i * n : (i + 1) * n]
        for name in ("states", "actions", "rewards"):
            np.testing.assert_array_equal(getattr(part, name), getattr(alone, name))
    assert together.random() == one_by_one.random()


def test_rows_grow_and_earlier_views_stay(rng: np.random.Generator) -> None:
    rows, blocks = Rows(3), [rng.normal(size=(k, 3)) for k in (1, 0, 70, 5, 300, 1)]
    views = []
    for block in blocks:
        rows.append(block)
        views.append((rows.values, rows.values.copy()))
    np.testing.assert_array_equal(rows.values, np.concatenate(blocks))
    for view, then in views:
        np.testing.assert_array_equal(view, then)


def test_the_inverse_root_gives_norms_and_determinant(rng: np.random.Generator) -> None:
    half = rng.normal(size=(6, 6))
    matrix = np.eye(6) + half @ half.T
    inverse, x = inverse_root(matrix), rng.normal(size=6)
    assert np.linalg.norm(inverse @ x) == pytest.approx(np.sqrt(x @ np.linalg.solve(matrix, x)), rel=1e-12)
    assert log_det(inverse) == pytest.approx(np.linalg.slogdet(matrix)[1], rel=1e-12)
    with pytest.raises(ComputationError, match="larger lambda"):
        inverse_root(np.diag([1.0, -1.0]))
