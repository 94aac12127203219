"""experiments -> proofs_checks -> bridge_algos -> bridge_theory, and nothing heavy before it is needed."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ROOMS = ("bridge_theory", "bridge_algos", "proofs_checks", "experiments")


def imported_rooms(path: Path) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names.add(node.module.split(".")[0])
    return names & set(ROOMS)


@pytest.mark.parametrize("room", ROOMS)
def test_no_room_imports_a_higher_one(room: str) -> None:
    allowed = set(ROOMS[: ROOMS.index(room) + 1])
    offenders = {str(p): imported_rooms(p) - allowed for p in (ROOT / room).rglob("*.py")}
    assert {path: rooms for path, rooms in offenders.items() if rooms} == {}


@pytest.mark.parametrize(
    ("statement", "absent"),
    [
        ("import bridge_theory", "torch gymnasium mujoco cvxpy matplotlib sympy scipy"),
        ("import bridge_algos, bridge_algos.envs.registry", "torch mujoco cvxpy matplotlib gymnasium minari"),
        ("import bridge_algos.run.runner", "torch mujoco minari sympy"),
        ("import experiments.cli", "torch mujoco cvxpy matplotlib sympy scipy xarray"),
    ],
)
def test_import_loads_nothing_heavy(statement: str, absent: str) -> None:
    program = f"{statement}; import sys; print(*(set({absent.split()!r}) & set(sys.modules)))"
    loaded = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=ROOT)
    assert loaded.stdout.split() == []
