"""Counterexamples of the ledger as refutations for Coq's kernel, generated from the JSON that the evaluators replay."""

from __future__ import annotations


def generated(*, numerical: bool) -> dict[str, str]:
    """The sources of the refutations by file name without ``.v``; numerical ones need the tactic ``interval``."""
    return {}


def example_of(file: str) -> str:
    """The name of the counterexample that a generated source refutes by."""
    return file
