"""What a log must satisfy before any bound is computed: each step follows from the log's configuration and data.

Entries that no step shows are listed by :mod:`proofs_checks.verify.header`.
"""

from __future__ import annotations

import reprlib
from math import prod

import numpy as np

from bridge_algos.envs.registry import make_mdp
from bridge_theory.errors import InputError
from proofs_checks.verify.comparator import (
    STATIONARY,
    contradictory,
    contradictory_steps,
    disagreeing,
    version_space_size,
)
from proofs_checks.verify.facts import Facts
from proofs_checks.verify.features import IntArray, approximate_bound

BALL_SLACK = 1e-9
"""Relative excess over W that the rounding of a projection may leave."""


def contradictions(facts: Facts) -> list[str]:
    """Everything in a log that no run of its configuration could have written, in sentences."""
    return [
        *_configuration(facts),
        *_environment(facts),
        *_demonstrations(facts),
        *_trajectories(facts),
        *_answers(facts),
        *_weights(facts),
        *_candidates(facts),
        *_repetitions(facts),
        *_version_space(facts),
    ]


def _configuration(facts: Facts) -> list[str]:
    config, faults = facts.configuration, []
    if config.get("rounds") != facts.rounds:
        faults.append(f"the log holds {facts.rounds} rounds, its configuration {reprlib.repr(config.get('rounds'))}")
    if not isinstance(config.get("algorithms"), list) or facts.algorithm not in config["algorithms"]:
        faults.append(f"the configuration does not run {facts.algorithm}")
    if config.get("rollouts") is not None:
        faults.append("the run's features are sampled, so that its sets cannot be recomputed; run with exact features")
    if config["transition_model"] != "counts":
        faults.append("the run's transitions come from a network, which cannot be recomputed from counts")
    given, weight_bound = config.get("weight_bound"), float(facts.weight_bound)
    expected = 1 / approximate_bound(facts.table) if given is None else given
    if not isinstance(expected, int | float) or not weight_bound * (1 - 1e-12) <= expected <= weight_bound * (
        1 + 1e-12
    ):
        faults.append(f"the weight bound is {weight_bound:.9g}, its configuration makes it {reprlib.repr(expected)}")
    return faults


def _environment(facts: Facts) -> list[str]:
    name, options = facts.configuration.get("environment"), facts.configuration.get("environment_options")
    if not isinstance(name, str) or not isinstance(options, dict):
        return ["the configuration names no environment"]
    if name.endswith(".npz"):
        return ["the environment is a file, which takes no options"] if options else []
    n_states, n_actions, _ = facts.kernel.shape
    sizes = {key: size for key, size in options.items() if key.startswith("n_") and isinstance(size, int)}
    more_actions = sizes.pop("n_actions", 0) > n_actions
    if more_actions or prod(sizes.values()) > n_states:  # before anything of that size is made
        return [f"the dynamics are smaller than those of the environment {name!r}"]
    try:
        mdp = make_mdp(name, **options)
    except (InputError, TypeError, ValueError, OverflowError) as error:
        return [f"the environment cannot be made again: {error}"]
    same = (
        mdp.horizon == facts.table.places.shape[0]
        and np.array_equal(mdp.transitions, facts.kernel)
        and np.array_equal(mdp.initial, facts.initial)
    )
    return [] if same else [f"the dynamics are not those of the environment {name!r}"]


def _demonstrations(facts: Facts) -> list[str]:
    """Their number, and that a deterministic expert made them, where they are drawn and recorded without noise."""
    config, faults = facts.configuration, list[str]()
    if config["demonstrations"] is not None:  # a file may hold anything, and from another environment
        return faults
    if config["noise"] == 0 and not possible(facts, *facts.demonstrations):
        faults.append("a demonstration passes a transition that the environment excludes")
    found, wanted = len(facts.demonstrations[0]), config["n_demonstrations"]
    if found != wanted:
        faults.append(f"the log holds {found} demonstrations, its configuration {reprlib.repr(wanted)}")
    differ = contradictory if config["expert"] in STATIONARY else contradictory_steps
    if config["noise"] == 0 and differ(facts):
        faults.append("the demonstrations contradict each other, though the expert is deterministic")
    return faults


