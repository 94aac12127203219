"""Every entry of a log's header is held against the data, or the output says that nothing shows it."""

from __future__ import annotations

import copy
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridge_algos.envs.registry import make_mdp
from bridge_algos.run.config import RunConfig, preset
from bridge_algos.run.log import logged_seed
from bridge_algos.run.log_file import RunLog, load_log, save_log
from bridge_algos.run.world import build_world
from bridge_algos.trajectories import sample_trajectories, save_trajectories
from bridge_theory.errors import InputError
from proofs_checks.verify import Certificate, verify

LOGS: dict[str, tuple[str, dict[str, Any]]] = {
    "known": ("bridge-known", {}),
    "unknown": ("bridge", {"n_demonstrations": 3}),
    "hand-set": ("bridge", {"confidence": "fixed", "gamma": 0.5, "bonus_multiplier": 0.05}),
    "hand-set, known": ("bridge-known", {"confidence": "fixed", "gamma": 0.5}),
    "stated": ("bridge", {"confidence": "stated"}),
    "returns": ("bridge-known", {"oracle": "returns", "oracle_options": {"mistakes": 0.1}}),
    "noise": ("bridge", {"noise": 0.3, "radius": 0.9, "n_demonstrations": 6}),
    "search": ("pbrl", {"candidate_limit": 100, "search_size": 50}),
    "a file": ("bridge", {"demonstrations": "demos.npz"}),
}
OTHERS: dict[str, list[Any]] = {
    "expert": ["finite-horizon-lp", "discounted-lp"],
    "solver": ["CLARABEL"],
    "tie_break": ["first"],
    "candidates": ["rejection"],
    "embedding": ["identity_short", "identity_long", "state_counts", "final_state"],
    "fit": ["adam"],
    "transition_model": ["mlp"],
    "empty_row": ["uniform"],
    "pair_rule": ["max_uncertainty", "ucb", "greedy_vs_random"],
    "confidence": ["fixed", "stated", "repaired", "likelihood"],
    "oracle": ["returns", "bradley-terry"],
    "oracle_options": [{"mistakes": 0.2}, {"rationality": 1.0}, {"equal_within": 0.5}],
    "environment": ["gridworld", "starmdp-text", "here.npz"],
    "environment_options": [{"horizon": 9}],
    "algorithms": [["bridge"], ["bridge-known"], ["pbrl"]],
    "radius": ["stated", "repaired", "zero", 0.5],
    "noise": [0.0, 0.5],
    "demonstrations": [None, "others.npz"],
    "environment_digest": ["0" * 64],
    "demonstrations_digest": ["0" * 64],
    "rollouts": [10],
    "weight_bound": [0.5],
    "seed": [2, 77],
    "versions": [{}, {"numpy": "0.1"}],
    "format": ["bridge-rl log 2"],
    "configuration": [{}],
}
"""Other values of the entries that are no plain numbers; numbers are doubled, and made one more and one less."""

WRONG: list[Any] = [None, True, [], {}, "words", 1.5, -3, {"a": []}, float("nan")]
"""Types: whatever is not refused, or named as shown by nothing, is a hypothesis that slips in."""

SHOWN = {
    "format", "configuration", "horizon", "weight_bound", "algorithms",
    "configuration.rounds", "configuration.comparisons", "configuration.embedding", "configuration.confidence",
    "configuration.lam", "configuration.slope", "configuration.weight_bound", "configuration.rollouts",
}  # fmt: skip
"""Entries of which no change at all is accepted, in no log."""


@cache
def honest(name: str, directory: Path) -> tuple[RunLog, Certificate]:
    algorithm, changes = LOGS[name]
    if "demonstrations" in changes:
        demos = sample_trajectories(make_mdp("starmdp"), np.array([0, 2, 3, 2, 2]), 4, np.random.default_rng(0))
        save_trajectories(directory / "demos.npz", demos)
        changes = changes | {"demonstrations": str(directory / "demos.npz")}
    config: RunConfig = preset("theory", "starmdp").but(rounds=4, algorithms=(algorithm,), **changes)
    log = logged_seed(config, build_world(config), 1)[1]
    (item,) = verify(log)
    assert item.certified, item.words()
    return log, item


