"""Every statement of the paper has a claim, every claim a statement; nothing in the ledger dangles."""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

import pytest

import bridge_theory
import proofs_checks
from bridge_theory import paper
from proofs_checks.claim import COMPANION
from proofs_checks.counterexample import evaluator, load
from proofs_checks.evidence import Evidence
from proofs_checks.ledger import all_evidence, claims, matching, repairs

ROOM = Path(proofs_checks.__file__).parent
STORED = sorted(path.stem for path in (ROOM / "counterexamples").glob("*.json"))
EVERY_EVIDENCE = [item for claim in claims() for item in all_evidence(claim)]


def test_the_map_and_the_ledger_cover_each_other() -> None:
    assert {claim.label for claim in claims() if not claim.label.startswith(COMPANION)} == set(paper.entries())


def test_every_statement_about_answers_has_a_claim() -> None:
    ours = [claim.label.removeprefix(COMPANION) for claim in claims() if claim.label.startswith(COMPANION)]
    assert list(dict.fromkeys(ours)) == [
        "G1",
        "G1'",
        "G2",
        "G3",
        "G3'",
        "G4",
        "G5",
        "G6",
        "G7",
        "G7'",
        "G8",
        "G9",
        "G10",
    ]


def test_claims_come_in_the_order_of_the_paper() -> None:
    order = list(paper.entries())
    positions = [order.index(claim.label) if claim.label in order else len(order) for claim in claims()]
    assert positions == sorted(positions)


def test_no_two_claims_share_a_key_and_no_two_repairs_a_name() -> None:
    assert [key for key, count in Counter(claim.key for claim in claims()).items() if count > 1] == []
    different = {id(repair): repair.name for claim in claims() for repair in claim.repairs}
    assert [name for name, count in Counter(different.values()).items() if count > 1] == []


def test_one_key_means_one_check() -> None:
    meaning: dict[str, Evidence] = {}
    for item in EVERY_EVIDENCE:
        if item.check is not None:
            known = meaning.setdefault(item.key, item)
            assert (known.check, known.arguments, known.mutants) == (item.check, item.arguments, item.mutants), item.key


def test_repairs_have_evidence_and_name_formulas_that_exist() -> None:
    assert [repair.name for repair in repairs() if not repair.evidence] == []
    assert [f for repair in repairs() for f in repair.formulas if not hasattr(bridge_theory, f)] == []


def test_every_stored_counterexample_is_evidence_of_the_claim_that_it_names() -> None:
    named = {(claim.key, e.counterexample.name) for claim in claims() for e in claim.evidence if e.counterexample}
    stored = {name: load(name) for name in STORED}
    keys = {name: f"{item.label}/{item.part}" if item.part else item.label for name, item in stored.items()}
    assert [name for name in STORED if (keys[name], name) not in named] == []


@pytest.mark.parametrize("name", STORED)
def test_every_counterexample_has_an_evaluator(name: str) -> None:
    assert callable(evaluator(load(name).kind))


def imported(path: Path) -> set[str]:
    nodes = list(ast.walk(ast.parse(path.read_text())))
    names = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    return names | {node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module}


def test_evaluators_are_independent_of_what_they_judge() -> None:
    modules = {".".join(path.relative_to(ROOM.parent).with_suffix("").parts): path for path in ROOM.rglob("*.py")}
    reached = {name for name in modules if name.startswith("proofs_checks.evaluators.")}
    while new := {name for module in reached for name in imported(modules[module]) & set(modules)} - reached:
        reached |= new
    judged = {name for module in reached for name in imported(modules[module]) if name.startswith("bridge_")}
    assert {n for n in judged if not n.startswith(("bridge_theory.errors", "bridge_theory.arithmetic"))} == set()
    assert not any(name.startswith(("proofs_checks.offline", "proofs_checks.online")) for name in reached)


def test_a_claim_is_found_by_label_part_or_repaired_form() -> None:
    for claim in claims():
        assert claim in matching(claim.key)
        assert claim in matching(claim.label)
    for repair in repairs():
        assert all(repair in claim.repairs for claim in matching(repair.name))
