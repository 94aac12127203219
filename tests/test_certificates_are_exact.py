"""A certificate's numbers are those of a naive second computation, rounded up; wrong checkers are noticed."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
from conftest import random_dynamics
from flint import arb, arb_mat

import bridge_theory as theory
from bridge_algos.embeddings import expected_features, make_embedding
from bridge_algos.offline.transitions import estimate_transitions, transition_counts
from bridge_algos.policies import all_policies
from bridge_algos.run.config import RunConfig, preset
from bridge_algos.run.log import logged_seed
from bridge_algos.run.log_file import RunLog
from bridge_algos.run.world import build_world
from bridge_algos.trajectories import Trajectories
from bridge_theory.arithmetic.flint_balls import ball, ends, working_precision
from bridge_theory.errors import ComputationError
from proofs_checks.verify import claims, ellipsoid, regret, verify, walk
from proofs_checks.verify.ellipsoid import data_matrix, solver_error
from proofs_checks.verify.enclosed import Enclosed, difference, largest_norms, product
from proofs_checks.verify.features import coordinates, estimated_kernel, expectations
from proofs_checks.verify.policies import squared_distances, worst_margins

ROUNDS = 6


ONE_STATE = {"n_states": 1, "n_actions": 3, "branching": 1, "horizon": 1, "seed": 2}
CASES: dict[str, tuple[str, str, dict[str, Any]]] = {
    "known": ("starmdp", "bridge-known", {}),
    "unknown": ("starmdp", "bridge", {}),
    "loose weights": ("starmdp", "bridge-known", {"comparisons": 3, "radius": 0.9, "weight_bound": 0.4, "lam": 0.1}),
    "bad solver": ("starmdp", "bridge-known", {"radius": 0.9, "fit": "adam", "comparisons": 50}),
    "many demonstrations and answers": (
        "starmdp",
        "bridge",
        {"radius": 0.9, "environment_options": {"horizon": 2}, "n_demonstrations": 20000, "comparisons": 5000},
    ),
    "sets that shrink": (
        "garnet",
        "bridge-known",
        {"radius": 1.0, "environment_options": ONE_STATE, "comparisons": 4000},
    ),
}


@cache
def logged(case: str) -> tuple[RunConfig, RunLog]:
    environment, algorithm, changes = CASES[case]
    config = preset("theory", environment).but(rounds=ROUNDS, algorithms=(algorithm,), **changes)
    return config, logged_seed(config, build_world(config), 1)[1]


def naive(config: RunConfig, log: RunLog) -> dict[str, np.ndarray]:
    """The bounds of R4 by the algorithms' own features, dense loops and plain floats."""
    (algorithm,) = log.algorithms
    own = {name.split("/")[1]: array for name, array in log.arrays.items() if name.startswith(algorithm)}
    world = build_world(config)
    mdp, embedding, W, lam = world.mdp, world.embedding, world.weight_bound, config.lam
    S, A, H, B = mdp.n_states, mdp.n_actions, mdp.horizon, embedding.bound
    kappa = 2 + 2 * np.cosh(2 * B * W)
    demonstrations = Trajectories(log.arrays["demonstrations/states"], log.arrays["demonstrations/actions"])
    counts = None if algorithm == "bridge-known" else transition_counts(demonstrations, S, A)
    x, o = np.empty((0, embedding.dimension)), np.empty(0)
    matrix, plays, ucb, hind, width = kappa * lam * np.eye(embedding.dimension), [], [], [], []
    everywhere = np.ones(len(own["policies"]), dtype=bool)
    for t in range(ROUNDS + 1):
        dynamics, costs = mdp.dynamics, None
        if counts is not None:
            dynamics = dynamics.under(estimate_transitions(counts))
            costs = theory.bonus_radius.estimate(N=counts.sum(axis=2), S=S, A=A, delta_P=config.delta)
        phi, b = expected_features(dynamics, own["policies"], embedding, costs, H - 1)
        b = B * W * np.minimum(b, 2)
        w = own["w"][t]
        g = x.T @ (1 / (1 + np.exp(-x @ w)) - o) + lam * w
        inverse = np.linalg.inv(matrix)
        ratio = np.linalg.slogdet(matrix)[1] - len(w) * np.log(kappa * lam)
        beta = np.sqrt(lam / kappa) * W + 0.5 * np.sqrt(2 * np.log(1 / config.delta) + ratio)
        rho = kappa * (beta + np.sqrt(g @ inverse @ g))

        def norm(v: np.ndarray, inverse: np.ndarray = inverse) -> np.ndarray:
            return np.sqrt(np.einsum("ij,jk,ik->i", v, inverse, v))

        gaps = phi[:, None] - phi[None]
        spread = np.stack([norm(row) for row in gaps])
        kept = (gaps @ w + rho * spread + b[:, None] + b >= 0).all(axis=1)
        everywhere &= kept
        if plays:
            m = len(plays) * phi - sum(phi[i] + phi[j] for i, j in plays) / 2
            extra = np.array([sum((b[p] + b[k]) * (p != k) for pair in plays for k in pair) for p in range(len(phi))])
            first = np.minimum(m @ w + rho * norm(m), W * np.linalg.norm(m, axis=1))
            hind.append(max((first + extra / 2)[everywhere]))
        if t == ROUNDS:
            break
        i, j = plays_now = tuple(int(k) for k in own["pairs"][t])
        terms = []
        for k in plays_now:
            d = phi - phi[k]
            u = np.minimum(d @ w + rho * norm(d), W * np.linalg.norm(d, axis=1)) + (b + b[k])
            u[k] = 0
            terms.append(max(u[kept]))
        ucb.append(sum(terms) / 2)
        width.append(2 * (rho * spread[i, j] + b[i] + b[j]))
        plays.append(plays_now)
        one, two = (Trajectories(own["states"][t, side], own["actions"][t, side]) for side in (0, 1))
        new = embedding.of_trajectories(one) - embedding.of_trajectories(two)
        x, o, matrix = np.concatenate([x, new]), np.concatenate([o, own["outcomes"][t]]), matrix + new.T @ new
        if counts is not None:
            counts = counts + transition_counts(one, S, A) + transition_counts(two, S, A)
    return {"ucb": np.cumsum(ucb), "width": np.cumsum(width), "hindsight": np.array(hind)}


