"""What the exported theorems rest on, read from the names in their sources: other theorems, and formulas."""

from __future__ import annotations

import re
from collections.abc import Collection
from functools import cache

from bridge_theory.catalog import FORMULAS
from proofs_checks.kernel.manifest import Development
from proofs_checks.kernel.sentences import sentences

_STATED = re.compile(r"(?:Theorem|Lemma|Definition|Fixpoint|Record|Inductive|Let|Example|Notation)\s+([\w']+)")
Place = tuple[str, str]
"""A source and a name that it defines."""


def uses(what: Development) -> dict[str, frozenset[str]]:
    """For each exported theorem the exported theorems that it rests on, directly or through lemmas alone.

    >>> from proofs_checks.kernel.manifest import Theorem
    >>> source = "Lemma a : True. exact I. Qed. Lemma b : True. exact a. Qed. Theorem c : True. exact b. Qed."
    >>> exported = {name: Theorem(name, "F", "l", "w", "n") for name in "ac"}
    >>> uses(Development({"F": source}, exported, ()))
    {'a': frozenset(), 'c': frozenset({'a'})}
    """
    ends = [(one.file, one.name) for one in what.theorems.values()]
    found = {one.name: _reached((one.file, one.name), what, ends) for one in what.theorems.values()}
    return {name: frozenset(other for _, other in places) for name, places in found.items()}


def formulas(what: Development, name: str) -> tuple[str, ...]:
    """The formulas of ``bridge_theory`` whose definitions a theorem names, also through definitions and lemmas."""
    ends = [("Formulas", formula) for formula in FORMULAS]
    return tuple(sorted(formula for _, formula in _reached((what.theorems[name].file, name), what, ends)))


def layers(what: Development) -> list[list[str]]:
    """The theorems in layers: each rests on theorems of earlier layers alone."""
    depth: dict[str, int] = {}
    below = uses(what)

    def height(name: str) -> int:
        if name not in depth:
            depth[name] = 1 + max((height(other) for other in below[name]), default=-1)
        return depth[name]

    tallest = max(map(height, what.theorems), default=-1)
    return [[name for name in what.theorems if depth[name] == layer] for layer in range(tallest + 1)]


def _reached(start: Place, what: Development, ends: Collection[Place]) -> set[Place]:
    """Those of ``ends`` that are met first on every way from a place through what it names."""
    named = _named(tuple(what.sources.items()))
    found: set[Place] = set()
    seen, waiting = {start}, [start]
    while waiting:
        for place in named.get(waiting.pop(), frozenset()) - seen:
            seen.add(place)
            if place in ends:
                found.add(place)
            else:
                waiting.append(place)
    return found


@cache
def _named(sources: tuple[tuple[str, str], ...]) -> dict[Place, frozenset[Place]]:
    """For everything that is defined, what its statement and proof name, in its own source or one that it requires."""
    words: dict[Place, set[str]] = {}
    required: dict[str, set[str]] = {}
    for file, source in sources:
        current = (file, "")
        for sentence in sentences(source):
            if sentence.startswith(("Require", "From Bridge")):
                required.setdefault(file, set()).update(re.findall(r"[\w']+", sentence))
            if stated := _STATED.match(sentence):
                current = (file, stated[1])
            words.setdefault(current, set()).update(re.findall(r"[\w']+", sentence))
    files = {file: [file, *(other for other, _ in sources if other in required.get(file, ()))] for file, _ in sources}
    return {
        (file, name): frozenset(
            next((place for other in files[file] if (place := (other, word)) in words), (file, name)) for word in said
        )
        - {(file, name)}
        for (file, name), said in words.items()
        if name
    }
