"""The weights are the optimum of the regularised likelihood, and the projection lowers its objective in the ball."""

import numpy as np
import pytest
import scipy.optimize
from hypothesis import given
from hypothesis import strategies as st

from bridge_algos.online.oracles import sigmoid
from bridge_algos.online.preference_model import fit_adam, fit_exact, project, projection_error
from bridge_theory.errors import InputError


def problem(seed: int, m: int, d: int, scale: float = 1.0):
    rng = np.random.default_rng(seed)
    x = scale * rng.normal(size=(m, d))
    return x, (rng.random(m) < sigmoid(x @ rng.normal(size=d))).astype(float)


@given(st.integers(0, 10**6), st.integers(0, 40), st.integers(1, 8), st.sampled_from([1e-3, 1.0, 50.0]))
def test_exact_fit_has_no_gradient_left(seed: int, m: int, d: int, scale: float) -> None:
    x, outcomes = problem(seed, m, d, scale)
    w = fit_exact(x, outcomes, 0.5, np.zeros(d))
    gradient = x.T @ (sigmoid(x @ w) - outcomes) + 0.5 * w
    assert np.abs(gradient).max() <= 1e-8 * (1 + np.abs(x).sum())
    again = fit_exact(x, outcomes, 0.5, np.full(d, 3.0))
    np.testing.assert_allclose(w, again, atol=1e-6 * (1 + np.abs(w).max()))


def test_exact_fit_equals_scipy() -> None:
    x, outcomes = problem(1, 30, 5)
    loss = scipy.optimize.minimize(
        lambda w: (np.logaddexp(0, x @ w) - outcomes * (x @ w)).sum() + 0.5 * w @ w, np.zeros(5), tol=1e-12
    )
    np.testing.assert_allclose(fit_exact(x, outcomes, 1.0, np.zeros(5)), loss.x, atol=1e-5)


def test_adam_converges_to_the_same_optimum_when_it_may() -> None:
    x, outcomes = problem(2, 30, 4)
    exact = fit_exact(x, outcomes, 1.0, np.zeros(4))
    np.testing.assert_allclose(fit_adam(x, outcomes, 1.0, np.zeros(4), steps=6000), exact, atol=1e-3)
    ten_steps = fit_adam(x, outcomes, 1.0, np.zeros(4))
    assert np.abs(ten_steps).max() <= 0.1 + 1e-9


@given(st.integers(0, 10**6), st.integers(1, 30), st.integers(1, 6))
def test_projection_is_no_worse_than_slsqp(seed: int, m: int, d: int) -> None:
    x, outcomes = problem(seed, m, d)
    lam, radius = 0.1, 0.5
    w = fit_exact(x, outcomes, lam, np.zeros(d))
    matrix = np.eye(d) + x.T @ x
    v = project(w, x, lam, matrix, radius)
    assert np.linalg.norm(v) <= radius * (1 + 1e-9) or np.linalg.norm(w) <= radius
    error = projection_error(v, x, outcomes, lam, matrix)
    start = w * min(1.0, radius / np.linalg.norm(w))
    assert error <= projection_error(start, x, outcomes, lam, matrix) + 1e-9
    best = scipy.optimize.minimize(
        lambda u: projection_error(u, x, outcomes, lam, matrix) ** 2,
        start,
        method="SLSQP",
        constraints={"type": "ineq", "fun": lambda u: radius**2 - u @ u},
    )
    assert error <= np.sqrt(max(best.fun, 0)) * (1 + 1e-3) + 1e-5


def test_a_point_in_the_ball_stays() -> None:
    w = np.array([0.1, 0.2])
    assert project(w, np.empty((0, 2)), 1.0, np.eye(2), 1.0) is w


def test_lambda_must_be_positive() -> None:
    with pytest.raises(InputError, match="lambda"):
        fit_exact(np.empty((0, 1)), np.empty(0), 0.0, np.zeros(1))