def _trajectories(facts: Facts) -> list[str]:
    faults = []
    for t, (pair, states, actions) in enumerate(zip(facts.pairs, facts.states, facts.actions, strict=True), start=1):
        for i, visited, chosen in zip(pair, states, actions, strict=True):
            if not np.array_equal(facts.policies[i][visited], chosen):
                faults.append(f"round {t}: a trajectory takes actions that policy {i} does not take")
            if not possible(facts, visited, chosen):
                faults.append(
                    f"round {t}: a trajectory of policy {i} passes a transition that the environment excludes"
                )
    return faults


def possible(facts: Facts, states: IntArray, actions: IntArray) -> bool:
    """Whether the environment allows all trajectories, states and actions (n, H) each."""
    steps = facts.kernel[states[:, :-1], actions[:, :-1], states[:, 1:]]
    return bool((facts.initial[states[:, 0]] > 0).all() and (steps > 0).all())


def _answers(facts: Facts) -> list[str]:
    """Answers that the configured teacher cannot give."""
    config, outcomes = facts.configuration, facts.outcomes
    options = config["oracle_options"] if config["oracle"] == "returns" else {}
    given = np.isin(outcomes, (0.0, 1.0))
    given |= (outcomes == 0.5) & (options.get("equal_within", 0) > 0)
    given |= np.isnan(outcomes) & (options.get("skip_below", -np.inf) > -np.inf)
    return [] if given.all() else [f"the oracle {config['oracle']!r} of the configuration never answers like this"]


def _weights(facts: Facts) -> list[str]:
    norms = np.linalg.norm(facts.w, axis=1)
    outside = np.flatnonzero(norms > float(facts.weight_bound) * (1 + BALL_SLACK))
    return [
        f"round {t + 1}: the weights have norm {norms[t]:.6g}, above W = {float(facts.weight_bound):.6g}"
        for t in outside
    ]


def _candidates(facts: Facts) -> list[str]:
    """How many policies are searched, where the configuration decides it."""
    config, found = facts.configuration, len(facts.policies)
    _, n_states, n_actions, _ = facts.table.places.shape
    every, limit = n_actions**n_states, config["candidate_limit"]
    if facts.algorithm == "pbrl" and every <= limit:
        return [] if found == every else [f"the log searches {found} policies, its configuration {every}"]
    if facts.algorithm == "pbrl":
        most = config["search_size"]
    else:  # the clone may join those that were proposed
        most = limit if config["candidates"] == "exact" else config["proposals"] + 1
    return [f"the log searches {found} policies, its configuration at most {most}"] if found > most else []


def _repetitions(facts: Facts) -> list[str]:
    distinct = len(np.unique(facts.policies, axis=0))
    if distinct == len(facts.policies):
        return []
    return [f"the log searches {len(facts.policies)} policies, {distinct} of them different, which no run does"]


def _version_space(facts: Facts) -> list[str]:
    """Radius zero: exactly the policies that agree with every demonstration.

    Where demonstrations contradict each other (noise, a random expert) the set depends on what the clone made of them,
    which no log shows.
    """
    config, faults = facts.configuration, []
    if config["radius"] != "zero" or facts.algorithm == "pbrl" or contradictory(facts):
        return []
    wrong = disagreeing(facts)
    if wrong.any():
        faults.append(f"{int(wrong.sum())} of the policies searched do not agree with the demonstrations")
    size = version_space_size(facts)
    if config["candidates"] == "exact" and size <= config["candidate_limit"]:
        distinct = len(np.unique(facts.policies, axis=0))
        if not size == distinct == len(facts.policies):
            faults.append(
                f"{size} policies agree with the demonstrations, the log searches {len(facts.policies)}, {distinct} of "
                "them different"
            )
    return faults
