"""Evidence that several claims of this half share."""

from __future__ import annotations

from proofs_checks.evidence import Evidence, exact, mutant
from proofs_checks.offline.checks import transcription


def text(*names: str) -> Evidence:
    """That bridge_theory evaluates the paper's text: a second transcription agrees."""
    words = "the formula of bridge_theory agrees with a second transcription of the text"
    return exact(words, transcription.formulas, mutant("a thousandth more", factor=1.001), names=names)
