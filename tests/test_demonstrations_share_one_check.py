"""Every door for demonstrations has the same check: what certifies refuses, what runs or keeps says what is wrong."""

from __future__ import annotations

import ast
import importlib.util
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from bridge_algos.demonstrations import load_demonstrations
from bridge_algos.envs.minari_io import save_minari_dataset
from bridge_algos.envs.registry import make_mdp
from bridge_algos.mdp_file import save_mdp
from bridge_algos.offline.data_bounds import bounds_from_demonstrations
from bridge_algos.run.config import preset
from bridge_algos.run.world import CHANGING, CONTRADICTORY, build_world, caveats
from bridge_algos.trajectories import Trajectories, sample_trajectories
from bridge_theory.errors import InputError
from experiments.cli import main

ROOT = Path(__file__).parents[1]
MDP = make_mdp("starmdp")
GOOD = sample_trajectories(MDP, np.array([0, 2, 3, 2, 2]), 3, np.random.default_rng(0))
Arrays = dict[str, np.ndarray]

_MISSHAPEN: dict[str, tuple[Callable[[Arrays], Arrays], str]] = {
    "too short": (lambda a: {k: v[:, :-1] for k, v in a.items()}, "the trajectories have 7 steps, expected"),
    "too long": (lambda a: {k: np.repeat(v, 2, axis=1) for k, v in a.items()}, "have 16 steps, expected"),
    "one row": (lambda a: {k: v[0] for k, v in a.items()}, "expected integers of shape (n, H)"),
    "empty": (lambda a: {k: v[:0] for k, v in a.items()}, "expected at least one trajectory"),
    "fractions": (lambda a: a | {"states": a["states"] + 0.5}, "expected integers of shape (n, H)"),
    "unknown state": (lambda a: a | {"states": a["states"] + 5}, "expected 0..4"),
    "unknown action": (lambda a: a | {"actions": a["actions"] + 4}, "expected 0..3"),
    "negative action": (lambda a: a | {"actions": a["actions"] - 4}, "expected 0..3"),
    "fewer actions": (lambda a: a | {"actions": a["actions"][:2]}, "they must agree"),
    "fewer rewards": (lambda a: a | {"rewards": a["rewards"][:2]}, "rewards has shape (2, 8)"),
    "rewards that are not numbers": (lambda a: a | {"rewards": a["rewards"] * np.nan}, "not a finite number"),
    "rewards in words": (lambda a: a | {"rewards": np.full((3, 8), "high")}, "not a finite number"),
}
_EXCLUDED: dict[str, tuple[Callable[[Arrays], Arrays], str]] = {
    "a start of probability 0": (
        lambda a: {k: v[:, ::-1].copy() for k, v in a.items()} | {"states": _moved(a["states"], 0)},
        "starts in the state 's1', where",
    ),
    "a step of probability 0": (
        lambda a: a | {"states": _moved(a["states"], slice(1, None), to=0)},
        "goes from the state 's0' by the action 'right' to 's0', which",
    ),
}


def _moved(states: np.ndarray, where: int | slice, to: int = 1) -> np.ndarray:
    moved = states.copy()
    moved[:, where] = to
    return moved


def _saved(folder: Path, arrays: Arrays) -> str:
    np.savez(folder / "demos.npz", **arrays)
    save_mdp(folder / "mine.npz", MDP)
    return str(folder / "demos.npz")


def _bounds(mdp: str) -> Callable[[Path, Arrays], None]:
    def door(folder: Path, arrays: Arrays) -> None:
        demos = _saved(folder, arrays)
        where = str(folder / mdp) if mdp.endswith(".npz") else mdp
        assert main(["bounds", "--demos", demos, "--mdp", where, "--only", "audit T8(B)"]) in (0, 2)

    return door


def _run(folder: Path, arrays: Arrays) -> None:
    config = preset("theory", "starmdp").but(demonstrations=_saved(folder, arrays))
    print("\n".join(caveats(config, build_world(config))))


def _keep(folder: Path, arrays: Arrays) -> None:
    dataset = save_minari_dataset("star-v0", Trajectories(**arrays), MDP)
    print(dataset.storage.metadata["description"])


CERTIFYING: dict[str, Callable[[Path, Arrays], object]] = {
    "bounds --mdp NAME": _bounds("starmdp"),
    "bounds --mdp FILE": _bounds("mine.npz"),
    "bounds_from_demonstrations": lambda folder, a: bounds_from_demonstrations(MDP, Trajectories(**a), delta="0.05"),
    "load_demonstrations": lambda folder, a: load_demonstrations(_saved(folder, a), MDP),
}
SAYING: dict[str, Callable[[Path, Arrays], object]] = {"run --demos": _run}
if all(importlib.util.find_spec(name) for name in ("minari", "h5py")):
    SAYING["save_minari_dataset"] = _keep


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "minari"))


def _answer(door: Callable[[Path, Arrays], object], folder: Path, arrays: Arrays, capsys) -> tuple[str, str]:
    """What a door refuses with, and what it prints."""
    try:
        door(folder, arrays)
    except InputError as error:
        return str(error), ""
    printed = capsys.readouterr()
    return printed.err, printed.out


