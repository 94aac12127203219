"""Theorems of the development as evidence of the ledger."""

from __future__ import annotations

from proofs_checks.evidence import Evidence, kernel_checked, mutant
from proofs_checks.kernel import recorded
from proofs_checks.kernel.manifest import shipped


def theorem(name: str) -> Evidence:
    """An exported theorem, in the words of ``theorems.json``; ``KeyError`` if it is not exported."""
    words = shipped().theorems[name].words
    return kernel_checked(
        words, recorded.theorem, mutant("its proof left open", replace=("Qed", "Admitted")), name=name
    )
