"""A refusal gives the true reason: a file that is there is not called missing, nor a known environment unknown."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

from bridge_algos.npz import read_arrays
from bridge_theory.errors import InputError
from experiments.cli import main

OTHER_FILES = {
    "x.csv": b"state,action\n0,1\n",
    "x.hdf5": b"\x89HDF\r\n\x1a\n" + bytes(100),
    "x.pkl": b"\x80\x04N.",
    "x.json": b"{}",
    "x.npy": b"\x93NUMPY" + bytes(100),
    "x.npz": b"no archive",
    "x.parquet": b"PAR1",
}
READERS = {
    "tabular demonstrations": ("run", "starmdp", "--demos", "{}"),
    "an MDP": ("run", "{}"),
    "an MDP to compare": ("compare", "{}"),
    "demonstrations of bounds": ("bounds", "--demos", "{}", "--mdp", "starmdp"),
    "an MDP of bounds": ("bounds", "--demos", "{}", "--mdp", "{}"),
    "a log": ("verify", "{}"),
    "demonstrations in MuJoCo": ("run", "reacher", "--demos", "{}"),
    "an expert": ("expert", "evaluate", "reacher", "--expert", "{}"),
}


def answer(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(list(arguments)) == 2
    captured = capsys.readouterr()
    assert captured.err.count("\n") == 1
    return captured.err


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name, content in OTHER_FILES.items():
        Path(name).write_bytes(content)


@pytest.mark.parametrize("file", OTHER_FILES)
@pytest.mark.parametrize("reader", READERS)
def test_files_of_another_kind_are_called_that(reader: str, file: str, capsys: pytest.CaptureFixture[str]) -> None:
    if "reacher" in READERS[reader]:
        pytest.importorskip("mujoco", reason="needs MuJoCo (the extra 'continuous')")
    message = answer(capsys, *(part.format(file) for part in READERS[reader]))
    assert file in message
    assert "of another kind" in message or "may be a pickle" in message
    for wrong in ("does not exist", "there is no", "not installed", "save it again", "download"):
        assert wrong not in message


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("run", "hopper"), "'hopper' is no tabular environment; Hopper-v5 of MuJoCo is run by that id"),
        (("run", "half-cheetah"), "HalfCheetah-v5 of MuJoCo is run by that id"),
        (("compare", "reacher", "--seeds", "1"), "'reacher' is no tabular environment; Reacher-v5 of MuJoCo"),
        (("bounds", "--demos", "x.npz", "--mdp", "ant"), "'ant' is no tabular environment"),
        (("expert", "evaluate", "hopper"), "there is no environment 'hopper' (did you mean Hopper-v5?)"),
        (("run", "Hoper-v5"), "there is no environment 'Hoper-v5'; expected one of reacher, ant or the id"),
        (("run", "FrozenLake-v1"), "'FrozenLake-v1' is not simulated by MuJoCo (it is tabular: 'frozenlake' here)"),
        (("run", "CartPole-v1"), "'CartPole-v1' is not simulated by MuJoCo"),
        (("watch", "hopper"), "no MuJoCo environment by that name, but Hopper-v5 is one"),
        (("watch", "nowhere"), "'nowhere' is no directory of a run and no MuJoCo environment; expected one of the two"),
        (("run", "frozen-lake"), "there is no environment 'frozen-lake' (did you mean 'frozenlake'?)"),
        (("run", "n" * 5000), "there is no environment"),
        (("verify", "nowhere"), "nowhere does not exist"),
    ],
)
@pytest.mark.parametrize("simulator", [True, False])
def test_known_environments_are_not_called_unknown_nor_unknown_ones_uninstalled(
    arguments: tuple[str, ...],
    reason: str,
    simulator: bool,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    if not simulator:
        monkeypatch.setitem(__import__("sys").modules, "mujoco", None)
    assert reason in answer(capsys, *arguments)


def test_a_damaged_archive_is_not_called_one_of_another_kind(tmp_path: Path) -> None:
    np.savez("whole.npz", states=np.zeros(1000))
    Path("cut.npz").write_bytes(Path("whole.npz").read_bytes()[:600])
    Path("empty.npz").write_bytes(b"")
    for name in ("cut.npz", "empty.npz"):
        with pytest.raises(InputError, match=rf"{name} is not a readable .npz file of plain arrays .*; save it again"):
            read_arrays(name, ("states",))


def pickled() -> bytes:
    content = io.BytesIO()
    np.savez(content, states=np.array([None], dtype=object), actions=np.zeros(1))
    return content.getvalue()


def zipped_pickle() -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        archive.writestr("data", "{}")
        archive.writestr("policy.pth", b"\x80\x04cos\nsystem\n(S'true'\ntR.")
    return content.getvalue()


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize(("suffix", "content"), [(".npz", pickled()), (".zip", zipped_pickle())])
def test_no_refusal_passes_on_the_advice_to_load_a_pickle(
    reader: str, suffix: str, content: bytes, capsys: pytest.CaptureFixture[str]
) -> None:
    if "reacher" in READERS[reader]:
        pytest.importorskip("mujoco", reason="needs MuJoCo (the extra 'continuous')")
    Path(f"evil{suffix}").write_bytes(content)
    message = answer(capsys, *(part.format(f"evil{suffix}") for part in READERS[reader]))
    for advice in ("allow_pickle", "weights_only", "unsafe", "trust", "torch.load", "pickle.load"):
        assert advice not in message
