"""The yardstick of a question budget solves cases done by hand, and its bracket holds against another solver."""

from __future__ import annotations

from math import inf, log

import cvxpy as cp
import numpy as np
import pytest
from scipy.optimize import linprog, minimize
from scipy.special import expit

from bridge_algos.asking.candidates import version_space_candidates
from bridge_algos.asking.interior import CutBall, inner_points, minimise
from bridge_algos.asking.limit import (
    Setting,
    all_pairs,
    best_design,
    divergences,
    information_rate,
    limit,
    tabular_limit,
)
from bridge_algos.asking.tabular import build_problem
from bridge_algos.asking.utility import simulated_utility
from bridge_algos.envs.registry import make_mdp
from bridge_theory.errors import InputError


def _kl(p: float, q: float) -> float:
    return p * log(p / q) + (1 - p) * log((1 - p) / (1 - q))


def test_one_question_direction_and_two_candidates_by_hand() -> None:
    """Only the candidate 1 is right; it is wrong where w <= -eps, and the longest question tells that best."""
    setting = Setting(np.array([[1.0], [0.0]]), np.array([1.0]), 5.0, 0.2, np.array([[0.5], [1.0], [2.0]]))
    by_hand = _kl(float(expit(2.0)), float(expit(-0.4)))
    found = limit(setting, 0.05)
    assert found.rate == pytest.approx(by_hand, rel=0.02)
    assert by_hand * (1 - 1e-9) <= found.rate
    assert found.questions == pytest.approx(_kl(0.95, 0.05) / by_hand, rel=0.02)
    assert (found.correct, found.candidate) == (1, 0)


def test_two_equal_rivals_share_the_questions_by_hand() -> None:
    """Each question tells one rival only, so that the best design is half and half."""
    truth = np.array([-1.0, -1.0])
    setting = Setting(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), truth, 5.0, 0.5, np.eye(2))
    high, low = information_rate(setting, 0)
    by_hand = _kl(float(expit(-1.0)), float(expit(0.5))) / 2
    assert low - 1e-4 <= by_hand <= high * (1 + 1e-9)
    assert high <= 1.03 * low


def test_nothing_to_show_needs_no_question() -> None:
    setting = Setting(np.array([[1.0], [0.95]]), np.array([1.0]), 2.0, 0.5, np.array([[1.0]]))
    found = limit(setting, 0.05)
    assert (found.rate, found.reached, found.questions, found.correct) == (inf, inf, 0.0, 2)


def test_one_candidate_needs_no_question() -> None:
    mdp = make_mdp("starmdp")
    utility = simulated_utility(mdp, "state_action_counts", utility_range=5)
    problem = build_problem(mdp, utility, 40, np.random.default_rng(0), pool=20)
    assert len(problem.candidates.features) == 1
    assert tabular_limit(problem, 0.5, 0.05).questions == 0


def test_cones_can_only_shorten_the_way() -> None:
    rng = np.random.default_rng(0)
    features, truth, questions = rng.normal(size=(5, 3)), rng.normal(size=3), rng.normal(size=(30, 3))
    ball = Setting(features, truth, 3.0, 0.3, questions)
    cones = Setting(features, truth, 3.0, 0.3, questions, lambda i: features[i][:, None] - rng.normal(size=(1, 4, 3)))
    best = int((features @ truth).argmax())
    assert information_rate(cones, best)[0] >= information_rate(ball, best)[1]


