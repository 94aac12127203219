"""Evidence that several claims of this half share."""

from __future__ import annotations

from proofs_checks.claim import Link, link
from proofs_checks.evidence import Evidence, agrees, mutant, proved_step
from proofs_checks.online.checks import directions as checks
from proofs_checks.online.checks import orders, transcription


def text(*names: str) -> Evidence:
    """That bridge_theory evaluates the printed formulas: a second transcription agrees."""
    words = "the formulas of bridge_theory agree with a second transcription of the text"
    return agrees(words, transcription.formulas, mutant("a thousandth more", factor=1.001), names=names)


def unbounded(family: str, words: str) -> Evidence:
    """That no hidden constant helps: the ratio of both sides tends to infinity along a family of instances."""
    return proved_step(
        f"the ratio of both sides tends to infinity {words}",
        orders.unbounded,
        mutant("divided by the variable of the family", divided=1),
        family=family,
    )


def refuted_order(counterexample: str) -> tuple[Link, ...]:
    """What refutes a statement of order: an instance, and a family on which no hidden constant helps."""
    return (
        link("an instance exceeds the bound with a generous constant", counterexample),
        link("along a family the ratio of both sides is unbounded, so that no constant serves", "unbounded"),
    )


def directions(group: str) -> Evidence:
    """That the formulas of a group move as declared, which ``solve_for`` relies on."""
    words = (
        f"every {group} formula moves in its declared directions: the derivative's sign over whole intervals of "
        "one parameter, the others at a reference setting"
    )
    return proved_step(words, checks.directions, mutant("the opposite directions", flipped=True), group=group)
