"""What a log must satisfy before any bound is computed: each step follows from the log's configuration and data.

Entries that no step shows (how candidates and expert were chosen) are read for the certificate's assumptions only.
"""

from __future__ import annotations

import reprlib
from math import prod

import numpy as np

from bridge_algos.envs.registry import make_mdp
from bridge_theory.errors import InputError
from proofs_checks.verify.facts import Facts
from proofs_checks.verify.features import IntArray, approximate_bound

ALL = "all policies are searched"
VERSION_SPACE = "every policy that agrees with all demonstrations is searched"

BALL_SLACK = 1e-9
"""Relative excess over W that the rounding of a projection may leave."""


def contradictions(facts: Facts) -> list[str]:
    """Everything in a log that no run of its configuration could have written, in sentences."""
    return [
        *_configuration(facts),
        *_environment(facts),
        *_trajectories(facts),
        *_weights(facts),
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
        return []
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


def _trajectories(facts: Facts) -> list[str]:
    faults = []
    for t, (pair, states, actions) in enumerate(zip(facts.pairs, facts.states, facts.actions, strict=True), start=1):
        for i, visited, chosen in zip(pair, states, actions, strict=True):
            if not np.array_equal(facts.policies[i][visited], chosen):
                faults.append(f"round {t}: a trajectory takes actions that policy {i} does not take")
            if not _possible(facts, visited, chosen):
                faults.append(
                    f"round {t}: a trajectory of policy {i} passes a transition that the environment excludes"
                )
    config = facts.configuration
    if config.get("noise") == 0 and not _possible(facts, *facts.demonstrations):
        faults.append("a demonstration passes a transition that the environment excludes")
    deterministic = config.get("expert") == "best-stationary" and config.get("demonstrations") is None
    if deterministic and config.get("noise") == 0 and contradictory(facts):
        faults.append("the demonstrations contradict each other, though the expert is deterministic")
    return faults


def _possible(facts: Facts, states: IntArray, actions: IntArray) -> bool:
    steps = facts.kernel[states[:, :-1], actions[:, :-1], states[:, 1:]]
    return bool((facts.initial[states[:, 0]] > 0).all() and (steps > 0).all())


def _weights(facts: Facts) -> list[str]:
    norms = np.linalg.norm(facts.w, axis=1)
    outside = np.flatnonzero(norms > float(facts.weight_bound) * (1 + BALL_SLACK))
    return [
        f"round {t + 1}: the weights have norm {norms[t]:.6g}, above W = {float(facts.weight_bound):.6g}"
        for t in outside
    ]


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
    if config.get("radius") != "zero" or facts.algorithm == "pbrl" or contradictory(facts):
        return []
    states, actions = facts.demonstrations
    wrong = (facts.policies[:, states.ravel()] != actions.ravel()).any(axis=1)
    if wrong.any():
        faults.append(f"{int(wrong.sum())} of the policies searched do not agree with the demonstrations")
    _, n_states, n_actions, _ = facts.table.places.shape
    size, limit = n_actions ** (n_states - len(np.unique(states))), config.get("candidate_limit")
    if config.get("candidates") == "exact" and isinstance(limit, int) and size <= limit:
        distinct = len(np.unique(facts.policies, axis=0))
        if not size == distinct == len(facts.policies):
            faults.append(
                f"{size} policies agree with the demonstrations, the log searches {len(facts.policies)}, {distinct} of "
                "them different"
            )
    return faults


def contradictory(facts: Facts) -> bool:
    """Whether two demonstrated actions differ in one state."""
    states, actions = (part.ravel() for part in facts.demonstrations)
    return bool(len(np.unique(np.stack([states, actions]), axis=1).T) > len(np.unique(states)))


def best_policy_is_searched(facts: Facts) -> str | None:
    """Why the best stationary deterministic policy is surely among the candidates; None where a log cannot show it."""
    _, n_states, n_actions, _ = facts.table.places.shape
    distinct = len(np.unique(facts.policies, axis=0))
    if distinct == n_actions**n_states:
        return ALL
    free = n_states - len(np.unique(facts.demonstrations[0]))
    config = facts.configuration
    closed = config.get("radius") == "zero" and facts.algorithm != "pbrl" and config.get("noise") == 0
    if closed and not contradictory(facts) and distinct == n_actions**free:
        return VERSION_SPACE
    return None
