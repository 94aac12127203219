"""Every example of the README runs as it stands."""

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
COMMANDS = [
    line.removeprefix("$ ")
    for block in re.findall(r"```console\n(.*?)```", README, flags=re.DOTALL)
    for line in block.splitlines()
    if line.startswith("$ ")
]


def test_there_are_examples_of_each_use() -> None:
    assert len(PYTHON) >= 2
    assert {shlex.split(command)[1] for command in COMMANDS} >= {"run", "verify", "compare", "report", "reproduce", "bounds", "plan"}


def execute(arguments: list[str], tmp_path: Path) -> str:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "error", "MPLBACKEND": "Agg"}
    done = subprocess.run(arguments, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("code", PYTHON)
def test_python(code: str, tmp_path: Path) -> None:
    assert execute([sys.executable, "-c", code], tmp_path).strip()


@pytest.mark.parametrize("command", COMMANDS)
def test_command(command: str, tmp_path: Path) -> None:
    program, *arguments = shlex.split(command)
    assert program == "bridge-rl"
    assert execute([sys.executable, "-m", "experiments.cli", *arguments], tmp_path).strip()


def test_pictures_exist() -> None:
    pictures = re.findall(r"!\[.*?\]\((.*?)\)", README) + re.findall(r"<img src=\"(.*?)\"", README)
    assert pictures
    assert all((ROOT / picture).is_file() for picture in pictures)
