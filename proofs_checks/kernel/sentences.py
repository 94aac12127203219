"""What a source of Coq may say: a whitelist of commands, so that nothing is proved by a trick.

Coq lists the axioms that a theorem rests on, but a source may also switch the kernel's checks off, load a plugin,
give an old notation a new meaning, or shadow a name of the standard library. A command that is not listed is refused.
"""

from __future__ import annotations

import re

COMMANDS = {
    "Require", "From", "Import", "Open", "Close", "Section", "End", "Context", "Variable", "Variables", "Hypothesis",
    "Hypotheses", "Let", "Definition", "Fixpoint", "Inductive", "Record", "Lemma", "Theorem", "Corollary",
    "Proposition", "Remark", "Fact", "Example", "Goal", "Proof", "Qed", "Defined", "Arguments", "Implicit", "Notation",
    "Ltac", "Local", "Global", "Scheme", "Hint",
}  # fmt: skip
"""The commands that a source may use, at the beginning of a sentence."""

_IN_SECTIONS = {"Context", "Variable", "Variables", "Hypothesis", "Hypotheses", "Let"}
"""Assumptions in a section become premises of its theorems; outside of one they are axioms."""
_TACTICS = re.compile(r"\b(admit|give_up|native_compute|native_cast_no_check|vm_cast_no_check|exact_no_check)\b")
_LIBRARIES = re.compile(r"(From (Coq|Bridge|Interval) )?Require (Import|Export) ")
_FOREIGN = re.compile(r"\b(Uint63|PrimInt63|PrimFloat|PrimArray|Int63|Floats|Classical\w*|.*Axioms?|Hurkens)\b")
_STANDARD = {
    "R", "Rle", "Rlt", "Rge", "Rgt", "Rplus", "Rmult", "Rminus", "Ropp", "Rinv", "Rdiv", "Rmin", "Rmax", "Rabs",
    "Rpower", "pow", "INR", "IZR", "exp", "ln", "sqrt", "sin", "cos", "cosh", "asin", "acos", "PI", "C", "fact", "le",
    "lt", "ge", "gt", "eq", "not", "and", "or", "ex", "all", "iff", "True", "False", "nat", "bool", "list", "In",
    "length", "map", "fold_right", "combine", "flat_map", "seq", "nth", "Nat", "Z", "Q", "negb", "andb", "orb",
}  # fmt: skip
"""Names that statements use in their standard meaning; a source may not give them another one."""
_DEFINED = re.compile(
    r"(?:(?:Local|Global)\s+)?(?:Definition|Fixpoint|Inductive|Record|Lemma|Theorem|Notation|Let)\s+([\w']+)"
)


def faults(source: str) -> list[str]:
    """What a source says that it may not, one short sentence each; empty for a clean one.

    >>> faults("Lemma easy : True. Proof. exact I. Qed. (* no Axiom *)")
    []
    >>> faults("Axiom easy : False."), faults("Hypothesis easy : False.")
    (['the command Axiom'], ['Hypothesis outside of a section'])
    """
    found, depth = [], 0
    for sentence in sentences(source):
        words = sentence.split()
        if sentence.startswith("#["):
            found.append(f"the attribute {sentence.partition(']')[0]}]")
        command = words[0]
        if command in ("Local", "Global") and len(words) > 1:
            command = words[1]
        if command[0].isupper() and command not in COMMANDS:
            found.append(f"the command {command}")
        if command in _IN_SECTIONS and depth == 0:
            found.append(f"{command} outside of a section")
        if tactic := _TACTICS.search(sentence):
            found.append(f"the tactic {tactic.group()}")
        if command in ("Require", "From"):
            foreign = _FOREIGN.search(sentence)
            if foreign or not _LIBRARIES.match(sentence):
                found.append(f"the library of {sentence!r}")
        if command == "Notation" and sentence.partition("Notation")[2].strip().startswith('"'):
            found.append("a notation with symbols")
        if (defined := _DEFINED.match(sentence)) and defined[1] in _STANDARD:
            found.append(f"another meaning for {defined[1]}")
        depth += (command == "Section") - (command == "End")
    return found


def sentences(source: str) -> list[str]:
    """The sentences of a source without comments, bullets and braces; each string is left as its quotation marks.

    >>> sentences('Lemma a : x = 1. (* b. (* c. *) "*)" *) Proof. - { lra. } Qed.')
    ['Lemma a : x = 1', 'Proof', 'lra', 'Qed']
    """
    parts = (re.sub(r"^([-+*{}\s]|\d+\s*:\s*\{)+", "", part) for part in re.split(r"\.+(?=\s|$)", _code(source)))
    return [" ".join(part.split()) for part in parts if part.strip()]


def _code(source: str) -> str:
    """The source without comments, which nest, and without what strings say; both may contain the other's marks."""
    kept, depth, at = [], 0, 0
    while at < len(source):
        if source[at] == '"':
            at = source.find('"', at + 1) % (len(source) + 1) + 1
            kept.append('""' if depth == 0 else "")
        elif source.startswith("(*", at):
            depth, at = depth + 1, at + 2
        elif depth and source.startswith("*)", at):
            depth, at = depth - 1, at + 2
            kept.append(" ")
        else:
            kept.append(source[at] if depth == 0 else "")
            at += 1
    return "".join(kept)
