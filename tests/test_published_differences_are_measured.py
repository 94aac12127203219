"""The study of what lies between our StarMDP curves and the published ones changes only what each variant names."""

import re
from pathlib import Path

import numpy as np
import pytest

from bridge_algos.mdp import FloatArray
from bridge_algos.online.loop import OnlineProblem
from bridge_algos.policies import all_policies
from bridge_algos.run.config import preset
from bridge_algos.run.seed import run_seed
from bridge_algos.run.world import World, build_oracle, build_world
from bridge_algos.trajectories import sample_trajectories
from experiments.published import ALGORITHMS, published_curves, published_return
from experiments.reproduce import configuration, reproduce
from experiments.studies.differences import _real_scores, _until_decided, compute, words
from experiments.studies.differences_report import agreeing_sizes, effect, total


@pytest.fixture(scope="module")
def settings():
    return configuration("published-differences", quick=True)["settings"]


@pytest.fixture(scope="module")
def data(settings, tmp_path_factory):
    return compute(settings, tmp_path_factory.mktemp("differences"), jobs=1)


def test_the_documented_variant_is_the_published_preset(data) -> None:
    config = preset("published", "starmdp").but(algorithms=ALGORITHMS)
    world = build_world(config)
    for seed in range(2):
        run = run_seed(config, world, seed)
        ours = data.sel(variant="as documented").isel(seed=seed)
        np.testing.assert_array_equal(ours.exact, run.suboptimality)
        np.testing.assert_array_equal(ours.set_size, run.set_size)
        np.testing.assert_array_equal(ours.before[:, 1:], run.suboptimality[:, :-1])


def test_a_variant_that_options_can_express_equals_them(data) -> None:
    config = preset("published", "starmdp").but(algorithms=ALGORITHMS, fit="exact")
    run = run_seed(config, build_world(config), 1)
    np.testing.assert_array_equal(data.exact.sel(variant="weights at their optimum").isel(seed=1), run.suboptimality)


def test_effects_and_agreement_are_counted_right(data) -> None:
    assert effect(data, "as documented", "bridge").mean == 0
    difference = effect(data, "observed data matrix", "pbrl").mean
    totals = (total(data, name, "pbrl").mean for name in ("observed data matrix", "as documented"))
    assert difference == pytest.approx(next(totals) - next(totals))
    assert 1 <= agreeing_sizes(data, "as documented", "pbrl") <= 25  # the first round's 1024 is exact in both


def test_every_variant_of_the_configuration_is_distinct_and_playable() -> None:
    known = {"config", "learner", "confidence", "reward", "features", "lent", "without", "scored", "counted"}
    variants = configuration("published-differences")["settings"]["variants"]
    assert len({repr(changes) for changes in variants.values()}) == len(variants)
    for changes in variants.values():
        assert set(changes) <= known
        preset("published", "starmdp").but(**changes.get("config", {}))


def test_the_published_expert_return_is_one_return_averaged_with_ones(settings) -> None:
    """The sum over t < H of 0.99^(3t) r(s_t), and 1 in each of the 228 entries after a seed had stopped."""
    curves = published_curves("starmdp")
    running, stopped = curves["expert_return_while_running"], curves["stopped"]["bridge"]
    share = stopped["stopped_entries"] / stopped["entries"]
    assert (1 - share) * running + share == pytest.approx(curves["expert_return"], abs=1e-5)
    world = build_world(preset("published", "starmdp"))
    exact = published_return(world.mdp, world.expert.policy)
    returns = np.array([_published_return_of(run) for run in _rewards_on_leaving(world, 4000)])
    assert exact == pytest.approx(34.9577, abs=5e-5)
    error = returns.std(ddof=1)
    assert abs(returns.mean() - exact) < 5 * error / np.sqrt(len(returns)), "false alarm less often than once in 10^6"
    episodes = 1000 * (stopped["entries"] - stopped["stopped_entries"])
    assert abs(running - exact) < 5 * error / np.sqrt(episodes), "theirs are means of 1000 rollouts each"


def _rewards_on_leaving(world: World, n: int) -> FloatArray:
    states = sample_trajectories(world.mdp, world.expert.policy, n, np.random.default_rng(5)).states
    return world.mdp.reward[states]


def _published_return_of(rewards: FloatArray) -> float:
    return sum(0.99 ** (3 * step) * reward for step, reward in enumerate(rewards))


def test_words_state_the_unit_and_compare_no_regret_across_units(data) -> None:
    text = words(data)
    for part in ("as documented", "21.12 ± 4.51", "a unit of its own", "0.99^(3t)", "228 of 750", "Not stated"):
        assert part in text
    for claim in ("clipped at zero", "agree with both", "24.649", "unexplained"):
        assert claim not in text


def test_the_text_of_the_figure_shows_both_regrets_and_compares_neither(tmp_path: Path) -> None:
    text = reproduce("fig2-starmdp", configuration("fig2-starmdp", quick=True, seeds=2), tmp_path, jobs=1)
    for name in ("BRIDGE", "PbRL"):
        assert re.search(rf"{name}, last cumulative regret: published .* in their unit, ours .*: not compared\.", text)
        assert re.search(rf"{name}, last \|Pi_t\|: published .* (agree|apart|lower|higher)", text)
    assert "a unit of its own" in text
    assert "34.98 while a run goes on and 1 after it stopped; exact in their unit 34.96, in ours 46.10" in text
    assert "clipped at zero" not in text


def test_a_stopped_seed_is_padded_with_zeros_as_in_the_public_code() -> None:
    found, size = _until_decided(np.array([3.0, 2.0, 1.0, 4.0]), np.array([5, 1, 2, 1]))
    assert found.tolist() == [3.0, 2.0, 0.0, 0.0]
    assert size.tolist() == [5, 1, 1, 1]


def test_scores_under_the_real_dynamics_are_estimated_by_rollouts() -> None:
    config = preset("published", "starmdp")
    world = build_world(config)
    problem = OnlineProblem(world.mdp, world.embedding, build_oracle(config, world), world.optimum, 0.0)
    policies, w = all_policies(5, 4)[:50], np.random.default_rng(3).normal(size=9)
    exact = _real_scores(problem, policies, None, np.random.default_rng(0), w)
    sampled = _real_scores(problem, policies, 4000, np.random.default_rng(0), w)
    assert np.abs(exact - sampled).max() < 0.5
    assert np.abs(exact - sampled).max() > 0
