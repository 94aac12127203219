"""``bridge-rl verify`` accepts every honest log, says what it cannot promise, and shares no code with the algorithm."""

import ast
import dataclasses
import json
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridge_algos.envs.registry import make_mdp
from bridge_algos.mdp import TabularMDP
from bridge_algos.mdp_file import save_mdp
from bridge_algos.run.config import preset
from bridge_algos.run.log import logged_seed
from bridge_algos.run.log_file import RunLog
from bridge_algos.run.runner import run
from bridge_algos.run.world import build_world
from bridge_algos.trajectories import sample_trajectories
from experiments.cli import main
from proofs_checks.verify import Certificate, verify
from proofs_checks.verify.certificate import shared, table
from proofs_checks.verify.comparator import BEST, SEARCHED, comparator
from proofs_checks.verify.facts import facts

ROOT = Path(__file__).parent.parent

CHECKERS = ("proofs_checks.verify", "proofs_checks.asking_checker")
THEORY = {"rounds": 6, "algorithms": ("bridge", "bridge-known", "pbrl")}
RUNS = {
    "starmdp, theory": ("theory", "starmdp", {}),
    "starmdp, hand-set": ("theory", "starmdp", {"confidence": "fixed", "gamma": 1.0, "bonus_multiplier": 0.1}),
    "starmdp, stated": ("theory", "starmdp", {"confidence": "stated"}),
    "starmdp, published": ("published", "starmdp", {}),
    "starmdp, many comparisons": ("theory", "starmdp", {"comparisons": 7, "fit": "adam"}),
    "starmdp, ucb": ("theory", "starmdp", {"pair_rule": "ucb", "confidence": "fixed", "gamma": 0.3}),
    "starmdp, greedy": ("theory", "starmdp", {"pair_rule": "greedy_vs_random", "confidence": "fixed", "gamma": 0.3}),
    "starmdp, widest": ("theory", "starmdp", {"pair_rule": "max_uncertainty", "weight_bound": 0.05}),
    "starmdp, noise": ("theory", "starmdp", {"noise": 0.2, "radius": 0.9}),
    "starmdp, states that only noise reaches": (
        "theory",
        "starmdp",
        {"environment_options": {"horizon": 3}, "noise": 0.2, "n_demonstrations": 3},
    ),
    "starmdp, long embedding": ("published", "starmdp", {"embedding": "identity_long", "pair_rule": "ucb"}),
    "starmdp, last state": ("published", "starmdp", {"embedding": "final_state", "fit": "exact", "slope": 1.0}),
    "gridworld": ("theory", "gridworld", {"rounds": 3, "candidate_limit": 300, "search_size": 200}),
    "frozenlake": ("theory", "frozenlake", {"rounds": 3, "candidate_limit": 300, "search_size": 200}),
}


@cache
def certificates(name: str, seed: int = 0) -> tuple[Certificate, ...]:
    chosen, environment, changes = RUNS[name]
    config = preset(chosen, environment).but(**{**THEORY, **changes})
    return verify(logged_seed(config, build_world(config), seed)[1])


@pytest.mark.parametrize("name", RUNS)
def test_every_honest_log_is_certified(name: str) -> None:
    seed = 321325 if "noise reaches" in name else 0
    for item in certificates(name, seed):
        assert item.certified, item.words()
        assert np.isfinite(item.bounds["best"]).all()
        assert (np.diff(item.bounds["best"]) >= 0).all()
        for name, bound in item.bounds.items():
            assert name == "likelihood" or (item.bounds["best"] <= bound).all()  # that one has an event of its own


def test_only_the_trivial_bound_is_left_without_bradley_terry_answers() -> None:
    for item in certificates("starmdp, published"):
        assert item.failure == 0
        assert np.isinf(item.bounds["hindsight"]).all()
        assert any("Bradley-Terry" in note for note in item.notes)


