"""A formula of a repaired statement cannot be broken without the checks of that statement noticing."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import Any

import pytest

import bridge_theory
from proofs_checks.answers.checks import transcription as answers
from proofs_checks.claim import Repair
from proofs_checks.context import Context
from proofs_checks.ledger import all_evidence, claims, formula_evidence, matching, repairs

FORMULAS = [(repair, name) for repair in repairs() for name in repair.formulas]


@pytest.mark.parametrize(("repair", "name"), FORMULAS, ids=lambda part: getattr(part, "name", part))
def test_a_broken_formula_fails_a_check_of_its_repaired_statement(
    repair: Repair, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (item,) = formula_evidence(repair)
    assert item.key in {piece.key for claim in matching(repair.name) for piece in all_evidence(claim)}
    context = Context(True, 0, item.key)
    assert item.run(context).holds
    break_formula(name, monkeypatch)
    assert name in item.run(context).failures[0]


ANSWERS = {name: item for claim in claims() for item in claim.evidence if item.check is answers.formulas
           for name in item.arguments["names"]}  # fmt: skip


@pytest.mark.parametrize("name", sorted(answers.ANSWERS))
def test_a_broken_formula_about_answers_fails_a_check_of_its_statement(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    item = ANSWERS[name]
    context = Context(True, 0, item.key)
    assert item.run(context).holds
    break_formula(name, monkeypatch)
    assert name in item.run(context).failures[0]


def break_formula(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    formula = getattr(bridge_theory, name)

    @functools.wraps(formula.function)
    def broken(m: Any, **values: Any) -> Any:
        return formula(m, **values) * 1.001 + 0.001

    monkeypatch.setattr(bridge_theory, name, replace(formula, function=broken))
