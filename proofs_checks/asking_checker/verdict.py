"""What the file of a session proves: a verdict, in words and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import isfinite
from typing import Any

from bridge_theory.rounding import rounded_up

UNSHOWN = (
    "the answers came from the teacher, in the order of the file, each given without knowing what it would change",
    "questions were left unanswered for no reason that depends on the answer",
    "W, delta and the prior were fixed before the first answer",
    "the environment's dynamics are those of the definition that its name, or file, gives now",
)
"""What nothing in a file can show."""


@dataclass(frozen=True)
class Verdict:
    """The verdict on one session.

    Args:
        seed: whose.
        verdict: certified, not certified, contradicted or refused.
        claims: whether the session claims a certificate.
        reasons: why it is refused, contradicted, or not certified.
        gap: nats above which the best candidate does not lie, rounded up (with a share: the slack, at most 0 where the
            goal is reached); infinite where there is none.
        target: nats; the gap that is the goal.
        goal: in words.
        claimed_gap: the session's.
        failure: probability that the certificate is wrong under its assumptions.
        margin: nats by which the likeliest weights exceed the level; near 0 the answers nearly contradict the model.
        covered: whether a simulated teacher's weights are in the likelihood set now, for information.
        answers, skipped, candidates, policies: counts.
        assumptions: what the certificate rests on.
    """

    seed: int
    verdict: str
    claims: bool
    reasons: tuple[str, ...] = ()
    gap: float = float("inf")
    target: float = 0.0
    goal: str = ""
    claimed_gap: float = float("inf")
    failure: float = 1.0
    margin: float = 0.0
    covered: bool | None = None
    answers: int = 0
    skipped: int = 0
    candidates: int = 0
    policies: int = 0
    assumptions: tuple[str, ...] = ()

    @property
    def stands(self) -> bool:
        """Whether the session claims nothing that the checker does not certify."""
        return self.verdict != "refused" and (self.verdict == "certified" or not self.claims)

    def record(self) -> dict[str, Any]:
        """As plain JSON values; an infinite bound is null."""
        values = asdict(self) | {"stands": self.stands}
        return {k: None if isinstance(v, float) and not isfinite(v) else v for k, v in values.items()}

    def sentence(self) -> str:
        """The verdict in words."""
        head = f"seed {self.seed}: "
        if self.verdict == "refused":
            return head + "REFUSED. " + " ".join(self.reasons)
        if self.verdict == "contradicted":
            return head + "contradicted. " + " ".join(self.reasons)
        about = f"after {self.answers} answers, about these {self.candidates} candidates ({self.policies} policies)"
        if self.verdict == "certified":
            return head + f"certified {about}: {self.goal}. Fails with probability at most {rounded_up(self.failure)}."
        return head + f"NOT CERTIFIED {about}: the goal is that {self.goal}. " + " ".join(self.reasons)


def table(verdicts: Sequence[Verdict]) -> str:
    """A row for each session, then what the certificates rest on, then a sentence for each session."""
    head = ("seed", "verdict", "claims", "answers", "candidates", "gap <=", "claimed", "goal", "margin", "covered")
    rows = [head] + [_row(v) for v in verdicts]
    widths = [max(len(row[i]) for row in rows) for i in range(len(head))]
    lines = ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]
    lines.append(
        "gap: nats, each rounded up (with a share: what must be at most 0); margin: nats by which the likeliest "
        "weights exceed the level; covered: whether the simulated teacher's weights are in the set, for information"
    )
    shown = dict.fromkeys(sentence for v in verdicts if v.verdict == "certified" for sentence in v.assumptions)
    lines += [f"assuming: {sentence}" for sentence in shown]
    lines.append("not checked: that questions which could show a wrong model came last; no bound rests on them")
    lines += [f"no file can show that {sentence}" for sentence in UNSHOWN]
    lines += [v.sentence() for v in verdicts]
    counts = [sum(v.verdict == "certified" for v in verdicts), sum(v.stands for v in verdicts)]
    return "\n".join([*lines, f"{counts[0]} of {len(verdicts)} certified; {counts[1]} claim nothing beyond that"])


def _row(v: Verdict) -> tuple[str, ...]:
    if v.verdict == "refused":
        return (str(v.seed), "REFUSED", *("-" for _ in range(8)))
    covered = "-" if v.covered is None else "yes" if v.covered else "no"
    counts = (str(v.answers), str(v.candidates))
    gaps = tuple(rounded_up(x) if isfinite(x) else "-" for x in (v.gap, v.claimed_gap, v.target))
    words = v.verdict.upper() if v.verdict == "not certified" else v.verdict
    return (str(v.seed), words, "yes" if v.claims else "no", *counts, *gaps, f"{v.margin:.3f}", covered)