@pytest.mark.parametrize(
    ("changes", "algorithms", "note"),
    [
        ({"oracle": "returns"}, ("bridge", "bridge-known", "pbrl"), "the answers come from the oracle 'returns'"),
        ({"slope": 2.0}, ("bridge", "bridge-known", "pbrl"), "the fitted slope is 2"),
        ({"noise": 0.2, "radius": 0.9}, ("bridge",), "noise changed the recorded actions"),
        ({"delta": 0.5}, ("bridge", "pbrl"), "add up to 1 or more"),
    ],
)
def test_each_hypothesis_alone_leaves_the_trivial_bound(
    changes: dict[str, Any], algorithms: tuple[str, ...], note: str
) -> None:
    """To those whose bounds need it, and to no other."""
    config = preset("theory", "starmdp").but(**THEORY | {"rounds": 2}, **changes)
    for item in verify(logged_seed(config, build_world(config), 0)[1]):
        withheld = item.algorithm in algorithms
        assert item.certified
        assert np.isinf(item.bounds["ucb"]).all() == np.isinf(item.bounds["hindsight"]).all() == withheld
        assert (item.bounds["best"] == item.bounds["trivial"]).all() or not withheld
        assert (item.failure == 0) == withheld
        answered = item.algorithm == "bridge-known" and "slope" in changes  # which the likelihood set does not fit
        left = "and the likelihood bounds are" if answered else "bound is"
        assert [text.startswith(f"only the trivial {left} certified: ") and note in text for text in item.notes] == (
            [True] if withheld else []
        )
        assert any("Bradley-Terry model with w*" in text for text in item.assumptions) == (answered or not withheld)
        assert np.isfinite(item.bounds["likelihood"]).all() == bool(item.alone)
        assert bool(item.alone) == (item.algorithm == "bridge-known" and "oracle" not in changes)


def test_a_search_of_all_policies_needs_no_demonstrations() -> None:
    reasons = {item.algorithm: item.comparator for item in certificates("starmdp, theory")}
    assert reasons["pbrl"].policy == reasons["bridge"].policy == BEST
    assert reasons["pbrl"].reason == "it is searched because all policies are"
    assert not reasons["pbrl"].assumed
    config = preset("theory", "starmdp").but(rounds=1, algorithms=("bridge-known",), radius="repaired")
    given = facts(logged_seed(config, build_world(config), 0)[1], "bridge-known")
    assert comparator(given).policy == BEST
    doubled = given.policies.copy()
    doubled[0] = doubled[1]  # as many as there are, but not all
    assert comparator(dataclasses.replace(given, policies=doubled)).policy == SEARCHED


def test_demonstrations_are_assumed_of_who_counts_them_alone() -> None:
    for item in certificates("starmdp, theory"):
        (sentence,) = (text for text in item.assumptions if "fresh, independent draws" in text)
        assert ("demonstrations" in sentence) == (item.algorithm == "bridge")


def test_sentences_belong_to_the_certificates_that_have_them() -> None:
    one, two = (certificates("starmdp, theory", seed)[0] for seed in (0, 1))
    other = dataclasses.replace(two, assumptions=(*two.assumptions, "the moon is made of cheese"))
    third = dataclasses.replace(one, seed=2, assumptions=other.assumptions)
    refused = dataclasses.replace(one, seed=3, certified=False, assumptions=("nothing",), reasons=("it is forged",))
    shown = table([one, other, third, refused])
    assert "assuming (bridge seeds 1, 2): the moon is made of cheese" in shown
    assert "assuming (bridge): the utility of a policy" in shown
    assert "nothing" not in table([refused])
    assert "assuming (bridge seed 1): the moon" in table([one, other, certificates("starmdp, theory")[1]])
    assert shared([other])[-1][2] == "bridge"


CHANGED: dict[str, Any] = {
    "noise": 0.1,
    "demonstrations": "elsewhere.npz",
    "expert": "discounted-lp",
}


def test_each_entry_that_decides_the_comparator_decides_it_alone() -> None:
    config = preset("theory", "starmdp").but(rounds=2, algorithms=("bridge",))
    log = logged_seed(config, build_world(config), 0)[1]
    (item,) = verify(log)
    assert item.comparator.policy == BEST
    assert any("come from a best stationary deterministic policy" in text for text in item.assumptions)
    for name, value in CHANGED.items():
        header = log.header | {"configuration": log.header["configuration"] | {name: value}}
        (other,) = verify(RunLog(header, log.arrays))
        assert other.certified
        assert other.comparator.policy == SEARCHED
        assert "best stationary deterministic" not in other.words()
    config = config.but(embedding="identity_short", oracle="returns")
    (item,) = verify(logged_seed(config, build_world(config), 0)[1])
    assert item.comparator.policy == SEARCHED  # the reward is not linear in what the utility is


def test_a_hand_set_multiplier_is_said_to_have_no_guarantee() -> None:
    for item in certificates("starmdp, hand-set"):
        assert any("hand-set" in note for note in item.notes)
        assert np.isfinite(item.bounds["hindsight"]).all()


def test_unknown_dynamics_spend_a_second_event() -> None:
    failures = {item.algorithm: item.failure for item in certificates("starmdp, theory")}
    assert failures["bridge-known"] == pytest.approx(0.05)
    assert failures["bridge"] == failures["pbrl"] == pytest.approx(0.1)


