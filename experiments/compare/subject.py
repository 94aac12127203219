"""What is compared: one algorithm of one stored run, in the units and symbols of the theory."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import xarray as xr

from bridge_algos.evaluation import rounding_allowance
from bridge_algos.expert.dynamic_programming import backward_induction
from bridge_algos.mdp import FloatArray, IntArray
from bridge_algos.run.config import RunConfig
from bridge_algos.run.configuration import read_configuration
from bridge_algos.run.setting import theory_setting
from bridge_algos.run.store import load_run
from bridge_algos.run.world import World, build_world
from bridge_theory.errors import InputError
from bridge_theory.setting import Setting
from experiments.compare.certificates import certificates
from proofs_checks.verify import Certificate

COMPARED = ("bridge-known", "bridge")
"""The algorithms that the theory speaks about; PbRL and BC have no version of it."""

_POINTS = 40


@dataclass(frozen=True, eq=False)
class Subject:
    """One algorithm of one run.

    Args:
        algorithm: one of ``COMPARED``.
        config, world: of the run.
        results: the run's data set of this algorithm, over (seed, round).
        rounds: (G,) the rounds t at which curves are evaluated, the last one T.
        name: of the run.
        certificates: what the checker found in the run's logs, by algorithm and seed, or why it checked none.
    """

    algorithm: str
    config: RunConfig
    world: World
    results: xr.Dataset
    rounds: IntArray
    name: str
    certificates: dict[tuple[str, int], Certificate] | str

    @property
    def known(self) -> bool:
        """Whether the algorithm knows the dynamics."""
        return self.algorithm == "bridge-known"

    @property
    def regret(self) -> FloatArray:
        """(seeds, G) cumulative pseudo-regret in units of utility, exact for each seed."""
        return self.at_rounds(self.record("pseudo_regret").cumsum(axis=1)) * self.world.utility_scale

    def record(self, name: str) -> FloatArray:
        """(seeds, T) a recorded quantity."""
        return np.asarray(self.results[name].transpose("seed", "round"), dtype=np.float64)

    def at_rounds(self, values: FloatArray) -> FloatArray:
        """The columns of (seeds, T) values that belong to ``rounds``."""
        return np.asarray(values[:, self.rounds - 1])

    @property
    def lacking(self) -> int:
        """In how many seeds every policy searched is worse than the one that regret is against."""
        expert = self.world.expert
        best = expert.expected_return - np.asarray(self.results["best_candidate"], dtype=np.float64)
        return int((expert.best_stationary.value - best > expert.tolerance).sum())

    @property
    def range_of_a_round(self) -> tuple[float, float]:
        """Between what the regret of any round lies, in units of utility, whatever is played and in every seed.

        From the certified best stationary policy and the worst policy, by backward induction, rounded outward.
        """
        mdp, optimum = self.world.mdp, self.world.expert.best_stationary
        allowance = rounding_allowance(mdp)
        worst = -float(mdp.initial @ backward_induction(dataclasses.replace(mdp, reward=-mdp.reward))[1][0])
        scale = self.world.utility_scale
        return (optimum.value - optimum.upper - allowance) * scale, (optimum.value - worst + allowance) * scale

    def number(self, name: str) -> float:
        """A parameter of the setting as a float."""
        return float(self.setting[name])  # type: ignore[arg-type]  # none of them is a table

    @cached_property
    def setting(self) -> Setting:
        """The parameters of the formulas, without T; every event of a bound may fail with probability delta."""
        delta = repr(self.config.delta)
        return theory_setting(self.config, self.world).replace(
            **{f"delta_{event}": delta for event in ("off", "w", "F", "P", "M")}
        )


def subjects(directory: Path, jobs: int = 1) -> list[Subject]:
    """The algorithms of a stored run that can be compared; ``jobs`` processes check its logs.

    Raises:
        InputError: when there is no run; see also :func:`compared_algorithms`.
    """
    results = load_run(directory)
    config = read_configuration(results.attrs["configuration"])
    if not isinstance(config, RunConfig):
        raise InputError(
            f"{directory} holds a run of {config.environment}, whose features are sampled and whose best policy is not "
            "known; the theory can be compared on tabular environments."
        )
    world = build_world(config)
    names = compared_algorithms(config, world)
    found = certificates(directory, config, results, jobs)
    grid, run = evaluation_rounds(results.sizes["round"]), directory.resolve().name
    return [Subject(name, config, world, results.sel(algorithm=name), grid, run, found) for name in names]


def compared_algorithms(config: RunConfig, world: World) -> tuple[str, ...]:
    """The algorithms of a configuration about which there is a theory, in the order of ``COMPARED``.

    Raises:
        InputError: when there is none, or the utility is not linear in the embedding, so that no bound applies.
    """
    names = tuple(name for name in COMPARED if name in config.algorithms)
    if not names:
        raise InputError(
            f"the run has only {', '.join(config.algorithms)}, about which there is no theory to compare; run with "
            f"--algorithms {' or '.join(COMPARED)}."
        )
    if world.w_star is None:
        raise InputError(
            f"rewards are not linear in the embedding {config.embedding!r}, so that the regret of the theory is not "
            "defined; use --preset theory or --set embedding=state_action_counts."
        )
    return names


def evaluation_rounds(last: int) -> IntArray:
    """Rounds 1 .. last, or where there are many, equally spaced ones on both scales, linear and logarithmic.

    >>> evaluation_rounds(3), len(evaluation_rounds(10**4)) <= 80
    (array([1, 2, 3]), True)
    """
    spaced = np.concatenate([np.linspace(1, last, _POINTS), np.geomspace(1, last, _POINTS)])
    return np.unique(np.round(spaced).astype(np.int64))
