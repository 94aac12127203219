"""The likelihood set of a run's answers holds w*, its ellipsoid holds the set, and its bound is above the regret."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from math import log

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import expit

from bridge_algos.asking.ellipsoid import evidence, likelihood_ellipsoid
from bridge_algos.embeddings import expected_features
from bridge_algos.run.config import preset
from bridge_algos.run.log import logged_seed
from bridge_algos.run.log_file import RunLog
from bridge_algos.run.world import build_world
from bridge_theory.arithmetic.flint_balls import ball, ends, working_precision
from bridge_theory.errors import ComputationError
from proofs_checks.verify import Certificate, verify
from proofs_checks.verify.enclosed import Enclosed
from proofs_checks.verify.evidence import SCALES, Answers, log_evidence
from proofs_checks.verify.likelihood import dual_bounds, likelihood_bound, tangent

DELTA = 0.05
RANGE_5 = 2.15
"""W at which the best and the worst policy of StarMDP are 5 nats apart."""


def drawn(seed: int, m: int, d: int, W: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Whole-number questions, answers of a Bradley-Terry teacher, and its weights, of norm at most W."""
    rng = np.random.default_rng(seed)
    truth = rng.normal(size=d)
    truth *= W * rng.uniform(0.2, 1) / np.linalg.norm(truth)
    x = rng.integers(-2, 3, size=(m, d)).astype(float)
    return x, (rng.random(m) < expit(x @ truth)).astype(float), truth


def likelihood(x: np.ndarray, o: np.ndarray, w: np.ndarray) -> float:
    return float(np.where(o == 1, -np.logaddexp(0, -x @ w), -np.logaddexp(0, x @ w)).sum())


@cache
def played(confidence: str = "likelihood") -> tuple[Certificate, RunLog, float]:
    """A run of StarMDP at a range of 5 nats, its certificate and its regret."""
    changes = {"rounds": 30, "comparisons": 4, "weight_bound": RANGE_5, "algorithms": ("bridge-known",)}
    config = preset("theory", "starmdp").but(confidence=confidence, **changes)
    world = build_world(config)
    results, log_ = logged_seed(config, world, 0)
    (certificate,) = verify(log_)
    return certificate, log_, world.utility_scale * float(results.pseudo_regret.sum())


def naive_bound(log_: RunLog, name: str = "bridge-known") -> float:
    """G6 after the last round, by definition: an independent solver for each candidate, plain floats."""
    config = preset("theory", "starmdp")
    world = build_world(config)
    arrays = {key.split("/")[1]: value for key, value in log_.arrays.items() if key.startswith(name)}
    W, d, horizon = log_.header["weight_bound"], world.embedding.dimension, arrays["states"].shape[-1]
    visits = np.zeros((*arrays["states"].shape[:3], d))
    for h in range(horizon):
        places = arrays["states"][..., h] * 4 + arrays["actions"][..., h]
        np.put_along_axis(
            visits, places[..., None], np.take_along_axis(visits, places[..., None], axis=-1) + 1, axis=-1
        )
    x, o = (visits[:, 0] - visits[:, 1]).reshape(-1, d), arrays["outcomes"].ravel()
    level = evidence(x, o, W) - log(1 / DELTA)
    features, _ = expected_features(world.mdp.dynamics, arrays["policies"], world.embedding)
    played = features[arrays["pairs"]].mean(axis=1).sum(axis=0)

    def gradient(w: np.ndarray) -> np.ndarray:
        return (o - expit(x @ w)) @ x

    reached = []
    start = minimize(
        lambda w: -likelihood(x, o, w), np.zeros(d), jac=lambda w: -gradient(w), method="SLSQP",
        constraints={"type": "ineq", "fun": lambda w: W**2 * 0.99 - w @ w, "jac": lambda w: -2 * w},
    ).x  # fmt: skip
    for v in len(arrays["pairs"]) * features - played:
        found = minimize(
            lambda w, v=v: -v @ w, start, jac=lambda _, v=v: -v, method="SLSQP", options={"maxiter": 500},
            constraints=[
                {"type": "ineq", "fun": lambda w: W**2 - w @ w, "jac": lambda w: -2 * w},
                {"type": "ineq", "fun": lambda w: likelihood(x, o, w) - level, "jac": gradient},
            ],
        )  # fmt: skip
        reached.append(float(v @ found.x))
    return max(reached)


