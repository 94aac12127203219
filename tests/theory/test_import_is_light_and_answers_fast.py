"""What a user waits for: imports, the bounds command, and a million points of any formula."""

from __future__ import annotations

import subprocess
import sys
import time

import numpy as np
import pytest

from bridge_theory.catalog import FORMULAS
from bridge_theory.formula import Formula
from bridge_theory.parameters import parameter

_HEAVY = ("sympy", "scipy", "cvxpy", "torch", "gymnasium", "matplotlib", "pandas", "xarray")
# values at which every formula's conditions hold
_MIDDLE = {"S": 5, "A": 4, "H": 8, "n": 1000, "T": 500, "t": 50, "d": 3, "rows": 20, "N": 9, "delta": 0.05}


def _run(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout


def test_import_loads_numpy_and_flint_only() -> None:
    loaded = _run(f"import sys, bridge_theory; print([m for m in {_HEAVY!r} if m in sys.modules])")
    assert loaded.strip() == "[]"


def test_bounds_command_is_light_and_takes_under_half_a_second_of_cpu() -> None:
    flags = "--S 5 --A 4 --H 8 --n 2 --delta 0.05 --gamma-min 0.1 --d 3 --B 1 --W 0.5 --lam 1 --T 1000"
    code = (
        "import sys, time, contextlib, io\n"
        "from bridge_theory.cli.bounds import main\n"
        f"with contextlib.redirect_stdout(io.StringIO()) as out: main({flags!r}.split())\n"
        f"print([m for m in {_HEAVY!r} if m in sys.modules], len(out.getvalue().splitlines()), time.process_time())"
    )
    fastest = min(float(_run(code).split()[-1]) for _ in range(3))
    assert _run(code).startswith("[] ")
    assert fastest < 0.5


def _middle(name: str) -> object:
    row = parameter(name)
    if row.array:
        return [5, 5, 5] if row.domain.high is None else [1, 1, 1]
    return _MIDDLE.get(name, 2 if row.domain.integer else 0.5)


_FORMULAS = [f for f in FORMULAS.values() if any(not parameter(name).array for name in f.parameters)]


@pytest.mark.parametrize("formula", _FORMULAS, ids=lambda formula: formula.name)
def test_a_million_points_take_under_two_seconds(formula: Formula) -> None:
    point = {name: _middle(name) for name in formula.parameters}
    if formula.name == "transition_log_covering_two_states":
        point["S"] = 2
    scalars = [name for name in point if not parameter(name).array]
    varied = next((name for name in ("n", "T", "t", "delta", "epsilon", "R") if name in scalars), scalars[-1])
    values = np.arange(100, 1_000_100) if parameter(varied).domain.integer else np.linspace(0.1, 0.3, 10**6)
    started = time.process_time()
    result = formula.estimate(**{**point, varied: values})
    elapsed = time.process_time() - started
    assert np.shape(result) in ((10**6,), ())  # a statement may not use the failure probability it is given
    assert np.all(np.isfinite(result))
    assert elapsed < 2
