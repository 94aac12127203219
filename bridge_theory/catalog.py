"""Every formula of the package, by name, by source label, by group."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

import bridge_theory
from bridge_theory.bound import Bound, Rate
from bridge_theory.errors import InputError
from bridge_theory.formula import Formula, Group

FORMULAS: dict[str, Formula] = {
    name: value for name in bridge_theory.__all__ if isinstance(value := getattr(bridge_theory, name), Formula)
}
"""All bounds and rates, by name."""


def all_bounds() -> tuple[Bound, ...]:
    """Every certified bound, in the order of the names.

    >>> "offline_radius" in {bound.name for bound in all_bounds()}
    True
    """
    return tuple(formula for formula in FORMULAS.values() if isinstance(formula, Bound))


def all_rates() -> tuple[Rate, ...]:
    """Every O-tilde statement: scaling only, no certified value.

    >>> "transition_error_rate" in {rate.name for rate in all_rates()}
    True
    """
    return tuple(formula for formula in FORMULAS.values() if isinstance(formula, Rate))


def by_group(group: Group) -> tuple[Bound, ...]:
    """The bounds of one group: ``offline``, ``online``, ``regret`` or ``answers``.

    >>> {bound.group for bound in by_group("offline")}
    {'offline'}
    """
    return tuple(bound for bound in all_bounds() if bound.group == group)


def by_label(label: str) -> tuple[Formula, ...]:
    """All formulas whose name is ``label`` or whose source contains it, e.g. ``thm:main_known`` or ``T9``.

    Errors: ``InputError`` naming the closest known labels.

    >>> [formula.name for formula in by_label("lem:offline_CI_under_known_dyn")]
    ['offline_radius_known']
    """
    if label in FORMULAS:
        return (FORMULAS[label],)
    found = tuple(formula for formula in FORMULAS.values() if label in _labels(formula.source))
    if found:
        return found
    close = difflib.get_close_matches(label, [*FORMULAS, *_sources(FORMULAS.values())], n=3)
    hint = f"; closest: {', '.join(close)}" if close else ""
    raise InputError(f"no formula is called {label!r} and none comes from a statement with that label{hint}")


def _labels(source: str) -> set[str]:
    words = {part.strip() for part in source.removeprefix("audit ").removeprefix("companion ").split(",")}
    return {source, *words, *(word.split("(")[0] for word in words)}


def _sources(formulas: Iterable[Formula]) -> set[str]:
    return {formula.source for formula in formulas}
