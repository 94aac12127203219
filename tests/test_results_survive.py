"""Same seed, same numbers; killed runs resume; nothing written is lost, half-written or misread."""

import dataclasses
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from bridge_algos.envs.registry import make_mdp
from bridge_algos.mdp_file import save_mdp
from bridge_algos.netcdf import load_dataset
from bridge_algos.run.config import RunConfig, preset
from bridge_algos.run.runner import run
from bridge_algos.run.seed import run_seed
from bridge_algos.run.store import load_run, save_seed
from bridge_algos.run.summary import table
from bridge_algos.run.world import build_world
from bridge_theory.errors import InputError

SMALL = preset("published", "starmdp").but(rounds=4)
ROOT = Path(__file__).parent.parent


def same(first: xr.Dataset, second: xr.Dataset) -> bool:
    return first.drop_vars("seconds").identical(second.drop_vars("seconds"))


def test_numbers_do_not_depend_on_jobs(tmp_path: Path) -> None:
    one = run(SMALL, tmp_path / "one", seeds=3, jobs=1)
    two = run(SMALL, tmp_path / "two", seeds=3, jobs=2)
    assert same(one, two)
    assert one.sizes == {"seed": 3, "algorithm": 3, "round": 4}


def test_an_algorithms_numbers_do_not_depend_on_the_others() -> None:
    world = build_world(SMALL)
    together = run_seed(SMALL, world, 5)
    alone = run_seed(SMALL.but(algorithms=("pbrl",)), world, 5)
    np.testing.assert_array_equal(
        together.suboptimality.sel(algorithm="pbrl"), alone.suboptimality.sel(algorithm="pbrl")
    )


def test_seeds_differ() -> None:
    world = build_world(SMALL)
    assert not same(run_seed(SMALL, world, 0).drop_vars("seed"), run_seed(SMALL, world, 1).drop_vars("seed"))


def test_a_result_carries_its_configuration_seed_versions_and_units(tmp_path: Path) -> None:
    dataset = run_seed(SMALL, build_world(SMALL), 7)
    save_seed(tmp_path, dataset)
    with xr.open_dataset(tmp_path / "seed-00007.nc", engine="h5netcdf") as stored:
        assert RunConfig.from_json(stored.attrs["configuration"]) == SMALL
        assert "numpy" in stored.attrs["versions"]
        assert int(stored.seed) == 7
        assert all("units" in stored[name].attrs for name in stored.data_vars)
        assert dataset.identical(stored.load())


def test_a_killed_run_resumes_to_the_same_numbers(tmp_path: Path) -> None:
    config = SMALL.but(rounds=40)
    whole = run(config, tmp_path / "whole", seeds=6)
    directory = tmp_path / "killed"
    program = (
        "from pathlib import Path\n"
        "from bridge_algos.run.config import preset\n"
        "from bridge_algos.run.runner import run\n"
        f"run(preset('published', 'starmdp').but(rounds=40), Path({str(directory)!r}), seeds=6)"
    )
    process = subprocess.Popen([sys.executable, "-c", program], cwd=ROOT)
    try:
        deadline = time.monotonic() + 60
        while not list(directory.glob("seed-*.nc")) and time.monotonic() < deadline:
            time.sleep(0.005)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
    done = {path.name: path.read_bytes() for path in directory.glob("seed-*.nc")}
    assert 1 <= len(done) < 6
    resumed = run(config, directory, seeds=6)
    assert {name: (directory / name).read_bytes() for name in done} == done
    assert same(whole, resumed)


def test_more_seeds_extend_a_run(tmp_path: Path) -> None:
    run(SMALL, tmp_path, seeds=1)
    first = (tmp_path / "seed-00000.nc").read_bytes()
    assert run(SMALL, tmp_path, seeds=2).sizes["seed"] == 2
    assert (tmp_path / "seed-00000.nc").read_bytes() == first