@pytest.mark.parametrize("seed", range(3))
def test_the_bracket_holds_against_an_independent_solver(seed: int) -> None:
    """Any design's value lies below the upper end; weights found by another method never beat the lower end."""
    rng = np.random.default_rng(seed)
    features, truth, questions = rng.normal(size=(5, 3)), rng.normal(size=3), all_pairs(rng.normal(size=(8, 3)))
    setting = Setting(features, truth, 4.0, 0.3, questions)
    best = int((features @ truth).argmax())
    high, low = information_rate(setting, best)
    assert 0 < low <= high <= 1.03 * low

    def value(design: np.ndarray) -> float:
        found = []
        for other in range(5):
            if other == best:
                continue
            v = features[other] - features[best]
            inside = [
                {"type": "ineq", "fun": lambda w, v=v: v @ w - 0.3},
                {"type": "ineq", "fun": lambda w: 16.0 - w @ w},
            ]
            start = 2 * v / np.linalg.norm(v)
            result = minimize(
                lambda w: float(divergences(truth, w[None], questions)[0] @ design),
                start,
                constraints=inside,
                tol=1e-12,
            )
            found.append(result.fun)
        return min(found)

    designs = rng.dirichlet(np.full(len(questions), 0.2), size=20)
    assert max(value(design) for design in designs) <= high * (1 + 1e-6)
    worst = np.stack([rng.normal(size=3) * 2 for _ in range(4000)])
    worst = worst[(np.linalg.norm(worst, axis=1) <= 4) & ((worst @ (features - features[best]).T).max(axis=1) >= 0.3)]
    _, _, mixed = best_design(divergences(truth, worst, questions))
    assert mixed >= low * (1 - 1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_the_bracket_encloses_the_value_of_one_conic_program(seed: int) -> None:
    """D is also the least t such that a mixture of weights, one for each contender, is told by no question above t."""
    rng = np.random.default_rng(seed)
    features, truth, questions = rng.normal(size=(5, 3)), rng.normal(size=3), all_pairs(rng.normal(size=(6, 3)))
    rivals = features[:, None] - 0.3 * rng.normal(size=(5, 3, 3))
    setting = Setting(features, truth, 4.0, 0.3, questions, rivals.__getitem__ if seed % 2 else None)
    best = int((features @ truth).argmax())
    high, low = information_rate(setting, best)
    exact = _conic_rate(setting, best)
    assert low * (1 - 1e-4) <= exact <= high * (1 + 1e-4)


def _conic_rate(setting: Setting, candidate: int) -> float:
    """Minimax: convexity puts each contender's share on one point, and shares times points make it a conic program."""
    x, p, w_bound = setting.questions, expit(setting.questions @ setting.truth), setting.weight_bound
    entropy = p * np.log(p) + (1 - p) * np.log(1 - p)
    told, constraints, shares = 0, [], []
    for contender in range(len(setting.features)):
        v = setting.features[contender] - setting.features[candidate]
        if np.linalg.norm(v) * w_bound <= setting.nats:
            continue
        share, scaled = cp.Variable(nonneg=True), cp.Variable(len(v))
        constraints += [v @ scaled >= setting.nats * share, cp.norm(scaled) <= w_bound * share]
        if setting.cones is not None:
            constraints.append(setting.cones(np.array([contender]))[0] @ scaled >= 0)
        z, ones = x @ scaled, share * np.ones(len(x))
        softplus, below, above = (cp.Variable(len(x)) for _ in range(3))  # share * log(1 + exp(z / share))
        constraints += [cp.ExpCone(-softplus, ones, below), cp.ExpCone(z - softplus, ones, above)]
        constraints.append(below + above <= ones)
        told = told + softplus - cp.multiply(p, z) + entropy * share
        shares.append(share)
    most = cp.Variable()
    return float(cp.Problem(cp.Minimize(most), [*constraints, sum(shares) == 1, told <= most]).solve(solver="CLARABEL"))


def test_points_inside_are_found_among_a_thousand_half_spaces() -> None:
    """The weights under which a candidate is the best of all policies of StarMDP; linear programs find points first."""
    mdp = make_mdp("starmdp")
    utility = simulated_utility(mdp, "state_action_counts", utility_range=5)
    rng = np.random.default_rng(0)
    policies = version_space_candidates(mdp, utility.embedding, None, 2000, rng).features
    candidates = build_problem(mdp, utility, 1, rng, pool=2).candidates.features
    order = np.argsort(-candidates @ utility.weights)
    v = candidates[order[1:]] - candidates[order[0]]
    rows = np.concatenate([v[:, None], candidates[order[1:], None] - policies], axis=1)
    lengths = np.linalg.norm(rows, axis=2)
    rows = np.where(lengths[..., None] > 0, rows / np.where(lengths > 0, lengths, 1.0)[..., None], 0.0)
    offsets = np.where(lengths > 0, 0.0, -1.0)
    offsets[:, 0] = 0.5 / lengths[:, 0]
    side = utility.weight_bound / np.sqrt(rows.shape[2])
    for cut, offset in zip(rows, offsets, strict=True):
        bounds = [(-side, side)] * rows.shape[2] + [(None, 1.0)]
        cost = np.append(np.zeros(rows.shape[2]), -1.0)
        deepest = linprog(cost, np.hstack([-cut, np.ones((len(cut), 1))]), -offset, bounds=bounds)
        assert -deepest.fun > 0.05, "a cube inside the ball holds a point well inside"
    found, points = inner_points(CutBall(rows, offsets, utility.weight_bound, rows.shape[2]))
    assert found.tolist() == list(range(15))
    assert (np.einsum("bkd,bd->bk", rows, points) > offsets).all()
    assert (np.linalg.norm(points, axis=1) < utility.weight_bound).all()


def test_points_inside_are_found_exactly_where_there_are_some() -> None:
    rows = np.array([[[1.0, 0.0], [-1.0, 0.0]], [[1.0, 0.0], [-1.0, 0.0]], [[1.0, 0.0], [0.0, 1.0]]])
    offsets = np.array([[0.5, -0.7], [0.5, -0.4], [0.9, 0.9]])  # a strip, an empty strip, a corner outside the disc
    found, points = inner_points(CutBall(rows, offsets, 1.0, 2))
    assert found.tolist() == [0]
    assert 0.5 < points[0, 0] < 0.7


def test_a_projection_is_found() -> None:
    sets = CutBall(np.array([[[1.0, 1.0]]]), np.array([[1.0]]), 5.0, 2)
    identity = np.broadcast_to(2 * np.eye(2), (1, 2, 2))
    nearest = minimise(
        lambda w: (np.vecdot(w, w), 2 * w, identity), sets, np.array([[2.0, 0.5]]), np.geomspace(1, 1e8, 9)
    )
    np.testing.assert_allclose(nearest, [[0.5, 0.5]], atol=1e-6)


@pytest.mark.parametrize(("delta", "nats", "words"), [(0.5, 0.1, "delta"), (0.05, 0.0, "gap above 0")])
def test_mistakes_get_a_sentence(delta: float, nats: float, words: str) -> None:
    setting = Setting(np.array([[1.0], [0.0]]), np.array([1.0]), 5.0, nats, np.array([[1.0]]))
    with pytest.raises(InputError, match=words):
        limit(setting, delta)