@pytest.fixture(scope="module")
def directory(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("logs")


def places(log: RunLog) -> list[tuple[str, ...]]:
    return [(name,) for name in log.header] + [("configuration", name) for name in log.header["configuration"]]


def values(name: str, old: Any) -> list[Any]:
    plain = [] if isinstance(old, bool) or not isinstance(old, int | float) else [2 * old, old + 1, old - 1, old / 2]
    return [value for value in [*OTHERS.get(name, []), *plain, *WRONG] if not same(value, old)]


def same(one: Any, other: Any) -> bool:
    return type(one) is type(other) and bool(one == other)


def tampered(log: RunLog, path: tuple[str, ...]) -> list[tuple[str, RunLog]]:
    """The entry with other values, of other types, and missing."""
    found = []
    old = log.header[path[0]] if len(path) == 1 else log.header["configuration"][path[1]]
    for value in values(path[-1], old):
        header = copy.deepcopy(log.header)
        (header if len(path) == 1 else header["configuration"])[path[-1]] = value
        found.append((repr(value), RunLog(header, log.arrays)))
    header = copy.deepcopy(log.header)
    del (header if len(path) == 1 else header["configuration"])[path[-1]]
    return [*found, ("missing", RunLog(header, log.arrays))]


def outcome(log: RunLog, path: Path) -> Certificate | None:
    """The certificate of a log that is stored, digest and all, and read again; None where it is refused."""
    save_log(path, log)
    try:
        (item,) = verify(load_log(path))
    except InputError:
        return None
    return item if item.certified else None


def named(item: Certificate, name: str) -> bool:
    """Whether the output names the entry among those that nothing, or no more than a part, shows."""
    lines = [line for line in item.words().splitlines() if line.startswith("taken at its word")]
    assert all(name != entry.split(" = ")[0] or any(entry in line for line in lines) for entry in item.unshown)
    return any(entry.split(" = ")[0] == name for entry in item.unshown)


@pytest.mark.parametrize("name", LOGS)
def test_every_entry_is_held_against_the_data_or_named(name: str, directory: Path) -> None:
    log, _ = honest(name, directory)
    silent, accepted = [], set()
    for path in places(log):
        for change, forged in tampered(log, path):
            item = outcome(forged, directory / "log.npz")
            if item is None:
                continue
            accepted.add(".".join(path))
            if not named(item, path[-1]):
                silent.append(f"{'.'.join(path)}: {change}")
    assert silent == []
    assert not accepted & SHOWN


def test_each_entry_that_nothing_shows_can_be_changed_without_a_contradiction(directory: Path) -> None:
    """The list is no excuse: what it says of an entry without a remark is true of it.

    A network's transitions are refused before anything is compared; under known dynamics a log of one that claims
    "counts" would pass, so that the entry stays on the list.
    """
    for name in ("known", "unknown"):
        log, item = honest(name, directory)
        for path in places(log):
            if path[-1] != "transition_model" and any(
                entry.split(" = ")[0] == path[-1] and not shown for entry, shown in item.unshown.items()
            ):
                assert any(outcome(forged, directory / "log.npz") for _, forged in tampered(log, path)), path


@pytest.mark.parametrize(
    ("name", "changes", "sentence"),
    [
        ("known", {"n_demonstrations": 3}, "the log holds 2 demonstrations, its configuration 3"),
        ("noise", {"noise": 0.0}, "the demonstrations contradict each other, though the expert is deterministic"),
        ("noise", {"noise": 0.0, "expert": "discounted-lp"}, "though the expert is deterministic"),
        ("noise", {"noise": 0.0, "expert": "finite-horizon-lp"}, "though the expert is deterministic"),
        ("known", {"candidate_limit": 1}, "its configuration at most 1"),
        ("known", {"candidates": "rejection", "proposals": 1}, "its configuration at most 2"),
        ("search", {"search_size": 40}, "policies, its configuration at most 40"),
        ("search", {"candidate_limit": 20_000}, "its configuration 1024"),
        ("search", {"candidate_limit": 20_000, "search_size": 50}, "its configuration 1024"),
    ],
)
def test_what_the_data_contradict_is_said(name: str, changes: dict[str, Any], sentence: str, directory: Path) -> None:
    log, _ = honest(name, directory)
    header = copy.deepcopy(log.header)
    header["configuration"] |= changes
    (item,) = verify(RunLog(header, log.arrays))
    assert any(sentence in reason for reason in item.reasons), item.words()


@pytest.mark.parametrize(
    ("options", "answer", "possible"),
    [
        (None, 0.5, False),
        (None, np.nan, False),
        ({}, 0.5, False),
        ({"equal_within": 0.1}, 0.5, True),
        ({"equal_within": 0.1}, np.nan, False),
        ({"skip_below": 1.0}, np.nan, True),
        ({"skip_below": 1.0}, 0.5, False),
        ({"equal_within": 0.1, "skip_below": 1.0}, 0.25, False),
    ],
)
def test_answers_are_those_that_the_teacher_can_give(
    options: dict[str, float] | None, answer: float, possible: bool, directory: Path
) -> None:
    """None is the Bradley-Terry teacher, who answers 0 or 1."""
    log, _ = honest("known", directory)
    header = copy.deepcopy(log.header)
    if options is not None:
        header["configuration"] |= {"oracle": "returns", "oracle_options": options}
    outcomes = log.arrays["bridge-known/outcomes"].copy()
    outcomes[0, 0] = answer
    (item,) = verify(RunLog(header, log.arrays | {"bridge-known/outcomes": outcomes}))
    assert any("never answers like this" in reason for reason in item.reasons) != possible


def test_a_network_is_shown_where_the_features_are_learnt(directory: Path) -> None:
    for name, listed in (("known", True), ("unknown", False)):
        assert named(honest(name, directory)[1], "transition_model") == listed


@pytest.mark.parametrize(("noise", "refused"), [(0.0, True), (0.5, False)])
def test_demonstrations_pass_what_the_environment_allows(noise: float, refused: bool, directory: Path) -> None:
    """Nobody stays in state 1 of StarMDP; with noise the actions recorded are not those that were taken."""
    log, _ = honest("known", directory)
    states = log.arrays["demonstrations/states"].copy()
    states[0, 1:3] = 1
    actions = np.where(states == 1, 1, log.arrays["demonstrations/actions"])
    header = copy.deepcopy(log.header)
    header["configuration"]["noise"] = noise
    arrays = log.arrays | {"demonstrations/states": states, "demonstrations/actions": actions}
    (item,) = verify(RunLog(header, arrays))
    assert any("a demonstration passes a transition" in reason for reason in item.reasons) == refused


def test_weights_outside_of_the_ball_are_refused_where_w_is_no_claim(directory: Path) -> None:
    """A hand-set multiplier does not depend on W, so that no other claim contradicts a smaller one."""
    log, _ = honest("hand-set, known", directory)
    largest = float(np.linalg.norm(log.arrays["bridge-known/w"], axis=1).max())
    for share, refused in ((0.7, True), (1.01, False)):
        header = copy.deepcopy(log.header)
        header["weight_bound"] = header["configuration"]["weight_bound"] = share * largest
        (item,) = verify(RunLog(header, log.arrays))
        assert any("the weights have norm" in reason for reason in item.reasons) == refused


def test_what_another_version_adds_is_named(directory: Path) -> None:
    """An unknown entry or array is not refused, and not silently read as nothing either."""
    log, _ = honest("known", directory)
    header = copy.deepcopy(log.header) | {"note\n\x1b[2J": "x"}
    header["configuration"]["teacher"] = "y" * 1000
    item = outcome(RunLog(header, log.arrays | {"bridge-known/more": np.zeros(3)}), directory / "log.npz")
    assert item is not None
    shown = item.words()
    assert '"note\\n\\u001b[2J"' in shown
    assert f'teacher = "{"y" * 100}' in shown
    assert "y" * 500 not in shown
    assert 'the array "bridge-known/more"' in shown