def test_fewer_seeds_than_stored_are_shown_alone(tmp_path: Path) -> None:
    stored = run(SMALL, tmp_path, seeds=3)
    asked = run(SMALL, tmp_path, seeds=2)
    assert asked.seed.values.tolist() == [0, 1]
    assert "2 seeds" in asked.attrs["title"]
    np.testing.assert_array_equal(asked.suboptimality, stored.suboptimality.sel(seed=[0, 1]))
    assert load_run(tmp_path).sizes["seed"] == 3


def test_another_configuration_does_not_overwrite(tmp_path: Path) -> None:
    run(SMALL, tmp_path, seeds=1)
    with pytest.raises(InputError, match="another configuration"):
        run(SMALL.but(rounds=5), tmp_path, seeds=1)
    assert load_run(tmp_path).sizes["round"] == 4


def test_damaged_files_are_named_and_kept(tmp_path: Path) -> None:
    run(SMALL, tmp_path, seeds=2)
    victim = tmp_path / "seed-00001.nc"
    damaged = victim.read_bytes()[:1000]
    victim.write_bytes(damaged)
    for attempt in (lambda: load_run(tmp_path), lambda: run(SMALL, tmp_path, seeds=3)):
        with pytest.raises(InputError, match=r"seed-00001.nc is not a readable result file"):
            attempt()
    assert victim.read_bytes() == damaged
    assert not (tmp_path / "seed-00002.nc").exists()


def test_a_file_of_another_program_is_named(tmp_path: Path) -> None:
    run(SMALL, tmp_path, seeds=1)
    with h5py.File(tmp_path / "seed-00000.nc", "w") as file:
        file["x"] = np.arange(3)
        file["x"].attrs["DIMENSION_LIST"] = "none"
    with pytest.raises(InputError, match=r"seed-00000.nc is not a readable result file"):
        load_run(tmp_path)


def test_a_changed_file_is_another_configuration(tmp_path: Path) -> None:
    mdp, path = make_mdp("starmdp"), tmp_path / "mine.npz"
    config = preset("theory", str(path)).but(rounds=2, algorithms=("bc",))
    save_mdp(path, mdp)
    run(config, tmp_path / "run", seeds=1)
    save_mdp(path, dataclasses.replace(mdp, reward=100 * mdp.reward))
    with pytest.raises(InputError, match="another configuration"):
        run(config, tmp_path / "run", seeds=1)


def test_a_copy_does_not_count_as_another_seed(tmp_path: Path) -> None:
    run(SMALL, tmp_path, seeds=1)
    (tmp_path / "seed-00001.nc").write_bytes((tmp_path / "seed-00000.nc").read_bytes())
    with pytest.raises(InputError, match=r"seed-00001.nc holds seed 0"):
        load_run(tmp_path)


def test_logs_of_another_configuration_are_not_taken_over(tmp_path: Path) -> None:
    config = preset("theory", "starmdp").but(rounds=2, algorithms=("bridge-known",))
    run(config, tmp_path, seeds=1, log=True)
    (tmp_path / "seed-00000.nc").unlink()
    with pytest.raises(InputError, match="another configuration"):
        run(config.but(lam=2.0), tmp_path, seeds=1)


def test_seeds_that_describe_their_experts_differently_are_shown(tmp_path: Path) -> None:
    stored = run(SMALL, tmp_path, seeds=2)
    assert stored.attrs["expert"] in table(stored)
    second = load_dataset(tmp_path / "seed-00001.nc", "")
    save_seed(tmp_path, second.assign_attrs(expert="Another vertex."))
    assert "describe their experts differently" in table(load_run(tmp_path))


def test_strange_files_and_empty_directories_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no results"):
        load_run(tmp_path)
    (tmp_path / "seed-one.nc").write_text("")
    with pytest.raises(InputError, match="seed-NUMBER"):
        load_run(tmp_path)


def test_an_error_while_writing_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from bridge_algos import files

    target = tmp_path / "kept.txt"
    files.atomic_write_text(target, "old")

    def write_half() -> None:
        with files.atomic_write(target) as handle:
            handle.write(b"ne")
            raise RuntimeError("half way")

    with pytest.raises(RuntimeError, match="half way"):
        write_half()
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]
