"""A log's header: every entry there and of its type, and which entries nothing in the log shows.

What is not known to be shown is listed: an entry, or an array, that another version adds is named by itself.
"""

from __future__ import annotations

import json
import reprlib
from collections.abc import Callable, Mapping
from math import isnan
from typing import Any

import numpy as np

from bridge_algos.run.log_file import FORMAT, RunLog
from bridge_theory.errors import InputError
from proofs_checks.verify.entries import count, json_object, number, text
from proofs_checks.verify.facts import ARRAYS, OWN_ARRAYS, Facts, configured_algorithms


def _optional_text(entries: Mapping[str, Any], name: str) -> object:
    return None if entries.get(name) is None else text(entries, name)


def _optional(entries: Mapping[str, Any], name: str) -> object:
    return None if entries.get(name) is None else number(entries, name)


def _probability(entries: Mapping[str, Any], name: str) -> object:
    return number(entries, name, 0, 1)


def _nonnegative(entries: Mapping[str, Any], name: str) -> object:
    return number(entries, name, 0)


def _radius(entries: Mapping[str, Any], name: str) -> object:
    return text(entries, name) if isinstance(entries.get(name), str) else number(entries, name, 0)


def _option_values(entries: Mapping[str, Any], name: str) -> object:
    """An object of numbers, which may be infinite."""
    options = json_object(entries, name)
    for key, value in options.items():
        if isinstance(value, bool) or not isinstance(value, int | float) or isnan(value):
            raise InputError(f"the log's {name} has {key!r} = {reprlib.repr(value)}, expected a number.")
    return options


_KINDS: dict[str, Callable[[Mapping[str, Any], str], object]] = {
    **dict.fromkeys(("environment", "expert", "solver", "tie_break", "candidates", "embedding", "fit"), text),
    **dict.fromkeys(("transition_model", "empty_row", "pair_rule", "confidence", "oracle"), text),
    **dict.fromkeys(("environment_digest", "demonstrations", "demonstrations_digest"), _optional_text),
    **dict.fromkeys(
        ("rounds", "comparisons", "n_demonstrations", "proposals", "candidate_limit", "search_size"), count
    ),
    **dict.fromkeys(("discount", "noise", "delta"), _probability),
    **dict.fromkeys(("rollouts", "weight_bound"), _optional),
    **dict.fromkeys(("lam", "slope"), number),
    **dict.fromkeys(("gamma", "bonus_multiplier"), _nonnegative),
    "radius": _radius,
    "environment_options": json_object,
    "oracle_options": _option_values,
}
"""How each entry of the configuration is read; the numbers' own ranges are those of the code that uses them."""


def check_header(log: RunLog) -> None:
    """Refuse a header that lacks an entry, has one of another type, or another list of algorithms than the data.

    Raises:
        InputError: in one sentence.
    """
    if log.header.get("format") != FORMAT:
        found = reprlib.repr(log.header.get("format"))
        raise InputError(f"the log's format is {found}, expected {FORMAT!r}; store it again.")
    config, versions = json_object(log.header, "configuration"), json_object(log.header, "versions")
    if not all(isinstance(value, str) for value in versions.values()):
        raise InputError("the log's versions must be texts; store the log again.")
    for name, read in _KINDS.items():
        if name not in config:
            raise InputError(f"the log's configuration lacks {name}; store the log again.")
        read(config, name)
    named = log.header.get("algorithms")
    if not isinstance(named, list) or not all(isinstance(name, str) for name in named):
        raise InputError(f"the log names its algorithms as {reprlib.repr(named)}, expected a list of names.")
    searches = json_object(log.header, "search")
    if set(searches) != set(log.algorithms) or not all(isinstance(words, str) for words in searches.values()):
        raise InputError(
            "the log's search must say in words what each of its algorithms searched; store the log again."
        )
    configured = configured_algorithms(log)
    if not configured or list(log.algorithms) != configured or len(set(configured)) < len(configured):
        raise InputError(
            f"the log holds {', '.join(log.algorithms) or 'no algorithm'}, its configuration runs "
            f"{', '.join(configured) or 'none that can be checked'}; log a run of bridge, bridge-known or pbrl."
        )


def unshown(log: RunLog, facts: Facts) -> dict[str, str]:
    """The entries that may be changed without a contradiction to the data: what is written there is taken at its word.

    Args:
        log: as it was read.
        facts: one algorithm of it.

    Returns:
        What of each entry the data show, "" for nothing.
    """
    config, shown = facts.configuration, _shown(facts)
    unread = ("environment",) if config["environment"].endswith(".npz") else ()  # the file is not read again
    found = {_printable(name): _PARTLY_HEADER.get(name, "") for name in log.header if name not in _SHOWN_HEADER}
    for name, value in config.items():
        if name not in shown:
            found[f"{_printable(name)} = {_written(value)}"] = "" if name in unread else _PARTLY.get(name, "")
    known = {*ARRAYS, *(f"{algorithm}/{name}" for algorithm in log.algorithms for name in OWN_ARRAYS)}
    return found | {f"the array {json.dumps(name)}": "" for name in log.arrays if name not in known}


def _printable(name: str) -> str:
    """A name as it is, or quoted where it is none: a log may say anything."""
    return name if name.isidentifier() and name.isascii() else json.dumps(name)


def _written(value: Any) -> str:
    """A value as JSON, which escapes what a terminal would obey, cut where it is long."""
    written = json.dumps(value)
    return written if len(written) <= _LONGEST else written[:_LONGEST] + "..."


_LONGEST = 120
_SHOWN_HEADER = ("format", "configuration", "horizon", "weight_bound", "algorithms")
_PARTLY_HEADER = {"search": "the names of the algorithms"}
_PARTLY = {
    **dict.fromkeys(("environment", "environment_options"), "the dynamics"),
    "algorithms": "those that learn",
    **dict.fromkeys(
        ("radius", "candidates", "candidate_limit", "proposals", "search_size"), "that the policies searched fit it"
    ),
    **dict.fromkeys(("expert", "noise"), "that the demonstrations fit it"),
    **dict.fromkeys(("oracle", "oracle_options"), "that the answers fit it"),
    "pair_rule": "that the pairs fit it",
    "empty_row": "that the features fit it",
}


def _shown(facts: Facts) -> set[str]:
    """The entries whose every change the data contradict."""
    config, found = facts.configuration, {"rounds", "comparisons", "embedding", "confidence", "lam"}
    found |= {"rollouts", "weight_bound"}
    _, n_states, n_actions, _ = facts.table.places.shape
    conditional = {
        "n_demonstrations": config["demonstrations"] is None,
        "transition_model": not facts.known,
        "slope": _answered_differences(facts),
        "delta": config["confidence"] != "fixed",
        "gamma": config["confidence"] == "fixed",
        "bonus_multiplier": config["confidence"] == "fixed" and not facts.known and n_states * n_actions > 1,
    }
    return found | {name for name, holds in conditional.items() if holds}


def _answered_differences(facts: Facts) -> bool:
    """Whether an answer is about trajectories of different features, on which the weights depend."""
    shape = facts.states.shape
    features = facts.table.of_trajectories(facts.states.reshape(-1, shape[-1]), facts.actions.reshape(-1, shape[-1]))
    one, two = features.reshape(*shape[:-1], -1).swapaxes(0, 1)
    return bool((~np.isnan(facts.outcomes)[..., None] & (one != two)).any())
