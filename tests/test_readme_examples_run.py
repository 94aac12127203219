"""Every fenced example of the README runs as it stands; the MuJoCo commands take minutes and are indented.

With ``README_PYTHON`` the examples run in that interpreter's environment, without this checkout on its path; where it
lacks an extra, naming the extra is all that a command must do.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
INSTALLED = os.environ.get("README_PYTHON")
INTERPRETER = INSTALLED or sys.executable
README = (ROOT / "README.md").read_text()
PYTHON = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
BLOCKS = [
    [shlex.split(line.removeprefix("$ ")) for line in block.splitlines() if line.startswith("$ ")]
    for block in re.findall(r"```console\n(.*?)```", README, flags=re.DOTALL)
]
USES = {"run", "verify", "compare", "report", "reproduce", "bounds", "plan", "check"}


def test_there_are_examples_of_each_use() -> None:
    assert len(PYTHON) >= 2
    assert {command[1] for block in BLOCKS for command in block} >= USES


def execute(arguments: list[str], tmp_path: Path) -> str:
    path = "" if INSTALLED else str(ROOT)
    environment = {**os.environ, "PYTHONPATH": path, "PYTHONWARNINGS": "error", "MPLBACKEND": "Agg"}
    done = subprocess.run(
        [INTERPRETER, *arguments], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    if INSTALLED and re.fullmatch(r"bridge-rl .* pip install 'bridge-rl\[\w+\]'\.\n", done.stderr):
        assert done.returncode == 2
        return done.stderr
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("code", PYTHON)
def test_python(code: str, tmp_path: Path) -> None:
    assert execute(["-c", code], tmp_path).strip()


@pytest.mark.parametrize("commands", BLOCKS, ids=lambda commands: commands[0][1])
def test_commands_of_a_block_one_after_the_other(commands: list[list[str]], tmp_path: Path) -> None:
    for program, *arguments in commands:
        assert program == "bridge-rl"
        assert execute(["-m", "experiments", *arguments], tmp_path).strip()


def test_pictures_exist() -> None:
    pictures = re.findall(r"!\[.*?\]\((.*?)\)", README) + re.findall(r"<img src=\"(.*?)\"", README)
    assert pictures
    assert all((ROOT / picture).is_file() for picture in pictures)
