"""A certified bound is below the realised pseudo-regret no more often than its failure probability allows."""

from fractions import Fraction

import numpy as np

from bridge_algos.run.config import preset
from bridge_algos.run.log import logged_seed
from bridge_algos.run.world import build_world
from proofs_checks.coverage import FALSE_ALARM, Coverage
from proofs_checks.verify import verify

SEEDS = 200
ROUNDING = 1e-9
"""Of the realised regret, which is computed in plain doubles."""


def test_the_certified_bound_covers_the_regret_of_200_seeds() -> None:
    """StarMDP, known dynamics, Bradley-Terry answers, theory preset, T = 25; exact binomial test over seeds."""
    config = preset("theory", "starmdp").but(algorithms=("bridge-known",))
    world = build_world(config)
    regrets, bounds, answers = [], [], []
    for seed in range(SEEDS):
        dataset, log = logged_seed(config, world, seed)
        (certificate,) = verify(log)
        assert certificate.certified, certificate.words()
        assert certificate.failure == config.delta
        regrets.append(world.utility_scale * np.cumsum(dataset.pseudo_regret.sel(algorithm="bridge-known").values))
        bounds.append(certificate.bounds["best"])
        answers.append(certificate.bounds["likelihood"])
    regret = np.array(regrets)
    assert regret.shape == (SEEDS, 25)

    def covered(bound: list[np.ndarray], divisor: float) -> Coverage:
        failed = (np.array(bound) / divisor < regret - ROUNDING).any(axis=1)
        return Coverage(Fraction(config.delta), SEEDS, int(failed.sum()))

    for bound in (bounds, answers):  # each on an event of that probability
        assert covered(bound, 1).false_alarm < FALSE_ALARM
        assert covered(bound, 1).passes
        assert not covered(bound, 10).passes  # the test can fail: bounds ten times smaller are refuted by the same runs
