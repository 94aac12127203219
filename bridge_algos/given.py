"""Rules for what a caller gives: an argument of one name means the same in every function, and its rule stands here.

A function with :func:`checked`, or a data class that calls :func:`check_fields`, refuses an argument that breaks the
rule of its name, in a sentence. Relations between arguments stay with the functions.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import reprlib
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import numpy as np

from bridge_theory.errors import InputError

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")
Rule = Callable[[str, Any], None]


def whole(least: int) -> Rule:
    """A whole number of at least ``least``; true and 2.0 are none."""

    def rule(name: str, value: Any) -> None:
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
            raise InputError(
                f"{name} must be a whole number of at least {least}, got {reprlib.repr(value)}; give an int."
            )

    return rule


def number(valid: Callable[[float], bool], expected: str) -> Rule:
    """A real number for which ``valid`` holds, which NaN should fail."""

    def rule(name: str, value: Any) -> None:
        real = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
        if not real or not valid(value):
            raise InputError(f"{name} must be {expected}, got {reprlib.repr(value)}.")

    return rule


def array(kinds: str, axes: tuple[int, ...], low: float = -np.inf, high: float = np.inf) -> Rule:
    """A NumPy array of some kinds of numbers and some number of axes, finite and between low and high."""
    what = "whole numbers" if kinds == "iu" else "numbers"
    span = f" of at least {low:g}" if np.isinf(high) and np.isfinite(low) else ""
    span = f" in [{low:g}, {high:g}]" if np.isfinite(high) else span

    def rule(name: str, value: Any) -> None:
        if not isinstance(value, np.ndarray) or value.dtype.kind not in kinds or value.ndim not in axes:
            given = f"{value.dtype} of shape {value.shape}" if isinstance(value, np.ndarray) else reprlib.repr(value)
            many = " or ".join(map(str, axes))
            raise InputError(f"{name} must be an array of {what} with {many} axes, got {given}.")
        if value.size and not (np.isfinite(value).all() and value.min() >= low and value.max() <= high):
            wrong = value[~((value >= low) & (value <= high) & np.isfinite(value))].flat[0]
            raise InputError(f"{name} must hold finite {what}{span}, got {wrong}.")

    return rule


def generator(name: str, value: Any) -> None:
    """A source of randomness of the caller's."""
    if not isinstance(value, np.random.Generator):
        raise InputError(f"{name} must be a numpy Generator such as numpy.random.default_rng(0), got {value!r}.")


def counts(name: str, value: Any) -> None:
    """Counts (S, A) or (S, A, S), or the tables by step that have both."""
    if not hasattr(value, "pooled"):
        array("iu", (2, 3), low=0)(name, value)


def truth(name: str, value: Any) -> None:
    """True or false."""
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{name} must be True or False, got {reprlib.repr(value)}.")


def choice(*words: str) -> Rule:
    """One of some words."""

    def rule(name: str, value: Any) -> None:
        if not isinstance(value, str) or value not in words:
            raise InputError(f"{name} must be one of {', '.join(words)}, got {reprlib.repr(value)}.")

    return rule


POSITIVE = number(lambda x: 0 < x < np.inf, "a positive number")
NOT_NEGATIVE = number(lambda x: 0 <= x < np.inf, "a number of at least 0")
INSIDE = number(lambda x: 0 < x < 1, "a number strictly between 0 and 1")
SHARE = number(lambda x: 0 <= x <= 1, "a probability")

RULES: dict[str, Rule] = {
    **dict.fromkeys(("n_states", "n_actions", "horizon", "n", "size", "dimension", "rounds", "comparisons"), whole(1)),
    "chains": whole(1),
    "rollouts": whole(2),
    "steps": whole(0),
    **dict.fromkeys(("rng", "candidates_rng"), generator),
    **dict.fromkeys(("embedding_bound", "weight_bound", "slope", "bound", "rate"), POSITIVE),
    **dict.fromkeys(("gamma", "bonus_multiplier", "lam"), NOT_NEGATIVE),
    **dict.fromkeys(("delta", "delta_w", "delta_p", "level"), INSIDE),
    "discount": number(lambda x: 0 <= x < 1, "a number of at least 0 and below 1"),
    "seed": whole(0),
    "seeds": whole(1),
    **dict.fromkeys(("probability", "squared_radius", "slip"), SHARE),
    "radius": number(lambda x: x >= 0, "a number of at least 0 (1 keeps every policy)"),
    "tie_break": choice("random", "first"),
    "empty_row": choice("self_loop", "uniform"),
    **dict.fromkeys(("center", "clone"), array("iu", (1,), low=0)),
    "policies": array("iu", (2,), low=0),
    "disagree": array("fb", (2,), low=0, high=1),
    "counts": counts,
    "known": truth,
    "transitions": array("iuf", (3, 4), low=0),
    "initial": array("iuf", (1,), low=0),
    "x": array("iuf", (2,)),
    "outcomes": array("iuf", (1,), low=0, high=1),
    **dict.fromkeys(("start", "w", "v", "w_star"), array("iuf", (1,))),
    "matrix": array("iuf", (2,)),
    "weights": array("iuf", (4,)),
}
"""By name: sizes, randomness, scales, probabilities, policies, comparisons."""


def checked(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """The function, after making sure that its arguments keep the rules of their names; None passes where it may."""
    signature = inspect.signature(function)
    rules = [(name, RULES[name]) for name in signature.parameters if name in RULES]
    optional = {name for name in signature.parameters if "None" in str(signature.parameters[name].annotation)}

    @functools.wraps(function)
    def guarded(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        given = signature.bind(*args, **kwargs).arguments
        for name, rule in rules:
            if name in given and not (given[name] is None and name in optional):
                rule(name, given[name])
        return function(*args, **kwargs)

    return guarded


def check_fields(instance: Any, *left_out: str) -> None:
    """The same for the fields of a data class but ``left_out``, to be called after its construction."""
    for field in dataclasses.fields(instance):
        value = getattr(instance, field.name)
        rule = None if field.name in left_out else RULES.get(field.name)
        if rule is not None and not (value is None and "None" in str(field.type)):
            rule(field.name, value)


def check_policy(name: str, policy: Any, n_states: int, n_actions: int) -> None:
    """Refuse what is no deterministic stationary policy (S,) of this size."""
    array("iu", (1,), low=0, high=n_actions - 1)(name, policy)
    if len(policy) != n_states:
        raise InputError(f"{name} must have {n_states} entries, one action a state, got {len(policy)}.")
