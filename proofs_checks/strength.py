"""What a statement is worth: as much as the weakest of the links that it needs, and no more."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from proofs_checks.claim import Claim, Link, Repair
from proofs_checks.evidence import STRENGTH, Evidence, Kind

Holds = Callable[[Evidence], bool]
"""Whether a piece of evidence held in the run at hand."""


def always(_: Evidence) -> bool:
    """Every piece holds: what the ledger records, before anything is run."""
    return True


def weakest(statement: Claim | Repair, holds: Holds = always) -> Kind | None:
    """The kind of evidence behind the weakest link; None where there is no link, or nothing holds for one of them."""
    kinds = [link_kind(one, statement.evidence, holds) for one in statement.links]
    known = [kind for kind in kinds if kind is not None]
    return max(known, key=STRENGTH.index) if known and len(known) == len(kinds) else None


def link_kind(one: Link, evidence: Iterable[Evidence], holds: Holds = always) -> Kind | None:
    """The strongest support of one link that holds; a repaired statement supports it as far as its own links reach."""
    if not one.by:
        return "text"
    kinds = {item.kind for item in evidence if item.handle in one.by and holds(item)}
    kinds |= {kind for part in one.by if isinstance(part, Repair) and (kind := weakest(part, holds))}
    return min(kinds, key=STRENGTH.index, default=None)
