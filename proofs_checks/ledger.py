"""All claims in the order of the paper, and everything that can be asked of them without running a check."""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
import re
from collections.abc import Iterator
from functools import cache

from bridge_theory import paper
from bridge_theory.errors import InputError
from proofs_checks.claim import COMPANION, Claim, Repair
from proofs_checks.evidence import Evidence

ENGINES = ("z3", "hypothesis", "latex2mathml")
"""Packages of the extra ``checks``, without which the claims cannot be loaded."""
_ROOMS = ("proofs_checks.offline", "proofs_checks.online", "proofs_checks.answers", "proofs_checks.apparatus")


def missing_engines() -> tuple[str, ...]:
    """The engines that are not installed; the extra ``checks`` has them."""
    return tuple(name for name in ENGINES if importlib.util.find_spec(name) is None)


@cache
def claims() -> tuple[Claim, ...]:
    """Every claim, in the order of the paper, then ours; parts of one statement in the order of their module."""
    found = [claim for module in _modules() for claim in getattr(importlib.import_module(module), "CLAIMS", ())]
    order = {name: position for position, name in enumerate(paper.entries())}
    return tuple(sorted(found, key=lambda claim: (order.get(claim.label, len(order)), *_own(claim), bool(claim.part))))


def _own(claim: Claim) -> tuple[int, str]:
    """The number and the letters of one of our statements: G2, G10 and G10' follow each other."""
    if not claim.label.startswith(COMPANION):
        return 0, ""
    return int("".join(re.findall(r"\d", claim.label))), claim.label


def repairs() -> tuple[Repair, ...]:
    """Every repaired statement once, in the order in which the claims first need it."""
    return tuple({repair.name: repair for claim in claims() for repair in claim.repairs}.values())


@cache
def evidence_by_key() -> dict[str, Evidence]:
    """Every piece of evidence that can be run, by its key; shared evidence appears once."""
    return {item.key: item for claim in claims() for item in all_evidence(claim) if item.check is not None}


def all_evidence(claim: Claim) -> Iterator[Evidence]:
    """The claim's own evidence, then that of its repaired forms, of what they rest on, and of their formulas."""
    yield from claim.evidence
    for repair in resting_on(claim):
        yield from repair.evidence
        yield from formula_evidence(repair)


def resting_on(statement: Claim | Repair) -> tuple[Repair, ...]:
    """The repaired forms that a claim names or that its links use, and those that these use in turn, each once."""
    named = statement.repairs if isinstance(statement, Claim) else ()
    direct = (*named, *(part for one in statement.links for part in one.by if isinstance(part, Repair)))
    found = {repair.name: repair for part in direct for repair in (part, *resting_on(part))}
    return tuple(found.values())


def formula_evidence(repair: Repair) -> tuple[Evidence, ...]:
    """That ``bridge_theory`` computes what the repaired statement prints, by a second transcription.

    It says nothing for the statement, so that it is no part of ``repair.evidence``.
    """
    from proofs_checks.offline.checks.transcription import TEXT
    from proofs_checks.offline.evidence import text as offline_text
    from proofs_checks.online.evidence import text as online_text

    if not repair.formulas:
        return ()
    return ((offline_text if repair.formulas[0] in TEXT else online_text)(*repair.formulas),)


def matching(text: str) -> tuple[Claim, ...]:
    """The claims whose label, part or name of a repaired form contains ``text`` (all of them for an empty text).

    Errors: ``InputError`` if there is none.
    """
    exact = tuple(claim for claim in claims() if text in (claim.key, claim.label, *(r.name for r in claim.repairs)))
    wanted = text.lower()
    found = exact or tuple(claim for claim in claims() if wanted in claim.key.lower())
    if not found:
        raise InputError(f"no claim's label contains {text!r}; 'bridge-rl check --list' shows all labels")
    return found


def _modules() -> Iterator[str]:
    for room in _ROOMS:
        package = importlib.import_module(room)
        for module in pkgutil.iter_modules(package.__path__):
            if not module.ispkg:
                yield f"{room}.{module.name}"
