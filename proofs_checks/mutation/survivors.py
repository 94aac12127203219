"""Mutants that nothing can notice, because they mean the same, with the reason for each."""

from __future__ import annotations

from proofs_checks.mutation.sites import Site

EXPLAINED: dict[tuple[str, str, str], str] = {}
"""(module, function, change) -> why the mutant is no change, or why the change cannot matter."""


def explanation(site: Site) -> str:
    """Why this survivor is no defect of the checks; empty if nobody has said."""
    function = site.functions[0][1] if site.functions else ""
    return EXPLAINED.get((site.module, function, site.change), "")