def _good() -> Arrays:
    return {"states": GOOD.states, "actions": GOOD.actions, "rewards": GOOD.rewards}


@pytest.mark.parametrize("door", [*CERTIFYING, *SAYING])
def test_good_demonstrations_pass(door: str, tmp_path: Path, capsys) -> None:
    refusal, printed = _answer((CERTIFYING | SAYING)[door], tmp_path, _good(), capsys)
    assert refusal == ""
    assert "exclude" not in printed


@pytest.mark.parametrize("fault", _MISSHAPEN)
@pytest.mark.parametrize("door", [*CERTIFYING, *SAYING])
def test_no_door_takes_what_is_no_demonstration(door: str, fault: str, tmp_path: Path, capsys) -> None:
    spoil, sentence = _MISSHAPEN[fault]
    refusal, _ = _answer((CERTIFYING | SAYING)[door], tmp_path, spoil(_good()), capsys)
    assert sentence in refusal


@pytest.mark.parametrize("fault", _EXCLUDED)
@pytest.mark.parametrize("door", CERTIFYING)
def test_nothing_is_certified_from_what_the_mdp_excludes(door: str, fault: str, tmp_path: Path, capsys) -> None:
    spoil, sentence = _EXCLUDED[fault]
    refusal, printed = _answer(CERTIFYING[door], tmp_path, spoil(_good()), capsys)
    assert sentence in refusal
    assert printed == ""


@pytest.mark.parametrize("fault", _EXCLUDED)
@pytest.mark.parametrize("door", SAYING)
def test_what_only_runs_or_keeps_them_says_what_the_mdp_excludes(door: str, fault: str, tmp_path: Path, capsys) -> None:
    spoil, sentence = _EXCLUDED[fault]
    refusal, printed = _answer(SAYING[door], tmp_path, spoil(_good()), capsys)
    assert refusal == ""
    assert sentence in printed


# takers of demonstrations and an MDP that are no doors: they are handed what a door has let in
_BEHIND_A_DOOR = {"closed_estimate", "run_session", "run_and_store", "simulated_session", "version_space_candidates"}
_DOORS = {"bounds_from_demonstrations", "save_minari_dataset", "checked_demonstrations", "excluded", "build_problem"}


def test_there_is_no_other_door() -> None:
    """Whoever takes demonstrations and an MDP is listed above; files of demonstrations are read in two places."""
    takers, readers = set(), set()
    for path in [*ROOT.glob("bridge_algos/**/*.py"), *ROOT.glob("experiments/**/*.py")]:
        for function in (n for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.FunctionDef)):
            taken = {ast.unparse(a.annotation).split(" |")[0] for a in _arguments(function) if a.annotation is not None}
            if {"TabularMDP", "Trajectories"} <= taken:
                takers.add(function.name)
            if any(isinstance(n, ast.Call) and ast.unparse(n.func) == "load_trajectories" for n in ast.walk(function)):
                readers.add((path.stem, function.name))
    assert takers == _DOORS | _BEHIND_A_DOOR
    assert readers == {("demonstrations", "load_demonstrations"), ("world", "_demonstrations")}


def _arguments(function: ast.FunctionDef) -> list[ast.arg]:
    return [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]


@pytest.mark.parametrize(("flag", "given", "shown"), [("--n", "1000", 3), ("--S", "4", 5), ("--H", "9", 8)])
def test_sizes_that_contradict_the_files_are_refused(flag, given, shown, tmp_path: Path, capsys) -> None:
    arguments = ["bounds", "--demos", _saved(tmp_path, _good()), "--mdp", "starmdp", flag, given]
    assert main(arguments) == 2
    assert f"{flag} {given} contradicts the files, which show {shown}" in capsys.readouterr().err
    assert main([*arguments[:-1], str(shown), "--only", "audit T8(B)"]) == 0


def test_counts_that_are_of_no_demonstrations_are_refused() -> None:
    from bridge_algos.offline.step_counts import step_counts
    from bridge_theory import bounds_from_counts

    counts = step_counts(GOOD, 5, 4)
    assert bounds_from_counts(counts.visits, counts.transitions, delta="0.05")
    for swapped in (counts.transitions[::-1], np.roll(counts.transitions, 1, axis=3)):
        with pytest.raises(InputError, match="transitions do not join the visits"):
            bounds_from_counts(counts.visits, swapped, delta="0.05")


def test_a_run_says_when_its_radius_is_about_another_expert(tmp_path: Path) -> None:
    """Every named radius is proved for a deterministic stationary expert; a run with another one carries a caveat."""
    named = preset("theory", "starmdp")
    assert caveats(named, build_world(named)) == []
    changing = named.but(expert="finite-horizon-lp")
    assert CHANGING in caveats(changing, build_world(changing))
    torn = _good()
    torn["actions"] = np.where(np.arange(3)[:, None] == 0, (torn["actions"] + 1) % 4, torn["actions"])
    both = named.but(demonstrations=_saved(tmp_path, torn))
    assert CONTRADICTORY in caveats(both, build_world(both))
    by_hand = both.but(radius=0.5)
    assert CONTRADICTORY not in caveats(by_hand, build_world(by_hand))
