"""The study of what lies between our StarMDP curves and the published ones changes only what each variant names."""

from pathlib import Path

import numpy as np
import pytest

from bridge_algos.online.loop import OnlineProblem
from bridge_algos.policies import all_policies
from bridge_algos.run.config import preset
from bridge_algos.run.seed import run_seed
from bridge_algos.run.world import build_oracle, build_world
from experiments.published import ALGORITHMS
from experiments.reproduce import configuration
from experiments.studies.differences import _real_scores, _until_decided, compute, expert_conventions, words
from experiments.studies.differences_report import agreeing_rounds_of, effect, total


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
    assert (data.clipped >= data.exact).all()


def test_a_variant_that_options_can_express_equals_them(data) -> None:
    config = preset("published", "starmdp").but(algorithms=ALGORITHMS, fit="exact")
    run = run_seed(config, build_world(config), 1)
    np.testing.assert_array_equal(data.exact.sel(variant="weights at their optimum").isel(seed=1), run.suboptimality)


def test_effects_and_agreement_are_counted_right(data) -> None:
    assert effect(data, "as documented", "bridge").mean == 0
    difference = effect(data, "observed data matrix", "pbrl").mean
    totals = (total(data, name, "pbrl").mean for name in ("observed data matrix", "as documented"))
    assert difference == pytest.approx(next(totals) - next(totals))
    regret, sizes = agreeing_rounds_of(data, "as documented", "pbrl")
    assert 0 <= regret <= 25
    assert 1 <= sizes <= 25  # the first round's 1024 is exact in both


def test_every_variant_of_the_configuration_is_distinct_and_playable() -> None:
    known = {"config", "learner", "confidence", "reward", "features", "lent", "without", "scored", "counted"}
    variants = configuration("published-differences")["settings"]["variants"]
    assert len({repr(changes) for changes in variants.values()}) == len(variants)
    for changes in variants.values():
        assert set(changes) <= known
        preset("published", "starmdp").but(**changes.get("config", {}))


def test_conventions_of_the_experts_return() -> None:
    values = expert_conventions(0.99)
    assert values["published: as recorded here, H rewards on arrival"] == pytest.approx(46.09662543)
    assert values["published: H - 1 rewards (no arrival after the last action)"] == pytest.approx(39.796, abs=1e-3)
    assert values["text: mean reward of a step, long run"] == pytest.approx(10, abs=0.01)


def test_words_name_what_remains(data, tmp_path: Path) -> None:
    text = words(data)
    for part in ("as documented", "21.12 ± 4.51", "agree with both published totals", "24.649", "Not stated"):
        assert part in text


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
