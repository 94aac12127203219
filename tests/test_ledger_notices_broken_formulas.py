"""A formula of a repaired statement cannot be broken without the checks of that statement noticing."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import Any

import pytest

import bridge_theory
from proofs_checks.claim import Repair
from proofs_checks.context import Context
from proofs_checks.ledger import all_evidence, formula_evidence, matching, repairs

FORMULAS = [(repair, name) for repair in repairs() for name in repair.formulas]


@pytest.mark.parametrize(("repair", "name"), FORMULAS, ids=lambda part: getattr(part, "name", part))
def test_a_broken_formula_fails_a_check_of_its_repaired_statement(
    repair: Repair, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (item,) = formula_evidence(repair)
    assert item.key in {piece.key for claim in matching(repair.name) for piece in all_evidence(claim)}
    context = Context(True, 0, item.key)
    assert item.run(context).holds
    formula = getattr(bridge_theory, name)

    @functools.wraps(formula.function)
    def broken(m: Any, **values: Any) -> Any:
        return formula(m, **values) * 1.001 + 0.001

    monkeypatch.setattr(bridge_theory, name, replace(formula, function=broken))
    assert name in item.run(context).failures[0]