@cache
def expected(case: str) -> dict[str, np.ndarray]:
    return naive(*logged(case))


def complaints(case: str) -> list[str]:
    """What is wrong with the certificate of an honest run: nothing, with the checker as it is."""
    (certificate,) = verify(logged(case)[1])
    wrong = list(certificate.reasons)
    for name, values in expected(case).items():
        found = certificate.bounds[name]
        at_least = values if name != "width" else certificate.bounds["ucb"]
        if not (found >= at_least * (1 - 1e-9)).all():
            wrong.append(f"{name} is too small: {found} < {at_least}")
        if not (found <= values * (1 + 1e-6) + 1e-7).all():
            wrong.append(f"{name} is too large: {found} > {values}")
    return wrong


@pytest.mark.parametrize("case", CASES)
def test_bounds_are_those_of_a_naive_computation(case: str) -> None:
    assert complaints(case) == []


def test_the_cases_reach_every_branch_of_the_bounds() -> None:
    (shrinking,) = verify(logged("sets that shrink")[1])
    assert shrinking.set_size[-1] < shrinking.set_size[0]
    (informed,) = verify(logged("many demonstrations and answers")[1])
    assert informed.bounds["hindsight"][-1] < informed.bounds["ucb"][-1] < informed.bounds["trivial"][-1] / 2
    (sloppy,) = verify(logged("bad solver")[1])
    assert sloppy.solver_error[-1] > 1


