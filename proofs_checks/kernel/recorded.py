"""What the gate found when it last ran, and whether that is about the sources at hand."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

from proofs_checks.kernel import refutations
from proofs_checks.kernel.manifest import digest, shipped
from proofs_checks.outcome import Outcome

FILE = Path(__file__).parent / "recorded.json"
_SHOWN = 12  # digits of a digest


@dataclass
class Record:
    """The result of one run of the gate.

    Attributes:
        coq: the version of Coq.
        digest: of everything that was compiled, see ``expected_digest``.
        theorems: the exported theorems that were accepted.
        refutations: the counterexamples whose refutation was accepted.
        mutants: how many wrong variants of the theorems were refuted.
    """

    coq: str
    digest: str
    theorems: list[str]
    refutations: list[str]
    mutants: int

    @classmethod
    def stored(cls) -> Record:
        """The record that is shipped."""
        return cls(**json.loads(FILE.read_text(encoding="utf-8")))

    def text(self) -> str:
        """The record as it is stored."""
        return json.dumps(asdict(self), indent=1, sort_keys=True) + "\n"

    def differences(self, other: Record, *, numerical: bool) -> list[str]:
        """What this run found otherwise than a recorded one; the version of Coq may differ."""
        parts = ["digest", "theorems", "refutations", "mutants"] if numerical else ["digest", "theorems", "mutants"]
        return [
            f"recorded.json must say what was found, got another {part}; run python -m proofs_checks.kernel.gate "
            "--record"
            for part in parts
            if getattr(self, part) != getattr(other, part)
        ]


@cache
def expected_digest() -> str:
    """The digest of the sources at hand: the development, the generated refutations, the manifest, the mutants."""
    what = shipped()
    lists = {"theorems": repr(what.theorems), "mutants": repr(what.mutants)}
    return digest({**what.sources, **refutations.generated(numerical=True), **lists})


@cache
def counts() -> dict[str, int]:
    """How many theorems and counterexamples the kernel has checked, for the sources at hand; 0 for other sources."""
    record = Record.stored()
    fresh = record.digest == expected_digest()
    return {
        "kernel_checked": len(record.theorems) if fresh else 0,
        "kernel_refuted": len(record.refutations) if fresh else 0,
    }


def theorem(*, name: str, replace: tuple[str, str] = ("", "")) -> Outcome:
    """Whether the gate has accepted an exported theorem, for exactly the sources that are shipped.

    ``replace`` changes the theorem's source first: that is how the check is shown to notice a change.
    """
    record, what = Record.stored(), shipped()
    if name not in record.theorems or name not in what.theorems:
        return Outcome(1, (f"{name} is not among the theorems that the kernel has accepted",))
    text = what.sources[what.theorems[name].file]
    is_changed = replace[0] and text.replace(*replace) != text
    if is_changed or record.digest != expected_digest():
        return Outcome(1, (f"the sources of {name} are not those that the kernel has accepted; run make proofs",))
    return Outcome(1, details=f"{name}: accepted by the kernel, from the axioms of the reals ({_origin(record)})")


def refutation(name: str) -> str:
    """What is recorded of the kernel's refutation by a counterexample; empty if nothing is, for the sources at hand."""
    record = Record.stored()
    if name not in record.refutations or record.digest != expected_digest():
        return ""
    return f"refuted in Coq over all models of its kind ({_origin(record)})"


def origin() -> str:
    """By which version of Coq the theorems were accepted, and for which sources; says so if these have changed."""
    record = Record.stored()
    changed = "" if record.digest == expected_digest() else "; the sources at hand are others, run make proofs"
    return f"Accepted by Coq {record.coq} for the sources {record.digest[:_SHOWN]}{changed}"


def _origin(record: Record) -> str:
    return f"recorded: Coq {record.coq}, sources {record.digest[:_SHOWN]}"
