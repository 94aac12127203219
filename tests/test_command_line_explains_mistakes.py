"""A user's mistake ends in one sentence on standard error and exit status 2, never in a traceback."""

import errno
import json
import re
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bridge_algos.envs.registry import make_mdp
from bridge_algos.mdp_file import load_mdp, save_mdp
from bridge_algos.trajectories import Trajectories, sample_trajectories, save_trajectories
from experiments.cli import SUBCOMMANDS, main

FAST = ["--seeds", "1", "--rounds", "2", "--jobs", "1"]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["fly"], "unknown subcommand 'fly'"),
        (["run"], "the following arguments are required: environment"),
        (["run", "starmpd"], "did you mean 'starmdp'"),
        (["run", "starmdp", "--preset", "fast"], "unknown preset 'fast'"),
        (["run", "starmdp", "--radius", "-0.1"], "radius is -0.1"),
        (["run", "starmdp", "--radius", "huge"], "radius is 'huge'"),
        (["run", "starmdp", "--radius", "1" + 400 * "0"], "radius is 1000"),
        (["run", "starmdp", "--radius", "true"], "radius is True"),
        (["run", "starmdp", "--rounds", "0"], "rounds is 0"),
        (["run", "starmdp", "--seeds", "0"], "seeds must be a whole number of at least 1, got 0"),
        (["run", "starmdp", "--jobs", "0"], "jobs is 0"),
        (["run", "starmdp", "--algorithms", "bridge,sac"], "unknown algorithm"),
        (["run", "starmdp", "--algorithms", "bridge,bridge"], "expected each of them once"),
        (["run", "starmdp", "--fit", "sgd"], "fit is 'sgd'"),
        (["run", "starmdp", "--set", "gama=1"], "is not NAME=VALUE"),
        (["run", "starmdp", "--set", "gamma=high"], "gamma is 'high'"),
        (["run", "starmdp", "--set", "gamma=1" + 400 * "0"], "gamma is 1000"),
        (["run", "starmdp", "--set", 'environment_options={"horizon": 0}'], "horizon is 0"),
        (["run", "cliff", "--set", 'environment_options={"fall": [1, 2]}'], "fall is [1, 2]"),
        (["run", "starmdp", "--set", "embedding=pixels"], "unknown embedding"),
        (["run", "starmdp", "--set", "embedding=[1]"], "embedding is [1], expected the name"),
        (["run", "starmdp", "--preset", "theory", "--set", "weight_bound=50"], "use a smaller weight_bound"),
        (["run", "starmdp", "--frames", "3"], "unrecognized arguments"),
        (["run", "starmdp", "--set", "solver=GUROBI"], "GUROBI"),
        (["run", "starmdp", "--demos", "none.npz"], "none.npz cannot be read"),
        (["run", "none.npz"], "none.npz is neither a file nor one of the environments"),
        (["run", "cliffwalking", "--set", "proposals=1000000000"], "set proposals to at most"),
        (["bounds", "--demos", "none.npz"], "--demos and --mdp belong together"),
        (["bounds", "--demos", "none.npz", "--mdp", "starmdp"], "none.npz does not exist"),
        (["reproduce", "fig9"], "nothing to reproduce named 'fig9'"),
        (["reproduce"], "required: NAME"),
        (["reproduce", "fig2-starmdp", "--jobs", "0"], "jobs is 0"),
        (["reproduce", "ladder-starmdp", "--seeds", "5"], "--seeds 5 does not apply"),
        (["reproduce", "needed-radius", "--quick", "--seeds", "0"], "seeds is 0, expected at least 1"),
        (["reproduce", "published-differences", "--quick", "--seeds", "-1"], "seeds is -1, expected at least 1"),
        (["reproduce", "all", "fig9"], "nothing to reproduce named 'fig9'"),
        (["report", "nowhere"], "nowhere is not a directory"),
        (["report", "."], "holds neither a run"),
        (["report", ".", "--verify", "0"], "--verify is 0"),
    ],
)
def test_mistakes(arguments: list[str], sentence: str, tmp_path: Path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert sentence in captured.err
    assert len(captured.err.strip().splitlines()) == 1
    assert "Traceback" not in captured.err


def test_a_damaged_result_is_one_sentence(tmp_path: Path, capsys) -> None:
    arguments = ["run", "starmdp", *FAST, "--out", str(tmp_path / "r")]
    assert main(arguments) == 0
    victim = tmp_path / "r" / "seed-00000.nc"
    victim.write_bytes(victim.read_bytes()[:500])
    capsys.readouterr()
    assert main(arguments) == 2
    assert "not a readable result file" in capsys.readouterr().err


@pytest.mark.parametrize("arguments", [["run", "starmdp", *FAST], ["reproduce", "ladder-starmdp", "--quick"]])
def test_a_place_that_cannot_be_written_to_is_named(arguments: list[str], tmp_path: Path, capsys) -> None:
    (tmp_path / "taken").write_text("")
    assert main([*arguments, "--jobs", "1", "--out", str(tmp_path / "taken")]) == 2
    assert re.search(r"taken\S* cannot be .*; choose another", capsys.readouterr().err)


def test_a_run_prints_its_table_and_writes_its_figures(tmp_path: Path, capsys) -> None:
    assert main(["run", "starmdp", *FAST, "--fit", "exact", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert "bridge below pbrl?" in printed
    assert "cum. suboptimality" in printed
    for suffix, magic in ((".png", b"\x89PNG"), (".pdf", b"%PDF")):
        assert (tmp_path / f"regret{suffix}").read_bytes().startswith(magic)


def test_help_lists_every_subcommand(capsys) -> None:
    assert main(["--help"]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in SUBCOMMANDS)


def test_the_configuration_can_be_shown(capsys) -> None:
    assert main(["run", "gridworld", "--features", "sampled", "--show-config"]) == 0
    printed = capsys.readouterr().out
    assert '"rollouts": 100' in printed
    assert '"radius": 0.96' in printed


def test_the_published_settings_are_those_of_the_environment_in_any_case(capsys) -> None:
    shown = []
    for name in ("starmdp", "StarMDP"):
        assert main(["run", name, "--show-config"]) == 0
        shown.append(json.loads(capsys.readouterr().out))
    assert shown[1] == {**shown[0], "environment": "StarMDP"}


def test_too_large_a_problem_is_one_sentence(tmp_path: Path, capsys) -> None:
    options = ["--set", 'environment_options={"n_states": 10000000}', "--out", str(tmp_path)]
    assert main(["run", "garnet", *options]) == 1
    assert "there is not enough memory" in capsys.readouterr().err


def test_interruption_has_its_own_status(monkeypatch, capsys) -> None:
    def interrupt(argv: list[str]) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr("bridge_algos.run.cli.main", interrupt)
    assert main(["run", "starmdp"]) == 130
    assert "interrupted" in capsys.readouterr().err


def test_a_full_disk_is_one_sentence(monkeypatch, capsys) -> None:
    def write(arguments: list[str]) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("bridge_algos.run.cli.main", write)
    assert main(["run", "starmdp"]) == 1
    assert capsys.readouterr().err.startswith("bridge-rl run: the disk is full")


def test_a_file_that_cannot_take_its_place_is_named_by_the_place(monkeypatch, capsys) -> None:
    def move(argv: list[str]) -> int:
        raise OSError(21, "Is a directory", ".wanted.0123", None, "wanted")

    monkeypatch.setattr("bridge_algos.run.cli.main", move)
    assert main(["run", "starmdp"]) == 2
    assert "bridge-rl run: wanted cannot be used (Is a directory); choose another" in capsys.readouterr().err


def test_demonstrations_of_another_environment_are_refused(tmp_path: Path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    demos = tmp_path / "demos.npz"
    save_trajectories(demos, Trajectories(np.zeros((3, 5), dtype=np.int64), np.zeros((3, 5), dtype=np.int64)))
    for arguments in (["run", "starmdp", "--demos", str(demos)], ["bounds", "--mdp", "starmdp", "--demos", str(demos)]):
        assert main(arguments) == 2
        assert "the trajectories have 5 steps, expected the MDP's horizon 8" in capsys.readouterr().err


def test_own_mdp_and_demonstrations_run(tmp_path: Path, capsys) -> None:
    mdp = make_mdp("starmdp")
    save_mdp(tmp_path / "mine.npz", mdp)
    expert = np.array([0, 2, 3, 2, 2])
    save_trajectories(tmp_path / "demos.npz", sample_trajectories(mdp, expert, 7, np.random.default_rng(0)))
    files = [str(tmp_path / "mine.npz"), "--demos", str(tmp_path / "demos.npz")]
    assert main(["run", *files, *FAST, "--out", str(tmp_path / "out")]) == 0
    assert "bridge below pbrl?" in capsys.readouterr().out
    save_trajectories(tmp_path / "demos.npz", sample_trajectories(mdp, expert, 7, np.random.default_rng(1)))
    assert main(["run", *files, *FAST, "--out", str(tmp_path / "out")]) == 2
    assert "another configuration" in capsys.readouterr().err
    assert main(["bounds", "--mdp", files[0], *files[1:], "--only", "audit T8(B)"]) == 0
    printed = capsys.readouterr().out
    assert "from the demonstrations" in printed
    assert "offline_radius_mass" in printed


def test_another_mdp_in_the_same_file_is_another_run(tmp_path: Path, capsys) -> None:
    """Seeds of the old one would be shown, and joined with seeds of the new one, as if they were of one MDP."""
    mdp, path = make_mdp("starmdp"), str(tmp_path / "mine.npz")
    arguments = ["run", path, *FAST, "--out", str(tmp_path / "out")]
    save_mdp(path, mdp)
    assert main(arguments) == 0
    save_mdp(path, replace(mdp, reward=-mdp.reward))
    capsys.readouterr()
    assert main(arguments) == 2
    assert "another configuration" in capsys.readouterr().err
    assert main(["compare", str(tmp_path / "out"), "--jobs", "1"]) == 2
    assert "mine.npz has changed since this run was configured" in capsys.readouterr().err


def test_demonstrations_that_the_environment_excludes_are_said_to_be(tmp_path: Path, capsys) -> None:
    demos = tmp_path / "demos.npz"
    for name, excluded in (("gridworld-text", False), ("gridworld", True)):
        mdp, policy = make_mdp(name), np.zeros(16, dtype=np.int64)
        save_trajectories(demos, sample_trajectories(mdp, policy, 5, np.random.default_rng(0)))
        arguments = ["run", "gridworld-text", *FAST, "--algorithms", "bc", "--demos", str(demos)]
        assert main([*arguments, "--out", str(tmp_path / name)]) == 0
        assert ("the environment excludes the demonstrations" in capsys.readouterr().out) == excluded


def test_an_mdp_file_takes_no_options(tmp_path: Path, capsys) -> None:
    save_mdp(tmp_path / "mine.npz", make_mdp("starmdp"))
    options = ["--set", 'environment_options={"horizon": 3}', "--out", str(tmp_path / "out")]
    assert main(["run", str(tmp_path / "mine.npz"), *FAST, *options]) == 2
    assert "is the file of an MDP, which takes none" in capsys.readouterr().err


def test_demonstrations_that_refute_the_expert_certify_nothing_about_one(tmp_path: Path, capsys) -> None:
    mdp, rng = make_mdp("starmdp"), np.random.default_rng(0)
    demos = str(tmp_path / "demos.npz")
    save_trajectories(demos, sample_trajectories(mdp, np.full((mdp.n_states, mdp.n_actions), 0.25), 200, rng))
    arguments = ["bounds", "--mdp", "starmdp", "--demos", demos, "--only", "audit T8(B)"]
    assert main(arguments) == 0
    printed = capsys.readouterr().out
    assert "offline_radius_stochastic" in printed
    assert not any(name in printed for name in ("offline_radius_mass", "missing_mass", "transition_error_counts"))
    assert "They refute a deterministic stationary expert, for 5 of 5 states show more than one action" in printed
    assert "with delta = 0.05 in each bound" in printed
    assert main([*arguments, "--delta", "0.3", "--delta", "0.1", "--json"]) == 0
    printed = capsys.readouterr()
    assert "They refute" in printed.err
    assert {record["parameters"]["delta"] for record in json.loads(printed.out)} == {"0.1"}


def test_damaged_mdp_files_are_refused(tmp_path: Path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "mine.npz"
    mdp = make_mdp("starmdp")
    save_mdp(path, mdp)
    back = load_mdp(path)
    np.testing.assert_array_equal(back.transitions, mdp.transitions)
    assert back.action_names == mdp.action_names
    np.savez(path, transitions=mdp.transitions * 0.5, initial=mdp.initial, horizon=8, reward=mdp.reward)
    assert main(["run", str(path)]) == 2
    assert "sums to 0.5" in capsys.readouterr().err
    np.savez(path, transitions=mdp.transitions, initial=mdp.initial, horizon=[8, 9], reward=mdp.reward)
    assert main(["run", str(path)]) == 2
    assert "expected one whole number" in capsys.readouterr().err
    valid = {"transitions": mdp.transitions, "initial": mdp.initial, "horizon": 8, "reward": mdp.reward}
    valid["reward_on"] = "arrival"
    np.savez(path, **valid | {"transitions": mdp.transitions + 1j})
    assert main(["run", str(path)]) == 2
    assert "must be arrays of numbers" in capsys.readouterr().err
    np.savez(path, **valid, state_names=5)
    assert main(["run", str(path)]) == 2
    assert "state_names of 'mine' has 1 entries, expected 5" in capsys.readouterr().err
    np.savez(path, **valid | {"horizon": 10**9})
    assert main(["run", str(path)]) == 2
    assert "10 demonstrations of 1,000,000,000 steps" in capsys.readouterr().err
    with zipfile.ZipFile(path, "w") as archive:  # members that are no arrays reach NumPy's reader as bytes
        for name in valid:
            archive.writestr(name, "8")
    assert main(["run", str(path)]) == 2
    assert "'transitions' is no array" in capsys.readouterr().err
