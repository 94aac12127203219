"""Evidence that several claims of this half share."""

from __future__ import annotations

from proofs_checks.evidence import Evidence, agrees, kernel_checked, mutant
from proofs_checks.offline.checks import kernel, transcription


def text(*names: str) -> Evidence:
    """That bridge_theory evaluates the paper's text: a second transcription agrees."""
    words = "the formula of bridge_theory agrees with a second transcription of the text"
    return agrees(words, transcription.formulas, mutant("a thousandth more", factor=1.001), names=names)


def coq(words: str, file: str, name: str, wrong: str, old: str, new: str) -> Evidence:
    """A theorem in ``proofs_checks/coq``; the mutant replaces ``old`` by ``new`` in its source."""
    return kernel_checked(
        words, kernel.theorem, mutant(wrong, replace=(old, new)), full_only=True, file=file, name=name
    )
