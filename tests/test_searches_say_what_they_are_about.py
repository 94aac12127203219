"""A run that searches a part of its set, or the clone alone, says so in its table, data, log and figure."""

import json

import numpy as np
import pytest
import xarray as xr

from bridge_algos.run import candidates
from bridge_algos.run.candidates import ENOUGH, EXHAUSTIVE, WAYS, offline_candidates, search_lines, sentence
from bridge_algos.run.config import RunConfig, preset
from bridge_algos.run.log import logged_seed
from bridge_algos.run.offline import offline_stage
from bridge_algos.run.plots import figure
from bridge_algos.run.seed import run_seed
from bridge_algos.run.summary import table
from bridge_algos.run.world import build_world
from experiments.compare.applicability import _of_the_search
from experiments.compare.subject import Subject


def garnet(n_states: int, **changes: object) -> RunConfig:
    options = {"n_states": n_states, "n_actions": 4, "branching": 3, "horizon": 10}
    return preset("published", "garnet").but(
        environment_options=options, rounds=2, n_demonstrations=5, proposals=20_000, candidate_limit=200, **changes
    )


def runs(config: RunConfig, seeds: int = 2) -> xr.Dataset:
    world = build_world(config)
    together = xr.concat(
        [run_seed(config, world, seed) for seed in range(seeds)], "seed", combine_attrs="drop_conflicts"
    )
    return together.assign_attrs(title="garnet")


def labels(results: xr.Dataset) -> list[str]:
    return figure(results).axes[0].get_legend_handles_labels()[1]


def test_without_acceptances_bridge_is_the_clone_and_says_so() -> None:
    config = garnet(36, candidates="rejection", radius=0.5)
    results = runs(config)
    bridge = results.sel(algorithm="bridge")
    assert bridge.searched.values.tolist() == [1, 1]
    np.testing.assert_allclose(bridge.suboptimality, results.suboptimality.sel(algorithm="bc"))
    told = table(results)
    assert "bridge is only about 1 candidate: the clone alone: none of the random policies proposed lies" in told
    assert "use --set candidates=exact" in told
    assert "nan" not in told
    assert "BRIDGE, the clone alone" in labels(results)


def test_a_few_acceptances_are_joined_by_the_clone() -> None:
    config = garnet(16, candidates="rejection", radius=0.9)
    stage = offline_stage(config, build_world(config), 0)
    found = offline_candidates(config, stage.offline_set, np.random.default_rng(0))
    assert found.way == "few"
    assert 0 < found.accepted < ENOUGH
    assert (found.policies == stage.clone).all(axis=1).any()
    assert "use --set candidates=exact" in table(runs(config))


def test_a_set_that_cannot_be_listed_is_sampled_by_a_chain_which_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bridge_algos.offline.ball_cubes.WORK_LIMIT", 1e6)
    config = garnet(25, candidates="exact")
    results = runs(config)
    assert results.search_way.sel(algorithm="bridge").values.tolist() == ["chain"] * 2
    assert results.searched.sel(algorithm="bridge").values.tolist() == [200] * 2
    told = table(results)
    assert "bridge is only about 200 candidates: members of the offline set that a Gibbs chain found" in told
    assert "(32 chains, 20 sweeps before the first, then " in told
    assert "too many states to count its policies" in told
    assert "pbrl is only about" in told
    assert "nan" not in told
    assert "BRIDGE, about 200 candidates" in labels(results)
    world = build_world(config)
    stage = offline_stage(config, world, 0)
    found = offline_candidates(config, stage.offline_set, np.random.default_rng(0))
    assert stage.offline_set.contains(found.policies).all()
    assert (found.policies == stage.clone).all(axis=1).any()
    log = logged_seed(config.but(algorithms=("bridge",)), world, 0)[1]
    assert log.header["search"]["bridge"].startswith("about 200 candidates: members of the offline set")


def test_a_sample_of_a_listed_set_keeps_the_clone() -> None:
    config = garnet(8, candidates="exact", radius=0.99).but(candidate_limit=50)
    stage = offline_stage(config, build_world(config), 0)
    found = offline_candidates(config, stage.offline_set, np.random.default_rng(0))
    assert found.way == "sample"
    assert len(np.unique(found.policies, axis=0)) == len(found.policies) <= 50
    assert (found.policies == stage.clone).all(axis=1).any()


def test_a_whole_set_needs_no_reservation() -> None:
    results = runs(preset("published", "starmdp").but(rounds=2))
    told = table(results)
    assert "every policy of the offline set" in told
    assert "pbrl searches 1,024 candidates: all policies" in told
    assert "only about" not in told
    assert {"BRIDGE", "PbRL"} <= set(labels(results))


def test_compare_does_not_take_a_sample_for_the_set(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bridge_algos.offline.ball_cubes.WORK_LIMIT", 1e6)
    config = garnet(25, candidates="exact").but(algorithms=("bridge",))
    results = runs(config)
    assert bool(results.offline_set_count.isnull().all())
    subject = Subject("bridge", config, build_world(config), results.sel(algorithm="bridge"), np.array([2]), "x", "")
    assert "only a sample of the offline set was searched" in _of_the_search(subject)


def test_every_way_is_told_and_recorded_with_its_meaning() -> None:
    for way in WAYS:
        found = candidates.Candidates(np.zeros((3, 2), dtype=np.int64), way, accepted=2, sweeps=7)
        kept = xr.Dataset(candidates.recorded({"bridge": found})).assign_coords(algorithm=["bridge"])
        (line,) = search_lines(kept.expand_dims("seed"))
        assert WAYS[way] in line
        assert WAYS[way] in sentence(found)
        assert ("only about" in line) == (way not in EXHAUSTIVE)
        assert json.loads(kept.search_way.attrs["meanings"])[way] == WAYS[way]
