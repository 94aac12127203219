"""A run of any number of rounds, one included, is drawn without a warning (warnings are errors here)."""

from pathlib import Path

import pytest

from bridge_algos.run import plots
from bridge_algos.run.config import preset
from bridge_algos.run.runner import run


@pytest.mark.parametrize("rounds", [1, 3])
def test_the_axis_spans_the_rounds(rounds: int, tmp_path: Path) -> None:
    config = preset("published", "starmdp").but(rounds=rounds, algorithms=("bridge", "bc"))
    picture = plots.figure(run(config, tmp_path, seeds=2))
    assert {axes.get_xlim() for axes in picture.axes} == {(1, max(rounds, 2))}