def halved(function: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *a, **k: function(*a, **k) / 2


def bent(module: Any, name: str, change: Callable[[Any], Any]) -> tuple[Any, str, Any]:
    return module, name, change(getattr(module, name))


MUTANTS: dict[str, tuple[Any, str, Any]] = {
    "half of rho": bent(walk, "radius", halved),
    "rho without the solver's error": bent(
        walk, "radius", lambda f: lambda matrix, error, *rest: f(matrix, error * 0, *rest)
    ),
    "rho at twice delta": bent(walk, "radius", lambda f: lambda *a: f(*a[:-1], a[-1] * 2)),
    "the paper's kappa": bent(walk, "certified_scale", lambda _: lambda B, W, lam: (2 + 2 * (B * W).cosh()) * lam),
    "no square root in the error": bent(walk, "solver_error", lambda f: lambda *a: f(*a) ** 2),
    "half the L1 radii": bent(walk, "row_radii", halved),
    "no bonus of the policy played": bent(
        regret, "regret_optimism", lambda f: lambda m, **k: f(m, **{**k, "bonus_sum": k["bonus_sum"] / 2})
    ),
    "half of W": bent(regret, "regret_optimism", lambda f: lambda m, **k: f(m, **{**k, "W": k["W"] / 2})),
    "no bonus in hindsight": bent(
        regret, "regret_hindsight", lambda f: lambda m, **k: f(m, **{**k, "bonus_sum": 0 * k["bonus_sum"]})
    ),
    "half the norm in hindsight": bent(
        regret, "regret_hindsight", lambda f: lambda m, **k: f(m, **{**k, "optimism": k["optimism"] / 2})
    ),
    "hindsight against each policy once": bent(
        walk, "hindsight", lambda f: lambda view, ever, plays, W: f(view, ever, plays // 2 * 2, W)
    ),
    "one round forgotten in the sum": bent(walk, "cumulative", lambda f: lambda steps: f(np.append(steps[:-1], 0))),
    "sets by half the norm": bent(regret, "worst_margins", lambda f: lambda s, z, gamma, b: f(s, z, gamma / 1e6, b)),
    "claimed sets by half the norm": bent(
        claims, "worst_margins", lambda f: lambda s, z, gamma, b: f(s, z, gamma / 1e6, b)
    ),
}


@pytest.mark.parametrize("mutant", MUTANTS)
def test_a_wrong_checker_is_noticed(mutant: str, monkeypatch: pytest.MonkeyPatch) -> None:
    module, name, wrong = MUTANTS[mutant]
    monkeypatch.setattr(module, name, wrong)
    assert any(complaints(case) for case in CASES)


def closed(step: np.ndarray, hindsights: np.ndarray) -> np.ndarray:
    """All that follows from the bounds, one consequence after the other until there is nothing new."""
    best = hindsights.copy()
    for _ in range(2 * len(step)):
        before = np.concatenate([[0.0], best[:-1]])
        best = np.minimum(best, before + step)
        best = np.minimum(best, np.concatenate([best[1:], [np.inf]]))
    return best


def test_the_best_bound_is_all_that_follows_from_the_others(rng: np.random.Generator) -> None:
    """A later bound holds for an earlier round, and an earlier one with the rounds between for a later."""
    helped = {"earlier": 0, "later": 0}
    for _ in range(50):
        steps = {name: rng.exponential(size=8) for name in ("trivial", "ucb", "width")}
        hindsights = np.where(rng.random(8) < 0.5, 4 * rng.exponential(size=8), np.inf)
        step, found = np.min(list(steps.values()), axis=0), regret.best_bounds(steps, hindsights)
        np.testing.assert_allclose(found, closed(step, hindsights), rtol=1e-12)
        assert (found >= closed(step, hindsights)).all()
        helped["earlier"] += bool((found[:-1] == found[1:]).any())
        helped["later"] += bool((found < np.minimum(np.cumsum(step), hindsights)).any())
    assert min(helped.values()) > 5


def exact_features(
    kernel: list[list[list[Fraction]]], start: list[Fraction], policy: Any, table: Any
) -> list[Fraction]:
    features = [Fraction(0)] * (table.dimension + 1)
    occupancy, states = start, range(len(start))
    for h in range(table.places.shape[0]):
        if h:
            occupancy = [sum(occupancy[s] * kernel[s][policy[s]][p] for s in states) for p in states]
        for s in states:
            for place in table.places[h, s, policy[s]]:
                features[place] += occupancy[s]
    return features[:-1]


@pytest.mark.parametrize(
    "name", ["identity_long", "identity_short", "state_counts", "final_state", "state_action_counts"]
)
def test_features_contain_the_rational_ones(name: str, rng: np.random.Generator) -> None:
    S, A, H = 4, 2, 5
    dynamics = random_dynamics(rng, S, A, H)
    counts = rng.integers(0, 4, size=(S, A, S))
    counts[1, 1] = 0
    table, policies = coordinates(name, S, A, H), all_policies(S, A)
    assert table.square_bound == pytest.approx(make_embedding(name, S, A, H).bound ** 2)

    def row(n: np.ndarray, s: int) -> list[Fraction]:
        total = int(n.sum())
        return [Fraction(int(v), total) if total else Fraction(int(s == p)) for p, v in enumerate(n)]

    estimate = [[row(n, s) for n in rows] for s, rows in enumerate(counts)]
    rounded = [[[Fraction(v) / sum(map(Fraction, row)) for v in row] for row in rows] for rows in dynamics.transitions]
    start = [Fraction(v) / sum(map(Fraction, dynamics.initial)) for v in dynamics.initial]
    for kernel, given in ((estimate, estimated_kernel(counts, "self_loop")), (rounded, dynamics.transitions)):
        found, _ = expectations(given, dynamics.initial, policies, table)
        worst = max(
            abs(Fraction(float(found.mid[i, j])) - value)
            for i, policy in enumerate(policies)
            for j, value in enumerate(exact_features(kernel, start, policy, table))
        )
        assert worst <= Fraction(found.rad)
        assert found.rad < 1e-12
    reference = expected_features(dynamics, policies, make_embedding(name, S, A, H))[0]
    np.testing.assert_allclose(found.mid, reference, atol=1e-12)


def test_products_distances_and_margins_contain_exact_values(rng: np.random.Generator) -> None:
    for scale in (1.0, 1e-9, 1e9):
        a, b = scale * rng.normal(size=(7, 5)), rng.normal(size=(5, 7)) + 1e3
        exact = [[sum(Fraction(u) * Fraction(v) for u, v in zip(r, c, strict=True)) for c in b.T] for r in a]
        found = product(Enclosed(a, 0.0), Enclosed(b, 0.0))
        assert all(
            abs(Fraction(found.mid[i, j]) - exact[i][j]) <= Fraction(found.rad) for i in range(7) for j in range(7)
        )
        a[3] = a[2]  # twins: their distance is exactly zero
        squares, radius = squared_distances(Enclosed(a, 0.0), slice(0, 7))
        gaps = difference(Enclosed(a, 0.0), Enclosed(a[2], 0.0))
        norms, scores, bonus = largest_norms(gaps), a[:, 0], np.abs(b[0]) / 1e3
        low, high = worst_margins(Enclosed(scores, 0.0), Enclosed(a, 0.0), 0.5, bonus)
        for i in range(7):
            square = sum((Fraction(u) - Fraction(v)) ** 2 for u, v in zip(a[i], a[2], strict=True))
            assert abs(Fraction(squares[i, 2]) - square) <= Fraction(radius)
            assert Fraction(norms[i]) ** 2 >= square
            with working_precision(200):
                margins = [
                    ball(Fraction(scores[i]) - Fraction(scores[j]) + Fraction(bonus[i]) + Fraction(bonus[j]))
                    + ball(sum((Fraction(u) - Fraction(v)) ** 2 for u, v in zip(a[i], a[j], strict=True))).sqrt() / 2
                    for j in range(7)
                ]
                assert all(margin >= arb(low[i]) for margin in margins)
                assert any(margin <= arb(high[i]) for margin in margins)


def test_the_data_matrix_contains_exact_norms_and_determinants(rng: np.random.Generator) -> None:
    x = rng.integers(-3, 4, size=(40, 6))
    w, outcomes = rng.normal(size=6), rng.integers(0, 2, size=40).astype(float)
    with working_precision(300):
        scale, gram = ball(Fraction(1, 7)).exp(), x.T @ x
        exact = arb_mat([[arb(int(v)) for v in row] for row in gram]) + scale * arb_mat(
            6, 6, [int(i % 7 == 0) for i in range(36)]
        )
        matrix = data_matrix(scale, gram)
        assert matrix.log_det.overlaps(exact.det().log())
        assert ends(matrix.log_det)[1] - ends(matrix.log_det)[0] < 1e-9
        residual = arb_mat(6, 1, [arb(v) / 3 for v in w.tolist()])
        for row, o in zip(x.tolist(), outcomes, strict=True):
            u = sum((arb(a) * arb(b) for a, b in zip(row, w.tolist(), strict=True)), start=arb(0))
            residual += (1 / (1 + (-u).exp()) - arb(o)) * arb_mat(6, 1, row)
        squared = (residual.transpose() * exact.inv() * residual)[0, 0]
        error = solver_error(matrix, x, outcomes, w, ball(Fraction(1, 3)), ball(1))
        assert (error**2).overlaps(squared)
        assert ends(error)[1] - ends(error)[0] < 1e-9
        assert (
            matrix.largest_norms(matrix.whitened(Enclosed(w[None], 0.0)))[0] ** 2
            >= ends((arb_mat(1, 6, w.tolist()) * exact.inv() * arb_mat(6, 1, w.tolist()))[0, 0])[0]
        )


def test_a_singular_matrix_is_refused() -> None:
    gram = 10**12 * np.ones((3, 3), dtype=np.int64)
    with pytest.raises(ComputationError, match="data matrix"):
        ellipsoid.data_matrix(ball(Fraction(1, 10**8)), gram)
