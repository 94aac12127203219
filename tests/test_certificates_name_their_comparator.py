"""No certificate is below the regret against the policy that its own sentence names, whatever the log says."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridge_algos.envs.registry import make_mdp
from bridge_algos.evaluation import expected_returns
from bridge_algos.policies import all_policies
from bridge_algos.run.config import RunConfig, preset
from bridge_algos.run.log import logged_seed
from bridge_algos.run.log_file import RunLog
from bridge_algos.run.world import World, build_world
from bridge_algos.trajectories import sample_trajectories, save_trajectories
from proofs_checks.verify import Certificate, comparator, verify
from proofs_checks.verify.comparator import BEST, SEARCHED
from proofs_checks.verify.facts import facts

GARNET = {"n_states": 3, "n_actions": 2, "branching": 2, "seed": 184, "horizon": 3}
ALGORITHMS = ("bridge", "bridge-known", "pbrl")
DECIDING: dict[str, tuple[Any, ...]] = {
    "expert": ("best-stationary", "finite-horizon-lp", "discounted-lp"),
    "demonstrations": (None, "worst"),
    "noise": (0.0, 1.0),
    "radius": ("zero", "repaired", 0.0),
    "candidates": ("exact", "rejection"),
    "candidate_limit": (20_000, 1),
}
"""Every entry that decides which policies are searched or who demonstrated, with all values or one of each kind."""

ROUNDS, SEEDS = 2, (0, 3)  # with these two every hypothesis below is false somewhere
DELTA = 1e-12
"""Of each event, so that thousands of certificates fail by chance with a probability far below 1e-6."""


Logs = list[tuple[RunConfig, World, RunLog, tuple[Certificate, ...]]]


def worst_demonstrations(path: Path) -> str:
    """A file from the worst stationary policy: it agrees with itself, as those of the best do."""
    mdp = make_mdp("garnet", **GARNET)
    policies = all_policies(mdp.n_states, mdp.n_actions)
    worst = policies[expected_returns(mdp, policies).argmin()]
    save_trajectories(path, sample_trajectories(mdp, worst, 2, np.random.default_rng(0)))
    return str(path)


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Logs:
    """Logs of every combination of the deciding entries, with their certificates."""
    file = worst_demonstrations(tmp_path_factory.mktemp("demonstrations") / "worst.npz")
    base = preset("theory", "garnet").but(
        environment_options=GARNET, n_demonstrations=1, rounds=ROUNDS, algorithms=ALGORITHMS, delta=DELTA, proposals=9
    )
    found, worlds = [], {}
    for values in itertools.product(*DECIDING.values(), SEEDS):
        changes = dict(zip([*DECIDING, "seed"], values, strict=True))
        seed, made_by = changes.pop("seed"), (changes["expert"], changes["demonstrations"])
        config = base.but(**changes | {"demonstrations": changes["demonstrations"] and file})
        world = worlds.setdefault(made_by, worlds.get(made_by) or build_world(config))
        log = logged_seed(config, world, seed)[1]
        found.append((config, world, log, verify(log)))
    return found


def true_regret(world: World, log: RunLog, algorithm: str, against: str) -> float:
    """In utility, from the exact returns of all policies."""
    searched = log.arrays[f"{algorithm}/policies"]
    every = all_policies(world.mdp.n_states, world.mdp.n_actions)
    best = expected_returns(world.mdp, {BEST: every, SEARCHED: searched}[against]).max()
    played = expected_returns(world.mdp, searched[log.arrays[f"{algorithm}/pairs"].ravel()])
    return float((best - played).sum() / 2 * world.utility_scale)


def found_false(logs: Logs) -> list[str]:
    """Certificates below the true regret against the policy that is named now, or that name one not searched."""
    false = []
    for config, world, log, certificates in logs:
        for item in certificates:
            named = comparator.comparator(facts(log, item.algorithm)).policy
            regret = true_regret(world, log, item.algorithm, named)
            if regret > true_regret(world, log, item.algorithm, SEARCHED) + 1e-9:
                false.append(f"{item.algorithm} does not search the best policy: {config}")
            for name, bound in item.bounds.items():
                if bound[-1] < regret - 1e-9:
                    false.append(f"{item.algorithm}, {name} {bound[-1]:.3g} < {regret:.3g}: {config}")
    return false


def test_no_certificate_is_below_the_regret_that_its_sentence_names(logs: Logs) -> None:
    """All values of every deciding entry; any of them is too small by chance with probability below 1e-6."""
    named = {BEST: 0, SEARCHED: 0}
    for _, _, log, certificates in logs:
        for item in certificates:
            assert item.certified, item.words()
            assert item.comparator == comparator.comparator(facts(log, item.algorithm))
            assert f"regret against {item.comparator.policy}: " in item.words()
            named[item.comparator.policy] += 1
    assert found_false(logs) == []
    assert min(named.values()) > 100
    assert sum(named.values()) * 2 * DELTA < 1e-6


HYPOTHESES: dict[str, tuple[str, Callable[[Any], Any]]] = {
    "the expert alone is believed": (
        "demonstrated_by_the_best",
        lambda _: lambda facts: facts.configuration["expert"] == "best-stationary" and not contradicted(facts),
    ),
    "anything that does not contradict itself": ("demonstrated_by_the_best", lambda _: lambda f: not contradicted(f)),
    "noise is forgotten": ("demonstrated_by_the_best", lambda f: lambda facts: f(without(facts, noise=0))),
    "a file is forgotten": ("demonstrated_by_the_best", lambda f: lambda facts: f(without(facts, demonstrations=None))),
    "a sample is taken for the whole": ("version_space_size", lambda _: lambda f: len(np.unique(f.policies, axis=0))),
}


def contradicted(facts: Any) -> bool:
    return comparator.contradictory(facts)


def without(facts: Any, **changes: Any) -> Any:
    return dataclasses.replace(facts, configuration=facts.configuration | changes)


@pytest.mark.parametrize("name", HYPOTHESES)
def test_a_hypothesis_that_slips_in_is_noticed(name: str, logs: Logs, monkeypatch: pytest.MonkeyPatch) -> None:
    function, change = HYPOTHESES[name]
    monkeypatch.setattr(comparator, function, change(getattr(comparator, function)))
    assert found_false(logs)


def test_as_many_policies_as_the_version_space_holds_are_not_the_version_space(logs: Logs) -> None:
    """The size of the set alone decides nothing: as many others leave the best policy out."""
    tried = 0
    for _, world, log, certificates in logs:
        for item in certificates:
            own = facts(log, item.algorithm)
            found = comparator.comparator(own)
            every = all_policies(world.mdp.n_states, world.mdp.n_actions)
            if found.policy != BEST or len(own.policies) == len(every):
                continue
            others = every[~(every[:, None] == own.policies).all(axis=2).any(axis=1)][: len(own.policies)]
            assert comparator.comparator(dataclasses.replace(own, policies=others)).policy == SEARCHED
            tried += 1
    assert tried > 5


def test_the_reported_example_is_certified_against_what_was_searched() -> None:
    """A regret of .57 where 4e-279 was certified: the expert depends on time, and the best policy is not searched."""
    config = preset("theory", "garnet").but(
        environment_options=GARNET, n_demonstrations=2, expert="finite-horizon-lp", algorithms=("bridge",)
    )
    world = build_world(config)
    dataset, log = logged_seed(config, world, 5)
    (item,) = verify(log)
    assert item.certified
    assert float(dataset.pseudo_regret.sum()) * world.utility_scale > 0.5
    assert item.bounds["best"][-1] < 1e-270
    assert item.comparator.policy == SEARCHED
    assert "best stationary" not in item.words()


def test_failure_probabilities_belong_to_bounds() -> None:
    """The trivial bound cannot fail; where the events' failures reach 1, nothing else is certified."""
    for delta, events in ((0.05, True), (0.49, True), (0.5, False), (0.9, False)):
        config = preset("theory", "starmdp").but(rounds=2, algorithms=("bridge", "bridge-known"), delta=delta)
        for item in verify(logged_seed(config, build_world(config), 0)[1]):
            count = 2 if item.algorithm == "bridge" else 1
            held = events or count == 1
            assert item.failures["trivial"] == 0
            assert item.failures["best"] == (float(count * Fraction(delta)) if held else 0)
            assert np.isfinite(item.bounds["ucb"]).all() == held
            assert (item.bounds["best"] == item.bounds["trivial"]).all() or held
            assert any("add up to 1 or more" in note for note in item.notes) != held