@pytest.mark.parametrize(("m", "d", "W"), [(0, 3, 1.0), (12, 1, 3.0), (60, 3, 2.0), (60, 3, 20.0), (200, 8, 0.5)])
def test_the_ellipsoid_holds_every_likely_weight_of_the_ball(m: int, d: int, W: float) -> None:
    """w* whenever it is in the set, and points on the set's border, where it would be left first."""
    seen = 0
    for seed in range(20):
        x, o, truth = drawn(seed, m, d, W)
        around = likelihood_ellipsoid(x, o, W, DELTA)
        assert not around.empty
        level = evidence(x, o, W) - log(1 / DELTA)
        rng = np.random.default_rng(seed)
        inside = truth if likelihood(x, o, truth) >= level else np.zeros(d)
        points = [truth]
        for direction in rng.normal(size=(30, d)):
            low, high = 0.0, 2 * W / np.linalg.norm(direction)
            for _ in range(40):
                w = inside + (low + high) / 2 * direction
                likely = np.linalg.norm(w) <= W and likelihood(x, o, w) >= level
                low, high = ((low + high) / 2, high) if likely else (low, (low + high) / 2)
            points.append(inside + low * direction)
        for w in points:
            if np.linalg.norm(w) <= W and likelihood(x, o, w) >= level:
                seen += 1
                away = w - around.center
                assert away @ around.matrix @ away <= around.radius**2
    assert seen > 500


def test_the_ellipsoid_shrinks_with_answers() -> None:
    lengths = []
    for m in (50, 500, 5000):
        x, o, _ = drawn(1, m, 3, 2.0)
        around = likelihood_ellipsoid(x, o, 2.0, DELTA)
        lengths.append(around.radius / np.sqrt(np.linalg.eigvalsh(around.matrix)[0]))
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[-1] < lengths[0] / 5  # like the root of 100, up to a logarithm


@pytest.mark.parametrize("seed", range(5))
def test_both_evidences_are_one_number_below_the_exact_one(seed: int) -> None:
    x, o, _ = drawn(seed, 40, 2, 1.5)
    grid = np.stack(np.meshgrid(*[np.linspace(-9, 9, 361)] * 2), axis=-1).reshape(-1, 2)
    z = grid @ x.T
    heights = np.where(o == 1, -np.logaddexp(0, -z), -np.logaddexp(0, z)).sum(axis=1)
    laws = [k * 2 / 1.5**2 for k in SCALES]
    prior = np.mean([k / (2 * np.pi) * np.exp(-k * (grid**2).sum(axis=1) / 2) for k in laws], axis=0)
    exact = float(np.log((np.exp(heights - heights.max()) * prior).sum() * 0.05**2) + heights.max())
    with working_precision(96):
        low, high = ends(log_evidence(Answers.counted(x.astype(np.int64), o), Fraction(3, 2)))
    assert high <= exact
    assert low >= exact - 1.5
    assert evidence(x, o, 1.5) == pytest.approx(low, abs=1e-6)
    assert evidence(x, o, 1.5) <= high + 1e-9


def test_answers_that_no_weights_explain_leave_no_small_set() -> None:
    """Always the first, by much: within W the model says otherwise."""
    x, o = np.full((400, 1), 10.0), np.ones(400)
    around = likelihood_ellipsoid(x, o, 0.05, DELTA)
    assert around.empty
    assert around.radius / around.matrix[0, 0] ** 0.5 == 0.05  # all weights are left, none is believed
    answers = Answers.counted(x.astype(np.int64), o)
    with working_precision(96), pytest.raises(ComputationError, match="contradict the Bradley-Terry model or W"):
        likelihood_bound(answers, Enclosed(np.ones((1, 1)), 0.0), Fraction(1, 20), Fraction(1, 20))


