"""``bridge-rl check --search``: attack a statement within a time budget, and keep what breaks it."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from bridge_algos.files import atomic_write_text
from bridge_theory.errors import InputError
from proofs_checks.claim import Claim
from proofs_checks.counterexample import Number, evaluator, parse, show, violated
from proofs_checks.ledger import claims, matching
from proofs_checks.search import Attempt, Search


def attack(label: str, *, seconds: float, seed: int, directory: Path) -> int:
    """Search until the budget is spent or a violation is certified; print what was found.

    Returns 0: finding a counterexample to an open statement is news, not a failure. Errors: ``InputError`` where the
    claim has no search; the message lists those that have one.
    """
    claim, search = _searchable(label)
    print(f"{claim.key}: {search.words}")
    best, tried, found = _hunt(search, np.random.default_rng(seed), seconds)
    print(f"{tried} attempts in {seconds:g} s; nearest: {best.score:.9g} (1 is equality, more a violation)")
    if found is None:
        print("no violation was certified; the statement stands for now")
        return 0
    left, right = found
    path = directory / f"counterexample-{claim.label.replace(':', '-')}.json"
    atomic_write_text(path, json.dumps(_document(claim, search, best.data, left, right), indent=2, ensure_ascii=False))
    print(f"VIOLATED: {show(left)} {search.relation} {show(right)} fails, certified in exact arithmetic; see {path}")
    return 0


def _hunt(
    search: Search, rng: np.random.Generator, seconds: float
) -> tuple[Attempt, int, tuple[Number, Number] | None]:
    judge = evaluator(search.kind)
    best, tried, end = Attempt(float("-inf")), 0, time.monotonic() + seconds
    with tqdm(total=round(seconds, 1), unit="s", disable=not sys.stderr.isatty(), leave=False) as bar:
        for tried, attempt in enumerate(search.attempts(rng), start=1):
            if attempt.score > best.score:
                best = attempt
                bar.set_postfix(nearest=f"{best.score:.6g}")
                if attempt.score > 1 and attempt.data:
                    sides = judge(attempt.data)
                    if violated(search.relation, *sides):
                        return attempt, tried, sides
            bar.update(max(0.0, seconds - (end - time.monotonic()) - bar.n))
            if time.monotonic() > end:
                break
    return best, tried, None


def _searchable(label: str) -> tuple[Claim, Search]:
    for claim in matching(label):
        if claim.search is not None:
            return claim, claim.search
    known = ", ".join(claim.key for claim in claims() if claim.search is not None)
    raise InputError(f"{label!r} has no search; these have one: {known or 'none'}")


def _document(claim: Claim, search: Search, data: Mapping[str, Any], left: Number, right: Number) -> dict[str, Any]:
    document = {
        "label": claim.label,
        "part": claim.part,
        "sentence": f"Found by a search: {search.words}",
        "kind": search.kind,
        "data": data,
        "left": {"latex": search.left, "value": _written(left)},
        "relation": search.relation,
        "right": {"latex": search.right, "value": _written(right)},
    }
    # a control has to be chosen by whoever stores the file; the schema is checked with a placeholder
    parse("found", {**document, "controls": [{"name": "to be chosen", "data": {}}]})
    return document


def _written(value: Number) -> str | list[str]:
    return [str(end) for end in value] if isinstance(value, tuple) else str(value)
