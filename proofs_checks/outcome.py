"""What one run of a check says: whether the claim survived it, and the numbers a reader wants to see."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Outcome:
    """``holds`` is False when the check contradicts its claim or could not decide it; ``detail`` is one sentence."""

    holds: bool
    detail: str

    def __bool__(self) -> bool:
        return self.holds


def all_hold(*outcomes: Outcome) -> Outcome:
    """Holds when every part does; tells the first part that does not, else all of them.

    >>> all_hold(Outcome(True, "a"), Outcome(True, "b"))
    Outcome(holds=True, detail='a; b')
    """
    failed = [outcome for outcome in outcomes if not outcome.holds]
    if failed:
        return failed[0]
    return Outcome(True, "; ".join(outcome.detail for outcome in outcomes))
