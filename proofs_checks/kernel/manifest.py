"""What the development exports: its theorems with their instances, and the wrong variants that are refuted."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, fields
from functools import cache
from importlib import resources
from typing import Any

from bridge_theory.errors import InputError

_FOLDER = resources.files("proofs_checks.kernel")


@dataclass(frozen=True)
class Theorem:
    """One exported theorem.

    Attributes:
        name: its name in Coq.
        file: the source that contains it, without ``.v``.
        label: the paper's or the audit's name of the statement.
        words: the statement in a sentence.
        nonvacuity: the compiled instance: the theorem applied to concrete data that meet all its premises.
    """

    name: str
    file: str
    label: str
    words: str
    nonvacuity: str


@dataclass(frozen=True)
class Mutant:
    """A wrong variant of a theorem, one constant or sign changed, with a proof in Coq that it is false.

    Attributes:
        theorem: the name of the theorem whose statement is changed.
        old, new: the text that changes in the statement; ``old`` occurs there.
        refutation: tactics that prove the negation of the changed statement, from its hypothesis ``claim``.
    """

    theorem: str
    old: str
    new: str
    refutation: str


@dataclass(frozen=True)
class Development:
    """Everything that the gate judges: sources by name without ``.v``, exported theorems by name, wrong variants."""

    sources: dict[str, str]
    theorems: dict[str, Theorem]
    mutants: tuple[Mutant, ...]


@cache
def shipped() -> Development:
    """The development of this package; ``InputError`` if an entry of its lists is incomplete or about nothing."""
    files = sorted((file for file in _FOLDER.iterdir() if file.name.endswith(".v")), key=lambda file: file.name)
    texts = {file.name.removesuffix(".v"): file.read_text(encoding="utf-8") for file in files}
    theorems = {one.name: one for one in _entries("theorems.json", Theorem)}
    mutants = tuple(_entries("mutants.json", Mutant))
    if unknown := {one.file for one in theorems.values()} - set(texts):
        raise InputError(f"theorems.json must name sources of the development, got {', '.join(sorted(unknown))}")
    if unknown := {one.theorem for one in mutants} - set(theorems):
        raise InputError(f"mutants.json must change exported theorems, got {', '.join(sorted(unknown))}")
    return Development(texts, theorems, mutants)


def digest(texts: dict[str, str]) -> str:
    """The SHA-256 digest of sources with their names, whatever their order.

    >>> digest({"a": "1", "b": "2"}) == digest({"b": "2", "a": "1"}), digest({"a": "1b2"}) == digest({"a": "1"})
    (True, False)
    """
    return hashlib.sha256(json.dumps(sorted(texts.items())).encode()).hexdigest()


def _entries(file: str, kind: type) -> list[Any]:
    wanted = {field.name for field in fields(kind)}
    found = json.loads(_FOLDER.joinpath(file).read_text(encoding="utf-8"))
    for entry in found:
        if set(entry) != wanted or not all(isinstance(text, str) and text for text in entry.values()):
            raise InputError(f"an entry of {file} must have the texts {', '.join(sorted(wanted))}, got {entry}")
    return [kind(**entry) for entry in found]
