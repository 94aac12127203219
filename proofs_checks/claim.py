"""A claim: one statement of the paper, what became of it, and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from bridge_theory import paper
from proofs_checks.evidence import Evidence, Kind
from proofs_checks.search import Search

Verdict = Literal["true", "true, proof wrong", "false", "undefined", "definition", "cited", "open", "empirical"]
Topic = Literal["setting", "offline", "hellinger", "online", "regret", "answers", "experiments"]

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

_SHOWN: tuple[Kind, ...] = (
    "kernel-checked", "proved", "step proved", "exact on instances", "agrees on instances", "covered",
)  # fmt: skip
SETTLED_BY: dict[Verdict, tuple[Kind, ...]] = {
    "true": _SHOWN,
    "true, proof wrong": _SHOWN,
    "false": ("refuted",),
    "undefined": ("kernel-checked", "proved", "refuted", "exact on instances", "agrees on instances", "step proved"),
    "cited": ("cited",),
    "open": ("open",),
}
"""The kinds of evidence of which a verdict needs at least one."""


COMPANION = "companion "
"""Labels of statements that are not the paper's begin so; ``companion G2`` is about what is built here."""


@dataclass(frozen=True)
class Link:
    """One part of a statement that has to hold for the whole to hold; the whole is worth as much as its weakest link.

    Attributes:
        says: what has to hold, in one sentence.
        by: what shows it, any one suffices: pieces of evidence of the same claim by their `Evidence.handle`, or
            repaired statements. Nothing means that the text of the proof alone argues for it.
    """

    says: str
    by: tuple[str | Repair, ...] = ()


def link(says: str, *by: str | Repair) -> Link:
    """``link("the tail", "tail", T6)``; ``link("the union over subsets")`` is argued in the text alone."""
    return Link(says, by)


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
        links: what it consists of; may be left out where there is one piece of evidence and that is all.
    """

    name: str
    title: str
    statement: str
    evidence: tuple[Evidence, ...]
    assumptions: tuple[str, ...] = ()
    proof: str = ""
    formulas: tuple[str, ...] = ()
    links: tuple[Link, ...] = ()

    def __post_init__(self) -> None:
        if not self.links:
            object.__setattr__(self, "links", (_only_link(self.name, self.statement, self.evidence),))
        _check_links(self.name, self.links, self.evidence, self.proof)


@dataclass(frozen=True)
class Claim:
    """One statement of the paper.

    Attributes:
        label: its name in the map ``bridge_theory.paper``, or ``companion G1'`` for a statement of ours.
        name: what it is called in the table, in a few words.
        topic: part of the paper.
        verdict: whether it holds as printed, see ``MEANING``.
        statement: the statement in our symbols: prose with LaTeX between dollars, ``$$`` for displays.
        because: one or two sentences: the reason for the verdict.
        evidence: what shows the verdict.
        repairs: statements that hold instead.
        assumptions: what the statement needs, also what the paper leaves unsaid, one sentence each.
        proof: proof of the statement itself where it is true, or what is wrong with the paper's.
        links: what has to hold for the verdict; may be left out where one piece of evidence settles it alone.
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
    links: tuple[Link, ...] = ()
    part: str = ""
    search: Search | None = None

    def __post_init__(self) -> None:
        _ = self.kind  # refuses a label that the paper does not have
        needed = SETTLED_BY.get(self.verdict, ())
        if needed and not any(item.kind in needed for item in self.evidence):
            raise TypeError(f"{self.key} is called {self.verdict!r} without evidence; it needs {' or '.join(needed)}")
        if not self.because:
            raise TypeError(f"{self.key} gives no reason for its verdict")
        if needed and not self.links:
            settling = tuple(item for item in self.evidence if item.kind in needed)
            object.__setattr__(self, "links", (_only_link(self.key, self.because, settling),))
        _check_links(self.key, self.links, self.evidence, self.proof)

    @property
    def kind(self) -> str:
        """What the paper calls it: theorem, lemma, passage; ``statement`` where it is ours."""
        return "statement" if self.label.startswith(COMPANION) else paper.entry(self.label).kind

    @property
    def section(self) -> str:
        """Label of the section of the paper it stands in."""
        return "Certified answers" if self.label.startswith(COMPANION) else paper.entry(self.label).section

    @property
    def key(self) -> str:
        """``label``, or ``label/part``."""
        return f"{self.label}/{self.part}" if self.part else self.label


def _only_link(name: str, says: str, evidence: tuple[Evidence, ...]) -> Link:
    """The link of a statement that one kind of evidence settles alone."""
    kinds = {item.kind for item in evidence}
    alone = len(evidence) == 1 or kinds in ({"refuted"}, {"open"}, {"proved"})
    if not alone or "step proved" in kinds:
        raise TypeError(
            f"{name} has several pieces of evidence, or a step of a proof; say in its links which part each shows"
        )
    return Link(says, tuple(item.handle for item in evidence))


def _check_links(name: str, links: tuple[Link, ...], evidence: tuple[Evidence, ...], proof: str) -> None:
    known = {item.handle for item in evidence}
    for one in links:
        unknown = [handle for handle in one.by if isinstance(handle, str) and handle not in known]
        if unknown:
            raise TypeError(
                f"{name} links to {', '.join(unknown)}, which is none of its evidence: {', '.join(sorted(known))}"
            )
        if not one.by and not proof:
            raise TypeError(f"{name} leaves {one.says!r} to the text of its proof, and has none")
    steps = {item.handle for item in evidence if item.kind == "step proved"}
    if links and all(one.by and all(isinstance(part, str) and part in steps for part in one.by) for one in links):
        raise TypeError(f"the links of {name} are all steps of a proof; add the link that joins them")
