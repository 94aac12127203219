"""Candidates whose features come from a simulator are certified with the errors of the features, never without."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import exp, log

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import expit
from scipy.stats import binom

from bridge_algos.asking.answers import Answers
from bridge_algos.asking.cli import main
from bridge_algos.asking.config import AskConfig
from bridge_algos.asking.elicitation import Ball, Elicitation
from bridge_algos.asking.evidence import Evidence
from bridge_algos.asking.feature_errors import FeatureErrors, ball_errors
from bridge_algos.asking.gap import Gap
from bridge_algos.asking.region import likelihood_set
from bridge_algos.asking.rollout_bounds import chance_bound, expectation_bound, mean_radius, norm_radius
from bridge_algos.asking.rollout_estimates import (
    Estimate,
    candidate_actions,
    candidate_policies,
    coupled_estimate,
    paired_estimate,
    told_apart,
)
from bridge_algos.asking.rollout_tree import (
    Tree,
    branch,
    followed_sums,
    follows,
    relative_features,
    tabular_simulator,
)
from bridge_algos.asking.rollouts import rarely_visited, varied
from bridge_algos.asking.study import prepare, run_session
from bridge_algos.asking.utility import step_features
from bridge_algos.embeddings import expected_features, make_embedding
from bridge_algos.envs.registry import make_mdp
from bridge_algos.trajectories import sample_trajectories
from bridge_theory.errors import InputError

STAR = make_mdp("starmdp")
PER_STEP = step_features("state_action_counts", STAR)
PHI = make_embedding("state_action_counts", STAR.n_states, STAR.n_actions, STAR.horizon)
REACH = float(np.sqrt(2) * PHI.bound)
RECORDED = np.array([0, 2, 1, -1, -1])
"""Demonstrated actions; nothing is known in two states, so that 16 candidates are left."""

NO_STATES = np.zeros(0, dtype=np.int64)
UNLIKELY = 1e-7
"""Chance that a test of a true bound fails."""


def _tree(n: int, seed: int, merged: np.ndarray = NO_STATES) -> Tree:
    return branch(tabular_simulator(STAR.dynamics), RECORDED, merged, PER_STEP, n, np.random.default_rng(seed))


def _exact() -> tuple[np.ndarray, np.ndarray]:
    """All policies that agree with RECORDED, and their features."""
    policies = candidate_policies(_tree(1, 0), RECORDED, STAR.n_actions)
    return policies, expected_features(STAR.dynamics, policies, PHI)[0]


POLICIES, FEATURES = _exact()


@pytest.mark.parametrize("n", [1, 7, 60, 400])
@pytest.mark.parametrize("log_chance", [1.0, 2.0, 6.0])
def test_an_expectation_is_bounded_as_often_as_is_said(n: int, log_chance: float) -> None:
    """Exact, for coins: the chance of all counts whose bound is too low."""
    counts = np.arange(n + 1)
    bounds = expectation_bound(counts / n, 1.0, log_chance, n)
    worst = bare = 0.0
    for p in np.linspace(0.005, 0.995, 199):
        mass = binom.pmf(counts, n, p)
        worst = max(worst, float(mass[bounds < p].sum()))
        bare = max(bare, float(mass[counts / n < p].sum()))
    assert worst <= exp(-log_chance)
    assert bare > exp(-log_chance)  # the sample mean alone is no bound


@pytest.mark.parametrize("n", [5, 50, 1000])
def test_a_chance_is_bounded_as_often_as_is_said(n: int) -> None:
    counts = np.arange(n + 1)
    bounds = np.array([chance_bound(int(k), n, 0.05) for k in counts])
    for p in np.linspace(0.001, 0.999, 200):
        assert binom.pmf(counts, n, p)[bounds < p].sum() <= 0.05 + 1e-12


@pytest.mark.parametrize("n", [7, 60, 400])
@pytest.mark.parametrize("log_chance", [2.0, 6.0])
def test_a_mean_number_is_as_near_as_is_said(n: int, log_chance: float) -> None:
    """Exact, for coins of +1 and -1 or 0: the chance of all counts whose radius is too small."""
    counts = np.arange(n + 1)
    for low in (-1.0, 0.0):
        means, squares = low + (1 - low) * counts / n, low**2 + (1 - low**2) * counts / n
        radii = mean_radius(squares, 1.0, log_chance, n)
        worst = bare = 0.0
        for p in np.linspace(0.01, 0.99, 99):
            mass, off = binom.pmf(counts, n, p), np.abs(means - low - (1 - low) * p)
            worst = max(worst, float(mass[off > radii].sum()))
            bare = max(bare, float(mass[off > 0.05 * radii].sum()))
        assert worst <= 3 * exp(-log_chance)
        assert bare > 3 * exp(-log_chance)


@pytest.mark.parametrize("share", [0.02, 0.3, 1.0])
def test_a_mean_vector_is_as_near_as_is_said(share: float) -> None:
    rng = np.random.default_rng(3)
    runs, n, d, delta = 300, 300, 6, 0.3
    corners = rng.normal(size=(5, d))
    corners /= np.linalg.norm(corners, axis=1).max()
    expected = share * corners.mean(axis=0)
    missed = np.zeros(2)
    for _ in range(runs):
        y = corners[rng.integers(5, size=n)] * (rng.random(n) < share)[:, None]
        trace = np.vecdot(y, y).mean(keepdims=True)
        top = np.linalg.eigvalsh(y.T @ y / n)[-1:]
        error = np.linalg.norm(y.mean(axis=0) - expected)
        missed[0] += error > norm_radius(trace, top, 1.0, log(3 / delta), n)[0]
        missed[1] += error > 0.7 * np.sqrt(trace[0] / n)  # a mutant, which forgets the chance
    allowed = binom.ppf(1 - UNLIKELY, runs, delta)
    assert missed[0] <= allowed
    assert missed[1] > allowed


def test_a_branch_is_the_rollout_of_every_policy_that_follows_it() -> None:
    """The tree against policies rolled out one at a time with the same random numbers."""
    n = 300
    tree = _tree(n, 7)
    uniforms = np.random.default_rng(7).random((STAR.horizon + 1, n))
    simulator = tabular_simulator(STAR.dynamics)
    whole = []
    for policy in POLICIES:
        states, features = simulator.start(uniforms[0]), np.zeros((n, PHI.dimension))
        for h in range(STAR.horizon):
            features += PER_STEP[states, policy[states]]
            states = simulator.step(states, policy[states], uniforms[h + 1])
        whole.append(features)
    for base in (0, 9):
        y = relative_features(tree, candidate_actions(tree, 4)[base])
        for k, actions in enumerate(candidate_actions(tree, 4)):
            found = np.zeros((n, PHI.dimension))
            followed = follows(tree, actions)
            assert len(np.unique(tree.seeds[followed])) == followed.sum()
            found[tree.seeds[followed]] = y[followed]
            np.testing.assert_allclose(found, whole[k] - whole[base], atol=1e-12)
    summed = followed_sums(tree, 4, tree.features)
    np.testing.assert_allclose(summed[5] - summed[2], (whole[5] - whole[2]).sum(axis=0), atol=1e-9)


def _missed(estimate: Estimate, shrink: float = 1.0) -> tuple[bool, bool]:
    """Whether radii, and whether axes and rests, are too small for one of the pairs of four candidates and all."""
    ball = close = False
    for i in range(0, len(FEATURES), 5):
        off = (FEATURES - FEATURES[i]) - (estimate.features - estimate.features[i])
        errors = estimate.errors(i)
        ball |= bool((np.linalg.norm(off, axis=1) > shrink * errors.radii + 1e-9).any())
        axes, rest = errors.axes(np.arange(len(FEATURES)), PHI.dimension)
        lengths = np.linalg.norm(axes, axis=2)
        units = axes / np.maximum(lengths, 1e-12)[..., None]
        along = np.einsum("jkd,jd->jk", units, off)
        across = np.linalg.norm(off - np.einsum("jk,jkd->jd", along, units), axis=1)
        close |= bool((np.abs(along) > shrink * lengths + 1e-9).any() or (across > shrink * rest + 1e-9).any())
    return ball, close


def _coupled(n: int, seed: int, delta: float, merged: np.ndarray = NO_STATES) -> Estimate:
    tree, pilot = _tree(n, seed, merged), _tree(100, 1000 + seed, merged)
    return coupled_estimate(tree, pilot, STAR.n_actions, REACH, delta, merges=len(merged) > 0)


def _samples(n: int, seed: int, shared: bool) -> np.ndarray:
    """(K, n, d) features of rollouts of every policy, with common random numbers or without."""
    rng, simulator, found = np.random.default_rng(seed), tabular_simulator(STAR.dynamics), []
    same = rng.random((STAR.horizon + 1, n))
    for policy in POLICIES:
        uniforms = same if shared else rng.random((STAR.horizon + 1, n))
        states, features = simulator.start(uniforms[0]), np.zeros((n, PHI.dimension))
        for h in range(STAR.horizon):
            features += PER_STEP[states, policy[states]]
            states = simulator.step(states, policy[states], uniforms[h + 1])
        found.append(features)
    return np.array(found)


def _paired(n: int, seed: int, shared: bool, delta: float) -> Estimate:
    return paired_estimate(_samples(n, seed, shared), REACH, delta)


@pytest.mark.parametrize(
    "made",
    [
        lambda seed: _coupled(150, seed, 0.1),
        lambda seed: _paired(60, seed, True, 0.1),
        lambda seed: _paired(60, seed, False, 0.1),
    ],
    ids=["branching", "common random numbers", "independent"],
)
def test_errors_of_features_are_bounded_as_often_as_is_said(made: Callable[[int], Estimate]) -> None:
    """The chance that a sound bound fails this test is below UNLIKELY; one that forgets most of its width fails it."""
    runs, delta = 40, 0.1
    estimates = [made(seed) for seed in range(runs)]
    allowed = binom.ppf(1 - UNLIKELY, runs, delta)
    assert (np.sum([_missed(e) for e in estimates], axis=0) <= allowed).all()
    assert (np.sum([_missed(e, shrink=0.05) for e in estimates], axis=0) > allowed).all()


def test_rollouts_that_share_random_numbers_have_smaller_errors() -> None:
    together, alone = (_paired(2000, 1, shared, 0.01).errors(0) for shared in (True, False))
    assert (together.radii[1:] < alone.radii[1:]).all()


def test_across_the_long_axes_errors_are_much_smaller() -> None:
    errors = _coupled(20_000, 1, 0.01).errors(5)
    others = np.array([j for j in range(16) if j != 5])
    axes, rest = errors.axes(others, PHI.dimension)
    assert axes.shape == (15, 2, PHI.dimension)
    assert (rest < 0.75 * errors.radii[others]).all()
    assert (rest < 0.4 * errors.radii[others]).sum() >= 5


def test_policies_that_were_merged_lie_within_the_error_of_their_candidate() -> None:
    """The merged state is often visited: without the part for its visits the error would be too small."""
    merged = np.array([4])
    estimate = _coupled(20_000, 2, 0.01, merged)
    assert len(estimate.features) == 4
    exact = expected_features(STAR.dynamics, candidate_policies(_tree(1, 0, merged), RECORDED, 4), PHI)[0]
    stands_for = POLICIES[:, 3]  # the candidate that acts alike in the other open state
    distance = np.linalg.norm((FEATURES - exact[0]) - (estimate.features[stands_for] - estimate.features[0]), axis=1)
    errors = estimate.errors(0)
    visits = REACH * chance_bound(_tree(20_000, 2, merged).merged_visits, 20_000, 0.005)
    assert (distance <= errors.radii[stands_for]).all()
    assert (distance > errors.radii[stands_for] - visits).any()
    assert errors.radii[0] == pytest.approx(visits)
    assert (errors.axes(np.arange(4), PHI.dimension)[1] >= visits).all()


@pytest.mark.parametrize("embedding", ["state_action_counts", "state_counts"])
def test_candidates_are_kept_once_exactly_if_no_rollout_tells_them_apart(embedding: str) -> None:
    per_step = step_features(embedding, STAR)
    rng = np.random.default_rng(0)
    trees = tuple(branch(tabular_simulator(STAR.dynamics), RECORDED, NO_STATES, per_step, 15, rng) for _ in range(2))
    vectors = []
    for actions in candidate_actions(trees[0], 4):
        rows = []
        for tree in trees:
            own = np.zeros((tree.n, per_step.shape[2]))
            followed = follows(tree, actions)
            own[tree.seeds[followed]] = tree.features[followed]
            rows.append(own)
        vectors.append(np.concatenate(rows).ravel())
    kept = told_apart(trees, 4, rng)
    assert len(np.unique(np.array(vectors)[kept], axis=0)) == len(kept) == len(np.unique(vectors, axis=0))


def test_only_rare_states_are_merged() -> None:
    tree = _tree(2000, 5)
    assert not len(rarely_visited(tree, 4, 0.01))
    assert len(rarely_visited(tree, 4, 1.0)) >= 1


def test_a_bound_holds_for_all_features_within_the_error() -> None:
    """Adversarial: contenders are moved by the whole error in the direction that helps them, and rivals against it.

    Half of the contenders err along an axis too, which is longer than the ball.
    """
    rng = np.random.default_rng(4)
    truth, d, weight_bound, radius = np.array([0.8, -0.4, 0.3]), 3, 2.0, 0.1
    answers, evidence = Answers(d), Evidence([1.0, 4.0], d)
    for _ in range(60):
        x = rng.normal(size=d)
        evidence.tell(*answers.add(x, int(rng.random() < expit(x @ truth))))
    evidence.refit(answers, steps=6)
    region = likelihood_set(answers, evidence.value - log(20), weight_bound, np.zeros(d))
    assert region is not None
    estimated = 0.6 * rng.normal(size=(8, d))
    best = int((estimated @ truth).argmax())
    estimated[[0, best]] = estimated[[best, 0]]
    axes = 0.25 * rng.normal(size=(8, d)) * (np.arange(8) % 2)[:, None]
    broken = 0
    for direction in (region.interior, *rng.normal(size=(6, d))):
        ways = np.array([0] + [1, -1] * 3 + [1])[:, None]
        moved = estimated + ways * (
            radius * direction / np.linalg.norm(direction) + np.sign(axes @ direction)[:, None] * axes
        )
        wide = np.where(np.arange(8) > 0, radius + np.linalg.norm(axes, axis=1), 0.0)
        found = FeatureErrors(wide, lambda i: (axes[i][:, None], np.where(i > 0, radius, 0.0)))
        for errors in (lambda _, found=found: found, None):
            gap = Gap(estimated, weight_bound, 0.6, 0.5, errors=errors)
            gap.tighten(region)
            for k in range(1, 8):
                inside = [
                    {"type": "ineq", "fun": lambda w: answers.log_likelihood(w[None])[0] - region.level},
                    {"type": "ineq", "fun": lambda w: weight_bound**2 - w @ w},
                    {"type": "ineq", "fun": lambda w, k=k, moved=moved: (moved[k] - moved) @ w},
                ]
                v = moved[k] - moved[0]
                best_found = minimize(lambda w, v=v: -v @ w, region.interior, constraints=inside, method="SLSQP")
                if not best_found.success or min(np.min(part["fun"](best_found.x)) for part in inside) < -1e-6:
                    continue  # this contender is best nowhere in the set
                if errors is not None:
                    assert -best_found.fun <= gap.bounds[k] + 1e-4
                else:
                    broken += -best_found.fun > gap.bounds[k] + 1e-3
    assert broken  # what ignores the errors is noticed


def test_the_error_of_the_features_is_part_of_every_certificate() -> None:
    rng = np.random.default_rng(0)
    features, pool = rng.normal(size=(5, 3)), rng.normal(size=(40, 3))
    session = Elicitation(
        features, Ball(2.0), pool, 0.05, "1nats", rng, fresh=True, errors=ball_errors(np.full(5, 0.075))
    )
    while not session.done:
        question = session.ask()
        session.tell(question, int(rng.random() < expit(question.difference @ np.array([1.0, -0.5, 0.2]))))
    assert session.certified
    assert 0.3 <= session.certificate.gap <= 1
    assert session.certificate.needs_weight_bound  # the error is in nats over the ball


def test_errors_above_the_goal_end_a_session_before_it_asks() -> None:
    """The candidate that is recommended stands for policies that may be better by more than the goal."""
    rng = np.random.default_rng(0)
    features, pool = rng.normal(size=(5, 3)), rng.normal(size=(40, 3))
    errors = FeatureErrors(np.full(5, 0.3))
    session = Elicitation(features, Ball(2.0), pool, 0.05, "0.5nats", rng, errors=lambda _: errors)
    assert session.done
    assert not session.certified
    assert session.certificate.gap >= 0.6
    with pytest.raises(InputError, match="more rollouts"):
        session.ask()


def test_shares_of_estimated_features_are_refused() -> None:
    rng = np.random.default_rng(0)
    features, pool = rng.normal(size=(5, 3)), rng.normal(size=(40, 3))
    with pytest.raises(InputError, match="shares need exact features"):
        Elicitation(
            features, Ball(2.0), pool, 0.05, "1nats", rng, reference=features[0], errors=ball_errors(np.full(5, 0.1))
        )


def test_a_pool_shows_what_is_seldom_visited() -> None:
    rng = np.random.default_rng(0)
    drawn = sample_trajectories(make_mdp("gridworld"), np.full((16, 5), 0.2), 2000, rng)
    shown = varied(drawn, 5, 200)
    assert len(np.unique(shown)) == len(shown) == 200
    pairs = drawn.states * 5 + drawn.actions
    assert set(np.unique(pairs)) == set(np.unique(pairs[shown]))


def test_a_simulator_is_enough_to_certify() -> None:
    config = AskConfig("starmdp", dynamics="unknown")
    record = run_session(config, *prepare(config), 0)
    outcome = record["outcome"]
    assert record["configuration"]["dynamics"] == "unknown"
    assert outcome["questions"] is not None
    assert -1e-9 < outcome["true_gap"] <= outcome["certified_gap"] <= 0.5
    assert 7_000 < outcome["episodes"] < 100_000
    assert "equal random numbers give equal states" in record["claims"]["sentence"]
    assert run_session(config, *prepare(config), 0) == record


def test_where_dynamics_are_known_nothing_is_recorded_of_them() -> None:
    assert "dynamics" not in AskConfig("starmdp").record()


def test_the_command_line_counts_episodes(tmp_path: object, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["starmdp", "--dynamics", "unknown", "--seeds", "1", "--jobs", "1", "--out", str(tmp_path)]
    assert main(arguments) == 0
    assert "Features come from rollouts" in capsys.readouterr().out
    assert main([*arguments, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["median_episodes"] > 10_000


@pytest.mark.parametrize(
    ("changes", "words"),
    [({"dynamics": "guessed"}, "dynamics must be one of"), ({"until": "share=90%"}, "needs known dynamics")],
)
def test_a_wrong_setting_is_one_sentence(changes: dict[str, str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        AskConfig("starmdp", **({"dynamics": "unknown"} | changes))  # type: ignore[arg-type]