def test_the_command_prints_a_verdict(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = preset("theory", "starmdp").but(rounds=2, algorithms=("bridge-known", "bc"))
    run(config, tmp_path, seeds=2, log=True)
    assert main(["verify", str(tmp_path)]) == 0
    assert "2 of 2 certified" in capsys.readouterr().out
    assert main(["verify", str(tmp_path), "--seed", "1", "--json"]) == 0
    (record,) = json.loads(capsys.readouterr().out)
    assert record["seed"] == 1
    assert len(record["bounds"]["best"]) == 2
    assert main(["verify", str(tmp_path), "--seed", "9"]) == 2
    assert main(["verify", str(tmp_path / "seed-00000.nc")]) == 2


def test_a_finished_run_gets_its_logs_without_new_numbers(tmp_path: Path) -> None:
    config = preset("theory", "starmdp").but(rounds=2, algorithms=("bridge-known",))
    before = run(config, tmp_path, seeds=2)
    after = run(config, tmp_path, seeds=2, log=True)
    assert before.drop_vars("seconds").identical(after.drop_vars("seconds"))
    assert sorted(path.name for path in tmp_path.glob("log-*")) == ["log-00000.npz", "log-00001.npz"]


def test_demonstrations_of_small_integers_are_those_of_large_ones(tmp_path: Path) -> None:
    mdp = make_mdp("starmdp")
    demos = sample_trajectories(mdp, np.array([0, 2, 3, 2, 2]), 4, np.random.default_rng(0))
    np.savez(tmp_path / "demos.npz", states=demos.states.astype(np.int32), actions=demos.actions.astype(np.uint8))
    config = preset("theory", "starmdp").but(
        rounds=2, algorithms=("bridge",), demonstrations=str(tmp_path / "demos.npz")
    )
    (item,) = verify(logged_seed(config, build_world(config), 0)[1])
    assert item.certified, item.words()


def test_demonstrations_from_elsewhere_leave_bounds_to_those_who_do_not_count_them(tmp_path: Path) -> None:
    """In StarMDP nobody stays in state 1: counts of such steps are of no draws from it."""
    states, actions = np.array([[0, 1, 1, 1, 1, 2, 2, 2]]), np.zeros((1, 8), dtype=int)
    np.savez(tmp_path / "demos.npz", states=states, actions=actions)
    config = preset("theory", "starmdp").but(**THEORY | {"rounds": 2}, demonstrations=str(tmp_path / "demos.npz"))
    for item in verify(logged_seed(config, build_world(config), 0)[1]):
        assert item.certified, item.words()
        assert np.isinf(item.bounds["ucb"]).all() == (item.algorithm == "bridge")
        assert any("that the environment excludes" in note for note in item.notes) == (item.algorithm == "bridge")


@pytest.mark.parametrize("confidence", ["fixed", "stated", "repaired", "likelihood"])
def test_one_state_and_one_action_are_certified(confidence: str, tmp_path: Path) -> None:
    save_mdp(tmp_path / "one.npz", TabularMDP(np.ones((1, 1, 1)), np.ones(1), 1, np.ones(1)))
    config = preset("theory", str(tmp_path / "one.npz")).but(**{**THEORY, "rounds": 2, "confidence": confidence})
    log = logged_seed(config, build_world(config), 0)[1]
    for item in verify(log):
        assert item.certified, item.words()
        assert item.unshown[f'environment = "{tmp_path}/one.npz"'] == ""  # whose dynamics nothing shows
    header = log.header | {"configuration": log.header["configuration"] | {"environment_options": {"horizon": 1}}}
    assert not any(item.certified for item in verify(RunLog(header, log.arrays)))


ALLOWED = ("bridge_algos.run.log_file", "bridge_algos.envs.registry")


def test_the_checker_shares_no_code_with_the_algorithms() -> None:
    for path in (ROOT / "proofs_checks" / "verify").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom):
                assert node.level == 0
                names = [node.module or ""]
            for name in names:
                assert not name.startswith("bridge_algos") or name in ALLOWED, f"{path.name} imports {name}"
                assert not name.startswith("proofs_checks") or name.startswith(CHECKERS), f"{path.name} imports {name}"


def test_checking_loads_none_of_the_algorithms() -> None:
    program = (
        "import sys, proofs_checks.verify.cli, proofs_checks.verify.checker; "
        "print(*[m for m in sys.modules if m.startswith('bridge_algos.')])"
    )
    loaded = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=ROOT)
    parts = {name.split(".")[1] for name in loaded.stdout.split()}
    assert parts <= {"run", "envs", "files", "npz", "mdp", "conventions", "given"}
    assert "bridge_algos.run.learners" not in loaded.stdout
