"""``import bridge_algos.envs`` costs NumPy and nothing heavier."""

import subprocess
import sys

import pytest

HEAVY = ("gymnasium", "matplotlib", "minari", "cvxpy", "torch", "mujoco", "scipy", "pygame", "PIL")


@pytest.mark.parametrize(
    "statement", ["import bridge_algos.envs", "from bridge_algos.envs import gridworld; gridworld()"]
)
def test_nothing_heavy_is_loaded(statement):
    code = f"{statement}\nimport sys\nprint(*[name for name in {HEAVY!r} if name in sys.modules])"
    loaded = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert loaded.split() == []
