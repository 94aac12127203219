"""A claim: one statement of the paper, what became of it, and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from bridge_theory import paper
from proofs_checks.evidence import Evidence, Kind
from proofs_checks.search import Search

Verdict = Literal["true", "true, proof wrong", "false", "undefined", "definition", "cited", "open", "empirical"]
Topic = Literal["setting", "offline", "hellinger", "online", "regret", "experiments"]

MEANING: dict[Verdict, str] = {
    "true": "holds as printed, under the assumptions listed",
    "true, proof wrong": "holds as printed, but the paper's proof does not show it",
    "false": "does not hold as printed; a counterexample is stored",
    "undefined": "has no value, or no meaning, somewhere on its own domain",
    "definition": "introduces a notion; there is nothing to prove",
    "cited": "taken from the literature; compared, not checked",
    "open": "neither proved nor refuted here",
    "empirical": "the outcome of an experiment; reproduced elsewhere, not a mathematical statement",
}

SETTLED_BY: dict[Verdict, tuple[Kind, ...]] = {
    "true": ("kernel-checked", "proved", "exact on instances", "covered", "step proved"),
    "true, proof wrong": ("kernel-checked", "proved", "exact on instances", "covered", "step proved"),
    "false": ("refuted",),
    "undefined": ("kernel-checked", "proved", "refuted", "exact on instances", "step proved"),
    "cited": ("cited",),
    "open": ("open",),
}
"""The kinds of evidence of which a verdict needs at least one."""


@dataclass(frozen=True)
class Repair:
    """A statement that does hold where the paper's does not, or says more than it; shared by all claims it serves.

    Attributes:
        name: short and unique: ``T9``, ``R4``.
        title: in a few words.
        statement: prose with LaTeX between dollars, ``$$`` for displays.
        evidence: what shows it.
        assumptions: what it needs, one sentence each.
        proof: readable text with LaTeX; paragraphs are separated by blank lines.
        formulas: names of the formulas of ``bridge_theory`` that compute it.
    """

    name: str
    title: str
    statement: str
    evidence: tuple[Evidence, ...]
    assumptions: tuple[str, ...] = ()
    proof: str = ""
    formulas: tuple[str, ...] = ()


@dataclass(frozen=True)
class Claim:
    """One statement of the paper.

    Attributes:
        label: its name in the map ``bridge_theory.paper``.
        name: what it is called in the table, in a few words.
        topic: part of the paper.
        verdict: whether it holds as printed, see ``MEANING``.
        statement: the statement in our symbols: prose with LaTeX between dollars, ``$$`` for displays.
        because: one or two sentences: the reason for the verdict.
        evidence: what shows the verdict.
        repairs: statements that hold instead.
        assumptions: what the statement needs, also what the paper leaves unsaid, one sentence each.
        proof: proof of the statement itself where it is true, or what is wrong with the paper's.
        part: for one of several claims about the same label, e.g. ``step-2``.
        search: how to attack it, for ``bridge-rl check --search``.
    """

    label: str
    name: str
    topic: Topic
    verdict: Verdict
    statement: str
    because: str
    evidence: tuple[Evidence, ...] = ()
    repairs: tuple[Repair, ...] = ()
    assumptions: tuple[str, ...] = ()
    proof: str = ""
    part: str = ""
    search: Search | None = None

    def __post_init__(self) -> None:
        paper.entry(self.label)
        needed = SETTLED_BY.get(self.verdict, ())
        if needed and not any(item.kind in needed for item in self.evidence):
            raise TypeError(f"{self.key} is called {self.verdict!r} without evidence; it needs {' or '.join(needed)}")
        if not self.because:
            raise TypeError(f"{self.key} gives no reason for its verdict")

    @property
    def key(self) -> str:
        """``label``, or ``label/part``."""
        return f"{self.label}/{self.part}" if self.part else self.label
