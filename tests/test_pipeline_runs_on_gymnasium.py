"""The whole pipeline on environments that we did not write."""

import numpy as np
import pytest

from bridge_algos.run.config import preset
from bridge_algos.run.seed import run_seed
from bridge_algos.run.world import build_world


@pytest.mark.parametrize("environment", ["frozenlake", "cliffwalking"])
@pytest.mark.parametrize("name", ["published", "theory"])
def test_pipeline(environment: str, name: str) -> None:
    config = preset(name, environment).but(
        rounds=3, proposals=2000, candidate_limit=500, search_size=200, environment_options={"horizon": 20}
    )
    result = run_seed(config, build_world(config), 0)
    assert list(result.algorithm.values) == ["bridge", "pbrl", "bc"]
    assert bool(np.isfinite(result.suboptimality).all())
