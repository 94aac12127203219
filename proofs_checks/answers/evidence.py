"""Evidence that several statements about answers share."""

from __future__ import annotations

from proofs_checks.answers.checks import directions as checks
from proofs_checks.answers.checks import transcription
from proofs_checks.evidence import Evidence, agrees, mutant, proved_step


def text(*names: str) -> Evidence:
    """That bridge_theory evaluates the printed formulas: a second transcription agrees."""
    words = "the formulas of bridge_theory agree with a second transcription of the text"
    return agrees(words, transcription.formulas, mutant("a thousandth more", factor=1.001), names=names)


def directions() -> Evidence:
    """That the formulas move as declared, which ``solve_for`` relies on."""
    words = (
        "every formula moves in its declared directions: the derivative's sign over whole intervals of one parameter, "
        "the others at a reference setting"
    )
    return proved_step(words, checks.directions, mutant("the opposite directions", flipped=True))
