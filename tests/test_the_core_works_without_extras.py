"""Without extras every subcommand works or names the extra it lacks; nothing ends in a traceback.

Everything that is installed, but no requirement of the package itself, is hidden from Python's import.
"""

import importlib.metadata
import re
import subprocess
import sys
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from experiments.cli import SUBCOMMANDS

ROOT = Path(__file__).parent.parent


def core_distributions() -> set[str]:
    """The package and everything that it requires without an extra, in pip's spelling."""
    found: set[str] = set()
    open_ends = [("bridge-rl", frozenset[str]())]
    while open_ends:
        name, extras = open_ends.pop()
        key = re.sub(r"[-_.]+", "-", name).lower()
        if key in found:
            continue
        found.add(key)
        for text in importlib.metadata.requires(name) or []:
            needed = Requirement(text)
            asked = needed.marker is None or any(needed.marker.evaluate({"extra": e}) for e in ("", *extras))
            if asked:
                open_ends.append((needed.name, frozenset(needed.extras)))
    return found


def hidden_modules() -> list[str]:
    core = core_distributions()
    return sorted(
        module
        for module, owners in importlib.metadata.packages_distributions().items()
        if not {re.sub(r"[-_.]+", "-", owner).lower() for owner in owners} & core
    )


HIDING = """
import sys

class Without:
    def __init__(self, finder):
        self.finder = finder

    def __getattr__(self, name):
        return getattr(self.finder, name)

    def find_spec(self, name, *rest):
        return None if name.partition(".")[0] in HIDDEN else self.finder.find_spec(name, *rest)

HIDDEN = set({hidden!r})
sys.meta_path[:] = [Without(finder) for finder in sys.meta_path]
sys.path.insert(0, {root!r})
"""


def program(code: str) -> str:
    return HIDING.format(hidden=hidden_modules(), root=str(ROOT)) + code


def test_what_is_hidden_are_the_extras() -> None:
    hidden = set(hidden_modules())
    assert {"pytest", "hypothesis"} <= hidden
    assert not {"numpy", "scipy", "sympy", "flint", "cvxpy", "matplotlib", "PIL", "pandas", "bridge_theory"} & hidden
    code = program("import importlib.util; print([n for n in HIDDEN if importlib.util.find_spec(n) is not None])")
    assert subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout == "[]\n"


def test_only_the_evidence_of_the_ledger_cannot_be_imported() -> None:
    """Its modules are reached by 'check' alone, which asks for the extra first."""
    code = program(
        """
import importlib, pkgutil
for room in ("bridge_theory", "bridge_algos", "proofs_checks", "experiments"):
    for module in pkgutil.walk_packages(importlib.import_module(room).__path__, f"{room}."):
        if module.name.endswith("__main__"):
            continue
        try:
            importlib.import_module(module.name)
        except ModuleNotFoundError as error:
            print(module.name, error.name.partition(".")[0])
"""
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    failing = [line.split() for line in done.stdout.splitlines()]
    assert {lacking for _, lacking in failing} == {"hypothesis", "z3", "latex2mathml"}
    assert all(name.startswith("proofs_checks.") for name, _ in failing)


RUN = ["run", "starmdp", "--preset", "theory", "--algorithms", "bridge-known", "--seeds", "1", "--rounds", "2"]
SETTING = ["--S", "5", "--A", "4", "--H", "8", "--delta", "0.05", "--gamma-min", "0.1"]
WORKS = [
    [*RUN, "--log", "--out", "r", "--jobs", "1"],
    ["verify", "r"],
    ["compare", "r", "--jobs", "1"],
    ["report", "r", "--jobs", "1"],
    ["bounds", *SETTING, "--n", "2"],
    ["bounds", *SETTING, "--sweep", "n=1:1e4:log"],
    ["plan", "--target-radius", "0.9", *SETTING],
    ["reproduce", "ladder-starmdp", "--quick", "--jobs", "1"],
    ["run", "reacher", "--show-config"],
    *([name, "--help"] for name in SUBCOMMANDS),
]
REFUSED = {
    "checks": [["check", "--quick"], ["check", "--list"], ["check", "--search", "thm:main_known"]],
    "continuous": [
        ["run", "reacher", "--include-expert", "--seeds", "1"],
        ["run", "Hopper-v5"],
        ["run", "starmdp", "--set", "transition_model=mlp", "--seeds", "1", "--jobs", "1"],
        ["watch", "reacher"],
        ["expert", "evaluate", "ant"],
        ["expert", "train", "reacher"],
        ["expert", "demonstrate", "reacher", "--out", "d.npz"],
        ["reproduce", "fig2-reacher", "--quick", "--jobs", "1"],
    ],
}


def test_every_subcommand_works_or_names_the_extra_that_it_lacks(tmp_path: Path) -> None:
    assert {command[0] for command in [*WORKS, *(c for commands in REFUSED.values() for c in commands)]} == set(
        SUBCOMMANDS
    )
    commands = WORKS + [command for commands in REFUSED.values() for command in commands]
    code = program(
        f"""
import contextlib, io, matplotlib, traceback, warnings
warnings.simplefilter("error")
matplotlib.use("Agg")
from experiments.cli import main
for command in {commands!r}:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            status = main(command)
        except SystemExit as error:
            status = error.code
        except BaseException:
            status = traceback.format_exc()
    print(repr((command, status, out.getvalue(), err.getvalue())))
"""
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    answers = [eval(line) for line in done.stdout.splitlines()]
    assert len(answers) == len(commands)
    for command, status, out, _ in answers[: len(WORKS)]:
        assert (command, status) == (command, 0)
        assert out.strip()
    extras = [extra for extra, refused in REFUSED.items() for _ in refused]
    for extra, (command, status, _, err) in zip(extras, answers[len(WORKS) :], strict=True):
        assert (command, status) == (command, 2)
        assert err.count("\n") == 1
        assert f"pip install 'bridge-rl[{extra}]'" in err
    assert (
        "Which of the stated bounds are false in general is not told here" in (tmp_path / "r/compare.txt").read_text()
    )
    page = (tmp_path / "r/report.html").read_text()
    assert "The ledger needs its engines" in page


@pytest.mark.parametrize(
    ("arguments", "printed"),
    [
        (["experiments", "--version"], f"bridge-rl {importlib.metadata.version('bridge-rl')}\n"),
        (["experiments.cli", "--version"], f"bridge-rl {importlib.metadata.version('bridge-rl')}\n"),
        (["experiments", "fly"], "unknown subcommand 'fly'"),
        (["proofs_checks", "--budget", "0"], "python -m proofs_checks: --budget 0 is no time"),
        (["proofs_checks.mutate", "--sample", "-1"], "python -m proofs_checks.mutate: "),
    ],
)
def test_modules_run_as_commands(arguments: list[str], printed: str) -> None:
    done = subprocess.run([sys.executable, "-m", *arguments], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == (0 if "--version" in arguments else 2), done.stderr
    assert printed in done.stdout + done.stderr
    assert "Traceback" not in done.stderr
