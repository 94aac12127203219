"""Mutants that nothing can notice, because they mean the same, with the reason for each."""

from __future__ import annotations

from proofs_checks.mutation.sites import Site

EXPLAINED: dict[tuple[str, str, str], str] = {
    ("bridge_theory.offline.transition_error", "_best_denominator", ""): (
        "where the search for an integer starts; the answer is certified against both neighbours, from any start"
    ),
    ("bridge_theory.online.bonus", "xi_repaired", "1 -> 2"): "at N = 2 both branches are 2 eta, because xi is capped",
    ("bridge_theory.regret.unknown_repaired", "_count_log_term", "1 -> 2"): (
        "only reached at H = 1, where the sums that it multiplies are empty"
    ),
}
"""(module, function, change, or "" for any) -> why the mutant is no change, or why the change cannot matter."""


def explanation(site: Site) -> str:
    """Why this survivor is no defect of the checks; empty if nobody has said."""
    function = site.functions[0][1] if site.functions else ""
    specific = EXPLAINED.get((site.module, function, site.change), "")
    return specific or EXPLAINED.get((site.module, function, ""), "")
