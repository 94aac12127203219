"""Running a predicate on instances that Hypothesis chooses, deterministically, with the smallest failure reported."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import TypeVar

from hypothesis import HealthCheck, Phase, find, settings
from hypothesis.errors import NoSuchExample, Unsatisfiable
from hypothesis.strategies import SearchStrategy

from proofs_checks.context import Context
from proofs_checks.outcome import Outcome

T = TypeVar("T")

_FEWEST = 10

QUICK = Context(quick=True)
"""The default context of a check that is called by hand."""


def on_every(name: str, instances: SearchStrategy[T], holds: Callable[[T], bool], examples: int = 60) -> Outcome:
    """Whether a predicate holds on every generated instance; a failure is shrunk by Hypothesis and shown.

    The same call gives the same verdict on every run: the choice sequence comes from a fixed seed and no database.

    >>> from hypothesis import strategies as st
    >>> on_every("squares", st.integers(0, 9), lambda k: k * k >= k, 30).holds
    True
    >>> on_every("squares", st.integers(0, 9), lambda k: k * k <= 2 * k, 200).failures
    ('squares: fails for 3',)
    """
    seen = 0

    def fails(instance: T) -> bool:
        nonlocal seen
        seen += 1
        return not holds(instance)

    try:
        smallest = find(instances, fails, settings=_settings(examples), random=Random(20250926))
    except (NoSuchExample, Unsatisfiable):
        if seen < min(examples, _FEWEST):
            return Outcome(seen, (f"{name}: only {seen} instances were generated, which is no evidence",))
        return Outcome(seen, details=f"{name}: holds on {seen} instances chosen by Hypothesis")
    return Outcome(seen, (f"{name}: fails for {smallest}",))


def _settings(examples: int) -> settings:
    return settings(
        max_examples=examples,
        database=None,
        deadline=None,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
    )
