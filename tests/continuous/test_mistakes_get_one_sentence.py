"""Bad environments, horizons, policies and options get one sentence each; the command line trains and demonstrates."""

import json
import re
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="rollouts need MuJoCo (the extra 'continuous')")

from networks import random_policy

from bridge_algos.continuous.environments import draw_starts, make_environment
from bridge_algos.continuous.episodes import load_episodes
from bridge_algos.continuous.rollouts import map_rollouts, rollout
from bridge_theory.errors import InputError
from experiments.cli import main


@pytest.fixture(scope="module")
def reacher():
    return make_environment("reacher")


@pytest.fixture(scope="module")
def starts(reacher):
    return draw_starts(reacher, 3, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("walker", "there is no environment 'walker'"),
        ("Walker-v9000", "there is no environment 'Walker-v9000'"),
        ("CartPole-v1", "'CartPole-v1' is not simulated by MuJoCo; expected one of reacher, ant or the id"),
    ],
)
def test_unknown_environments(name, sentence):
    with pytest.raises(InputError, match=sentence):
        make_environment(name)


def test_policies_that_do_not_answer_as_asked(reacher, starts):
    good = random_policy(reacher, 0)
    cases = {
        r"policy 1: it answers 50 observations with shape \(50, 3\), expected \(50, 2\)": [
            good,
            lambda seen: np.zeros((len(seen), 3)),
        ],
        r"policy 0: it answers with actions that are not finite": [lambda seen: np.full((len(seen), 2), np.nan)],
    }
    for sentence, policies in cases.items():
        with pytest.raises(InputError, match=sentence):
            map_rollouts(reacher, policies, starts, lambda episodes: episodes.states[:, 0])
    with pytest.raises(InputError, match=r"policy 0: it has no std of shape \(2,\)"):
        rollout(reacher, lambda seen: np.zeros((len(seen), 2)), starts, rng=np.random.default_rng(0))


def test_horizons_and_numbers(reacher, starts):
    policy = random_policy(reacher, 0)
    for horizon in (0, 51):
        with pytest.raises(InputError, match=f"the horizon is {horizon}, expected 1 to 50"):
            rollout(reacher, policy, starts, horizon=horizon)
    with pytest.raises(InputError, match="0 initial states were asked for"):
        draw_starts(reacher, 0, np.random.default_rng(0))


@pytest.mark.parametrize("absent", ["mujoco", "gymnasium.envs.mujoco"])
def test_without_mujoco_one_sentence_says_what_to_install(absent, monkeypatch):
    monkeypatch.setitem(sys.modules, absent, None)
    with pytest.raises(
        InputError, match=r"cannot be imported .*; install it with pip install 'bridge-rl\[continuous\]'"
    ):
        make_environment("reacher")


def test_importing_rollouts_is_light():
    code = "import bridge_algos.continuous.rollouts, bridge_algos.continuous.experts, sys\nprint(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.split()
    assert not {"mujoco", "torch", "gymnasium", "stable_baselines3", "minari"} & set(loaded)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["train", "hopper"], "there is no environment 'hopper'"),
        (["train", "Hopper-v5"], "there are no training settings for 'Hopper-v5', expected reacher, ant"),
        (["train", "reacher", "--iterations", "0"], "--iterations is 0, expected at least 1"),
        (["train", "reacher", "--steps", "9"], "--steps is given, but ppo does not take it; leave it out"),
        (
            ["train", "reacher", "--algorithm", "sb3", "--steps", "1", "--horizon", "9"],
            "--horizon is given, but sb3 does",
        ),
        (["train", "reacher", "--seed", "-1"], "--seed is -1, expected at least 0"),
        (["evaluate", "reacher", "--expert", "nowhere.safetensors"], "nowhere.safetensors does not exist"),
        (["evaluate", "Hopper-v5"], "your own .safetensors file or SB3 .zip, by --expert"),
        (["demonstrate", "reacher"], "--out"),
        (["demonstrate", "reacher", "--out", "no version", "--n", "1"], "the dataset id is 'no version'"),
        ([], "action"),
    ],
)
def test_command_line(arguments, sentence, capsys):
    assert main(["expert", *arguments]) == 2
    message = capsys.readouterr().err
    assert sentence in message
    assert message.count("\n") == 1


def test_an_expert_is_trained_evaluated_and_demonstrates(tmp_path, capsys):
    out = tmp_path / "e.safetensors"
    assert main(["expert", "train", "reacher", "--iterations", "1", "--out", str(out), "--threads", "1"]) == 0
    card = json.loads(out.with_suffix(".json").read_text())
    assert card["command"] == f"bridge-rl expert train reacher --iterations 1 --out {out} --threads 1"
    assert (card["seed"], card["settings"]["iterations"], card["environment"]) == (0, 1, "Reacher-v5")
    assert main(["expert", "evaluate", "reacher", "--expert", str(out), "--episodes", "20", "--sampled"]) == 0
    assert "over 20 episodes of 50 steps; 0 ended early" in capsys.readouterr().out
    assert main(["expert", "evaluate", "reacher", "--expert", str(out), "--episodes", "1"]) == 0
    assert re.fullmatch(r"mean return -\d+\.\d\d over 1 episodes of 50 steps; 0 ended early\n", capsys.readouterr().out)
    demonstrate = ["expert", "demonstrate", "reacher", "--expert", str(out), "--n", "4", "--seed", "3"]
    assert main([*demonstrate, "--out", str(tmp_path / "d.npz")]) == 0
    assert len(load_episodes(tmp_path / "d.npz").checked(make_environment("reacher"))) == 4


def test_sb3_trains_with_the_settings_of_the_zoo(tmp_path):
    """A few hundred steps only: the policy must be the model's own, observation statistics included."""
    pytest.importorskip("stable_baselines3", reason="needs Stable-Baselines3 (the extra 'sb3')")
    from bridge_algos.continuous.sb3_training import train_with_sb3

    environment, kept = make_environment("reacher"), []
    policy = train_with_sb3(environment, 0, 512, kept.append)
    assert policy.observation_scale is not None
    assert policy.observation_clip == 10
    assert [snapshot.digest() for snapshot in kept] == [policy.digest()]
    again = train_with_sb3(environment, 0, 512)
    assert again.digest() == policy.digest()
    with pytest.raises(InputError, match="are for reacher and ant, not 'Hopper-v5'"):
        train_with_sb3(make_environment("Hopper-v5"), 0, 10)
