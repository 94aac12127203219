"""Every fenced example of the README runs as it stands; the MuJoCo commands take minutes and are indented."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
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
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "error", "MPLBACKEND": "Agg"}
    done = subprocess.run(arguments, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("code", PYTHON)
def test_python(code: str, tmp_path: Path) -> None:
    assert execute([sys.executable, "-c", code], tmp_path).strip()


@pytest.mark.parametrize("commands", BLOCKS, ids=lambda commands: commands[0][1])
def test_commands_of_a_block_one_after_the_other(commands: list[list[str]], tmp_path: Path) -> None:
    for program, *arguments in commands:
        assert program == "bridge-rl"
        assert execute([sys.executable, "-m", "experiments.cli", *arguments], tmp_path).strip()


def test_pictures_exist() -> None:
    pictures = re.findall(r"!\[.*?\]\((.*?)\)", README) + re.findall(r"<img src=\"(.*?)\"", README)
    assert pictures
    assert all((ROOT / picture).is_file() for picture in pictures)
