"""Same seed, same numbers, whatever the threads and processes; killed runs resume in the middle of a seed."""

import json
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

pytest.importorskip("mujoco", reason="continuous control needs MuJoCo, of the extra 'continuous'")
pytest.importorskip("torch", reason="cloning needs torch, of the extra 'continuous'")

from bridge_algos.continuous import features as features_module
from bridge_algos.continuous.config import ContinuousConfig, continuous_preset
from bridge_algos.continuous.environments import draw_starts, make_environment
from bridge_algos.continuous.experts import load_expert, shipped_path
from bridge_algos.continuous.offline import demonstrations_and_clone, offline_stage
from bridge_algos.continuous.policy_files import save_policy
from bridge_algos.continuous.rollouts import rollout
from bridge_algos.continuous.seed import run_seed
from bridge_algos.netcdf import load_dataset, save_dataset
from bridge_algos.run.configuration import read_configuration
from bridge_algos.run.runner import run
from bridge_algos.run.store import load_run
from bridge_algos.run.streams import stream
from bridge_theory.errors import InputError

ROOT = Path(__file__).parent.parent
TINY = continuous_preset("published", "reacher").but(
    n_demonstrations=3, held_out=2, epochs=2, small=4, large=5, rollouts=6, rounds=4, comparisons=2, horizon=12
)


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("BRIDGE_RL_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(features_module, "CHUNK", 4)
    return tmp_path / "cache"


def same(first: xr.Dataset, second: xr.Dataset) -> bool:
    return first.drop_vars("seconds").identical(second.drop_vars("seconds"))


def test_numbers_do_not_depend_on_threads_processes_or_the_cache(tmp_path: Path) -> None:
    one = run_seed(TINY, 3, cache=None, threads=1)
    two = run_seed(TINY, 3, cache=None, threads=2)
    cached = run_seed(TINY, 3, cache=tmp_path / "cache", threads=2)
    again = run_seed(TINY, 3, cache=tmp_path / "cache", threads=1)
    assert same(one, two)
    assert same(one, cached)
    assert same(one, again)
    assert not same(one.drop_vars("seed"), run_seed(TINY, 4, cache=None).drop_vars("seed"))
    whole = run(TINY, tmp_path / "run", seeds=2, jobs=2)
    assert same(whole, run(TINY, tmp_path / "serial", seeds=2, jobs=1))


def test_the_expert_is_no_candidate_unless_asked_and_both_share_the_rollouts(own_cache: Path) -> None:
    excluded = run_seed(TINY, 0, cache=own_cache)
    files = sorted(own_cache.rglob("*.npz"))
    included = run_seed(TINY.but(include_expert=True), 0, cache=own_cache)
    assert sorted(own_cache.rglob("*.npz")) == files
    assert len(files) == 3  # 11 policies with the expert, 4 a file
    assert TINY.include_expert is False
    assert continuous_preset("published", "ant").include_expert is False
    everyone = 1 + TINY.small + TINY.large
    assert float(excluded.set_size.sel(algorithm="pbrl")[0]) == everyone
    assert float(included.set_size.sel(algorithm="pbrl")[0]) == everyone + 1
    for name in ("first", "second", "greedy"):
        assert float(excluded[name].max()) < everyone
    assert "not a candidate" in excluded.attrs["expert"]
    assert "not a candidate" not in included.attrs["expert"]
    for shared in ("expert_return", "clone_return", "expert_distance", "observed_bound"):
        assert float(excluded[shared]) == float(included[shared])


def test_regret_is_judged_on_fresh_starts_and_also_read_as_published(tmp_path: Path) -> None:
    result, stage = run_seed(TINY, 1, cache=None), offline_stage(TINY, 1, cache=None)
    returns = stage.features.returns.mean(axis=1)
    fresh = draw_starts(stage.environment, TINY.rollouts, stream(1, "judge"))
    sources = stream(1, "starts").spawn(len(stage.candidates))
    for candidate, policy in enumerate(stage.candidates):
        own = draw_starts(stage.environment, TINY.rollouts, sources[candidate])
        seen = rollout(stage.environment, policy, own, horizon=TINY.horizon).returns
        np.testing.assert_array_equal(seen, stage.features.returns[candidate])
        assert not np.isin(fresh.seeds, own.seeds).any(), "a start that made features also judges"

    def judged(index: int) -> float:
        return float(rollout(stage.environment, stage.candidates[index], fresh, horizon=TINY.horizon).returns.mean())

    expert = judged(len(stage.candidates) - 1)
    assert "pseudo_regret" not in result, "the pairs played are not judged, and what was seen of them is no regret"
    for name in ("bridge", "pbrl"):
        own = result.sel(algorithm=name)
        chosen = own.greedy.astype(int)
        np.testing.assert_allclose(own.suboptimality_seen, returns[-1] - returns[chosen], rtol=1e-12)
        by_hand = [expert - judged(int(index)) for index in chosen]
        np.testing.assert_allclose(own.suboptimality, by_hand, rtol=1e-9)
        searched = np.flatnonzero(stage.in_ball[:-1]) if name == "bridge" else np.arange(len(returns) - 1)
        looked_best = int(searched[returns[searched].argmax()])
        assert float(own.best_candidate) == pytest.approx(expert - judged(looked_best), rel=1e-9)
        assert bool((own.suboptimality_error > 0).all())
    inside = np.linalg.norm(stage.features.mean - stage.features.mean[0], axis=1) < TINY.radius
    assert float(result.offline_set_count) == inside[:-1].sum()


def test_a_learner_with_one_candidate_has_no_regret_against_it(own_cache: Path) -> None:
    alone = run_seed(TINY.but(radius=1e-9, rollouts=20), 0, cache=own_cache)
    for name in ("bridge", "bc"):
        own = alone.sel(algorithm=name)
        np.testing.assert_allclose(own.suboptimality, own.best_candidate, rtol=0, atol=1e-12)
        np.testing.assert_allclose(own.suboptimality, alone.expert_return - alone.clone_return, rtol=1e-9)


def test_seeds_with_a_record_that_is_no_longer_kept_still_load(tmp_path: Path) -> None:
    run(TINY, tmp_path / "run", seeds=1)
    path = next((tmp_path / "run").glob("seed-*.nc"))
    new = load_dataset(path, "")
    save_dataset(path, new.assign(pseudo_regret=new.suboptimality))
    both = run(TINY, tmp_path / "run", seeds=2)
    assert both.sizes["seed"] == 2
    for name in new.data_vars:
        np.testing.assert_array_equal(both[name].sel(seed=0), new[name])


def test_results_of_another_meaning_are_not_mixed_in(tmp_path: Path) -> None:
    run(TINY, tmp_path / "run", seeds=1)
    path = next((tmp_path / "run").glob("seed-*.nc"))
    old = load_dataset(path, "")
    save_dataset(path, old.assign_attrs(format=1))
    with pytest.raises(InputError, match="version of this package that defines numbers otherwise"):
        run(TINY, tmp_path / "run", seeds=2)


def test_a_killed_run_resumes_in_the_middle_of_a_seed(tmp_path: Path) -> None:
    config = TINY.but(rollouts=50, horizon=50)
    whole = run(config, tmp_path / "whole", seeds=2)
    whole_files = {path.name: path.read_bytes() for path in (tmp_path / "cache").rglob("*.npz")}
    program = (
        "from pathlib import Path\n"
        "from bridge_algos.continuous import features\n"
        "from bridge_algos.run.configuration import read_configuration\n"
        "from bridge_algos.run.runner import run\n"
        "features.CHUNK = 4\n"
        f"run(read_configuration({config.to_json()!r}), Path({str(tmp_path / 'killed')!r}), seeds=2)"
    )
    cache = tmp_path / "killed-cache"
    process = subprocess.Popen(
        [sys.executable, "-c", program], cwd=ROOT, env={**_environment(), "BRIDGE_RL_CACHE": str(cache)}
    )
    try:
        deadline = time.monotonic() + 120
        while not list(cache.rglob("[0-9a-f]*.npz")) and time.monotonic() < deadline:
            time.sleep(0.002)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
    kept = {path.name: path.stat().st_mtime_ns for path in cache.rglob("[0-9a-f]*.npz")}
    assert 1 <= len(kept) < len(whole_files)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("BRIDGE_RL_CACHE", str(cache))
        resumed = run(config, tmp_path / "killed", seeds=2)
    after = {path.name: path for path in cache.rglob("[0-9a-f]*.npz")}
    assert {name: after[name].stat().st_mtime_ns for name in kept} == kept
    assert {name: path.read_bytes() for name, path in after.items()} == whole_files
    assert same(whole, resumed)


def _environment() -> dict[str, str]:
    import os

    return dict(os.environ)


def test_a_result_carries_its_configuration(tmp_path: Path) -> None:
    run(TINY, tmp_path / "run", seeds=1)
    stored = load_run(tmp_path / "run")
    described = read_configuration(stored.attrs["configuration"])
    assert isinstance(described, ContinuousConfig)
    assert described.expert_digest is not None
    assert described.but(expert_digest=None) == TINY
    with pytest.raises(InputError, match="the expert 'reacher-zoo' has changed"):
        run(TINY.but(expert_digest="0"), tmp_path / "run", seeds=1)
    assert isinstance(read_configuration(TINY.to_json()), ContinuousConfig)
    assert all("units" in stored[name].attrs for name in stored.data_vars)
    with pytest.raises(InputError, match="another configuration"):
        run(TINY.but(gamma=1.0), tmp_path / "run", seeds=1)


def test_the_clone_standardises_by_the_chosen_statistics(own_cache: Path) -> None:
    _, expert, demonstrations, _ = demonstrations_and_clone(TINY, 0, own_cache)
    seen = demonstrations.observations[:, :-1][demonstrations.mask]
    for choice, mean in (("expert", expert.observation_mean), ("demonstrations", seen.mean(axis=0)), ("none", None)):
        config = TINY.but(normalise_observations=choice)
        cloned = demonstrations_and_clone(config, 0, own_cache)[3].policy
        if mean is None:
            assert cloned.observation_mean is None
        else:
            np.testing.assert_array_equal(cloned.observation_mean, mean)
    raw = own_cache / "raw.safetensors"
    save_policy(raw, replace(expert, observation_mean=None, observation_scale=None), {})
    assert demonstrations_and_clone(TINY.but(expert=str(raw)), 0, own_cache)[3].policy.observation_mean is None


def test_policies_with_their_own_starts_differ_by_luck_alone(own_cache: Path) -> None:
    """Features from own and from common starts agree within twelve joint standard errors, and differ."""
    common, own = (offline_stage(TINY.but(common_starts=c), 0, cache=own_cache).features for c in (True, False))
    joint = np.hypot(common.standard_error, own.standard_error)
    assert not np.array_equal(common.mean, own.mean)
    assert np.all(np.abs(common.mean - own.mean) <= 12 * joint + 1e-12)
    target = slice(4, 6)  # where Reacher's target is
    assert np.ptp(common.mean[:, target], axis=0).max() == 0 < np.ptp(own.mean[:, target], axis=0).min()


def test_damaged_features_are_named(own_cache: Path) -> None:
    run_seed(TINY, 0, cache=own_cache)
    victim = sorted(own_cache.rglob("*.npz"))[0]
    victim.write_bytes(victim.read_bytes()[:500])
    with pytest.raises(InputError, match=f"{victim.name} does not hold what was kept there; delete it"):
        run_seed(TINY, 0, cache=own_cache)


def test_damaged_clones_are_named(own_cache: Path) -> None:
    whole_result = run_seed(TINY, 0, cache=own_cache)
    card = next((own_cache / "clones").glob("*.json"))
    whole = card.read_text()
    other = next((own_cache / "clones").glob("*.safetensors"))
    for lost in (card, other):
        lost.unlink()
        assert same(run_seed(TINY, 0, cache=own_cache), whole_result), "half a clone is no clone: it is fitted again"
    for damaged in (
        "{}",
        "[1]",
        whole.replace('"likelihood": [', '"likelihood": ["x", '),
        whole.replace("policy", "p"),
    ):
        card.write_text(damaged)
        with pytest.raises(InputError, match=f"{other.name} and its card do not hold .* delete both"):
            run_seed(TINY, 0, cache=own_cache)
    card.write_text(whole)
    save_policy(other, load_expert("reacher", make_environment("reacher")), json.loads(whole))
    with pytest.raises(InputError, match="delete both"):
        run_seed(TINY, 0, cache=own_cache)
    other.write_bytes(b"nothing")
    with pytest.raises(InputError, match="delete both"):
        run_seed(TINY, 0, cache=own_cache)


def test_users_own_environments_are_not_cached(own_cache: Path) -> None:
    """The same id may stand for another reward the next time."""
    import gymnasium

    expert = str(shipped_path("reacher"))
    returns = []
    for weight in (1, 100):
        gymnasium.register(
            "MineOfTheTest-v0",
            "gymnasium.envs.mujoco.reacher_v5:ReacherEnv",
            max_episode_steps=50,
            kwargs={"reward_dist_weight": weight},
        )
        try:
            config = TINY.but(environment="MineOfTheTest-v0", expert=expert)
            returns.append(offline_stage(config, 0, cache=own_cache).features.returns[-1].mean())
        finally:
            del gymnasium.registry["MineOfTheTest-v0"]
    assert returns[1] < 10 * returns[0]
    assert not list((own_cache / "features").rglob("*.npz"))


def test_every_embedding_rule_and_fit_runs(own_cache: Path) -> None:
    for changes in (
        {"embedding": "final_state", "pair_rule": "ucb"},
        {"embedding": "reacher_reward", "normalise_embedding": True, "pair_rule": "greedy_vs_random"},
        {"fit": "exact", "lam": 0.1, "until_decided": False},
        {"oracle_options": {"mistakes": 0.2}, "normalise_observations": "none"},
        {"common_starts": False, "normalise_observations": "demonstrations"},
    ):
        result = run_seed(TINY.but(**changes), 0, cache=own_cache)
        assert bool(np.isfinite(result.suboptimality).all())
    mine = run_seed(TINY.but(embedding="mine"), 0, cache=own_cache, user=lambda e: e.final_observations[:, 8:10])
    assert bool(np.isfinite(mine.suboptimality).all())
