"""In continuous control too, a mistake gets one sentence that says what to do, and nothing is written."""

import sys
from pathlib import Path

import numpy as np
import pytest

from bridge_algos.continuous import watch
from bridge_algos.continuous.config import ContinuousConfig, continuous_preset
from bridge_theory.errors import InputError
from experiments.cli import main


def answer(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(list(arguments)) in (1, 2)
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    return captured.err


@pytest.mark.parametrize("version", ["stated", "repaired"])
def test_nothing_is_called_certified(version: str) -> None:
    with pytest.raises(InputError, match="nothing can be certified; leave it at 'fixed'"):
        ContinuousConfig("reacher", confidence=version)
    with pytest.raises(InputError, match="there are estimates only and nothing to certify"):
        continuous_preset("theory", "reacher")


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"radius": 0}, "radius is 0, expected a positive number"),
        ({"radius": "repaired"}, "radius is 'repaired', expected a positive number"),
        ({"include_expert": "no"}, "include_expert is 'no', expected true or false"),
        ({"rollouts": 1}, "rollouts is 1, expected a whole number of at least 2"),
        ({"algorithms": ("bridge-known",)}, "unknown algorithm"),
        ({"fit": "exact"}, "needs a positive lam"),
        ({"pair_rule": "best"}, "pair_rule is 'best', expected one of"),
    ],
)
def test_configurations_are_checked(changes: dict, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        ContinuousConfig("reacher", **changes)


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    message = answer(capsys, "run", "reacher", "--seeds", "1")
    assert "'mujoco'" in message
    assert "pip install 'bridge-rl[continuous]'" in message


def test_options_of_the_other_side_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert "--features does not apply" in answer(capsys, "run", "reacher", "--features", "sampled")
    assert "are for MuJoCo" in answer(capsys, "run", "starmdp", "--include-expert")
    assert "NAME one of algorithms, expert" in answer(capsys, "run", "reacher", "--set", "delta=0.1")


def test_watch_refuses_what_it_cannot_show(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "no directory of a run" in answer(capsys, "watch", "gridworld")
    assert "ends in .gif" in answer(capsys, "watch", "reacher", "--out", "film.mp4")
    assert "expected at least 1" in answer(capsys, "watch", "reacher", "--episodes", "0")
    assert main(["run", "starmdp", "--seeds", "1", "--rounds", "2", "--out", str(tmp_path)]) == 0
    capsys.readouterr()
    assert "has no pictures" in answer(capsys, "watch", str(tmp_path))


@pytest.mark.parametrize("probe", ["raise SystemExit(1)", "import time; time.sleep(60)"])
def test_watch_says_when_nothing_can_render(
    probe: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(watch, "_PROBE", probe)
    monkeypatch.setattr(watch, "PATIENCE", 0.5)
    monkeypatch.chdir(tmp_path)
    assert "MuJoCo can render off screen with none of" in answer(capsys, "watch", "reacher")
    assert list(tmp_path.iterdir()) == []


class TestWithMujoco:
    """What needs the simulator to be noticed."""

    @pytest.fixture(autouse=True)
    def simulator(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        pytest.importorskip("mujoco", reason="needs MuJoCo, of the extra 'continuous'")
        pytest.importorskip("torch", reason="needs torch, of the extra 'continuous'")
        monkeypatch.setenv("BRIDGE_RL_CACHE", str(tmp_path / "cache"))

    def test_inputs_of_a_run(self, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
        directory = tmp_path / "out"
        common = ("--seeds", "1", "--out", str(directory))
        (tmp_path / "expert.safetensors").write_bytes(b"nothing")
        np.savez(tmp_path / "demos.npz", states=np.zeros(3))
        for arguments, sentence in (
            (("Swimmer-v99",), "there is no environment 'Swimmer-v99'"),
            (("CartPole-v1",), "is not simulated by MuJoCo"),
            (("reacher", "--expert", str(tmp_path / "missing.safetensors")), "does not exist"),
            (("reacher", "--expert", str(tmp_path / "expert.safetensors")), "expert.safetensors"),
            (("reacher", "--demos", str(tmp_path / "demos.npz")), "lacks the arrays"),
            (("reacher", "--set", "horizon=51"), "the horizon is 51, expected 1 to 50"),
            (("reacher", "--set", "embedding=ant_reward"), "has no embedding 'ant_reward'"),
            (("reacher", "--set", 'oracle_options={"noise": 1}'), "the oracle has no option 'noise'"),
            (("reacher", "--log"), "leave out --log"),
        ):
            assert sentence in answer(capsys, "run", *arguments, *common)
        assert not list(directory.glob("seed-*"))

    def test_demonstrations_of_another_robot(self, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
        from bridge_algos.continuous.episodes import Episodes, save_episodes

        ant = Episodes(np.zeros((2, 4, 105)), np.zeros((2, 3, 8), np.float32), np.zeros((2, 3)), np.array([3, 3]),
                       np.zeros(2, dtype=bool))  # fmt: skip
        save_episodes(tmp_path / "ant.npz", ant)
        message = answer(capsys, "run", "reacher", "--demos", str(tmp_path / "ant.npz"), "--out", str(tmp_path / "o"))
        assert "as reacher has 2-dimensional actions" in message

    def test_changed_demonstrations_are_noticed(self, tmp_path: Path) -> None:
        from bridge_algos.continuous.environments import draw_starts, make_environment
        from bridge_algos.continuous.episodes import episodes_digest, save_episodes
        from bridge_algos.continuous.experts import load_expert
        from bridge_algos.continuous.offline import demonstrations_and_clone
        from bridge_algos.continuous.rollouts import rollout

        environment = make_environment("reacher")
        expert = load_expert("reacher", environment)
        starts = draw_starts(environment, 7, np.random.default_rng(0))
        episodes = rollout(environment, expert, starts, horizon=6)
        path = tmp_path / "mine.npz"
        save_episodes(path, episodes)
        config = continuous_preset("published", "reacher").but(
            demonstrations=str(path), demonstrations_digest=episodes_digest(episodes), horizon=6, epochs=2
        )
        _, _, used, cloned = demonstrations_and_clone(config, 0, None)
        assert len(used) == 6
        assert np.isfinite(cloned.validation).all()
        save_episodes(path, episodes[1:])
        with pytest.raises(InputError, match="has changed since this run was configured"):
            demonstrations_and_clone(config, 0, None)

    def test_watch_shows_a_run_where_a_renderer_works(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        if watch.working_backend() is None:
            pytest.skip("no off-screen renderer works here")
        from PIL import Image

        monkeypatch.delenv("MUJOCO_GL", raising=False)
        run = ["run", "reacher", "--seeds", "1", "--rounds", "2", "--out", str(tmp_path / "run")]
        for setting in ("small=1", "large=1", "rollouts=2", "epochs=1", "horizon=4", "n_demonstrations=1"):
            run += ["--set", setting]
        assert main(run) == 0
        assert main(["watch", str(tmp_path / "run"), "--episodes", "2"]) == 0
        assert "BRIDGE" in capsys.readouterr().out
        with Image.open(tmp_path / "run" / "watch.gif") as film:
            assert film.size == (4 * watch.PANEL, watch.PANEL + watch.CAPTION)
            first = np.asarray(film.convert("RGB"))[watch.CAPTION :]
            film.seek(4)
            later = np.asarray(film.convert("RGB"))[watch.CAPTION :]
        assert first.std() > 5
        assert (first != later).any()
        assert main(["watch", str(tmp_path / "run"), "--seed", "5"]) == 2