@pytest.mark.parametrize("seed", range(5))
def test_any_point_bounds_every_weight_of_the_set(seed: int) -> None:
    """Whatever a search found, outside of the ball too."""
    x, o, truth = drawn(seed, 150, 3, 2.0)
    level = evidence(x, o, 2.0) - log(1 / DELTA)
    rng = np.random.default_rng(seed)
    cloud = truth + rng.normal(size=(20_000, 3)) * rng.uniform(0.01, 1, size=(20_000, 1))
    z = cloud @ x.T
    heights = np.where(o == 1, -np.logaddexp(0, -z), -np.logaddexp(0, z)).sum(axis=1)
    members = cloud[(heights >= level) & (np.linalg.norm(cloud, axis=1) <= 2.0)]
    assert len(members) > 1000
    directions = rng.normal(size=(50, 3))
    reached = (directions @ members.T).max(axis=1)
    answers = Answers.counted(x.astype(np.int64), o)
    for w in [truth, np.zeros(3), *rng.normal(size=(20, 3)) * 3]:
        with working_precision(96):
            at = tangent(answers, log_evidence(answers, Fraction(2)) + ball(Fraction(1, 20)).log(), w)
        bounds = dual_bounds(Enclosed(directions, 0.0), at, 2.0)
        assert (bounds >= reached).all()
        assert (bounds <= 2.0 * np.linalg.norm(directions, axis=1) * (1 + 1e-9)).all()


@pytest.mark.parametrize("W", [0.125, 0.625, RANGE_5])
def test_the_bound_is_above_the_regret_of_seeded_runs(W: float) -> None:
    config = preset("theory", "starmdp").but(
        confidence="likelihood", rounds=8, comparisons=4, weight_bound=W, algorithms=("bridge-known",)
    )
    world = build_world(config)
    for seed in range(8):
        results, log_ = logged_seed(config, world, seed)
        (certificate,) = verify(log_)
        regret = world.utility_scale * np.cumsum(results.pseudo_regret.values[0])
        assert (certificate.bounds["likelihood"] >= regret - 1e-9).all()


@pytest.mark.parametrize("confidence", ["likelihood", "repaired"])
def test_the_bound_is_that_of_its_definition(confidence: str) -> None:
    certificate, log_, regret = played(confidence)
    assert certificate.certified, certificate.words()
    found, naive = certificate.bounds["likelihood"][-1], naive_bound(log_)
    assert regret < naive
    assert naive - 1e-6 <= found <= 1.002 * naive
    assert certificate.failures["likelihood"] == DELTA


def test_the_bound_is_smaller_than_that_of_the_ellipsoid_with_kappa() -> None:
    """Audit R4 on the same logs: kappa is 10^15 there, so that the best of its bounds is hardly the trivial one's."""
    for confidence in ("likelihood", "repaired"):
        bounds = played(confidence)[0].bounds
        assert bounds["likelihood"][-1] < bounds["best"][-1]


def test_the_bound_never_falls_from_round_to_round() -> None:
    assert (np.diff(played()[0].bounds["likelihood"]) >= 0).all()


def test_another_answer_is_another_bound() -> None:
    rng = np.random.default_rng(3)
    x, o, _ = drawn(3, 400, 3, 2.0)
    directions = Enclosed(rng.normal(size=(5, 3)), 0.0)

    def bound(outcomes: np.ndarray) -> float:
        with working_precision(96):
            return likelihood_bound(
                Answers.counted(x.astype(np.int64), outcomes), directions, Fraction(6), Fraction(1, 20)
            )

    honest = bound(o)
    for t in range(0, 400, 40):
        flipped = o.copy()
        flipped[t] = 1 - flipped[t]
        assert not x[t].any() or abs(bound(flipped) - honest) > 1e-6


def test_the_bound_is_for_known_dynamics_and_bradley_terry_answers() -> None:
    config = preset("theory", "starmdp").but(rounds=2, algorithms=("bridge", "bridge-known"))
    for changes, algorithms in (
        ({}, {"bridge-known"}),
        ({"slope": 2.0}, {"bridge-known"}),
        ({"oracle": "returns"}, set()),
    ):
        own = config.but(**changes)
        for item in verify(logged_seed(own, build_world(own), 0)[1]):
            assert item.certified
            held = item.algorithm in algorithms
            assert np.isfinite(item.bounds["likelihood"]).all() == held
            assert item.alone == ({"likelihood": DELTA} if held else {})
            assert bool(item.sentences["likelihood"]) == held
