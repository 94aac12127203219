"""The optional network learns the transition frequencies, reproducibly, and says what it needs."""

import sys

import numpy as np
import pytest

from bridge_algos.continuous.transition_mlp import fit_transition_mlp
from bridge_algos.run.config import preset
from bridge_algos.run.seed import run_seed
from bridge_algos.run.world import build_world
from bridge_theory.errors import InputError


def test_it_learns_frequencies_and_is_reproducible() -> None:
    pytest.importorskip("torch")
    counts = np.zeros((3, 2, 3), dtype=np.int64)
    counts[0, 0] = [80, 20, 0]
    counts[1, 1] = [0, 0, 50]
    one, two = (fit_transition_mlp(counts, np.random.default_rng(3)) for _ in range(2))
    np.testing.assert_array_equal(one, two)
    np.testing.assert_allclose(one.sum(axis=2), 1)
    assert np.abs(one[0, 0] - [0.8, 0.2, 0]).max() < 0.02
    assert one[1, 1, 2] > 0.95
    np.testing.assert_allclose(fit_transition_mlp(0 * counts, np.random.default_rng(0)), 1 / 3)


def test_a_run_can_use_it() -> None:
    pytest.importorskip("torch")
    config = preset("published", "gridworld").but(transition_model="mlp", rounds=2, proposals=5000)
    assert bool(np.isfinite(run_seed(config, build_world(config), 0).suboptimality).all())


def test_without_torch_one_sentence_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(InputError, match="pip install"):
        fit_transition_mlp(np.ones((2, 1, 2), dtype=np.int64), np.random.default_rng(0))
