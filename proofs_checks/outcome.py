"""What one run of a check says: whether the claim survived it, and the numbers a reader wants to see."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

_SHOWN_FAILURES = 5


@dataclass(frozen=True)
class Outcome:
    """``holds`` is False when the check contradicts its claim or could not decide it; ``detail`` is one sentence.

    ``decisions`` is how many yes-or-no questions were decided, ``skipped`` marks a check that could not run here: it
    neither holds nor fails, and is no evidence.
    """

    holds: bool
    detail: str
    decisions: int = field(default=1, repr=False)
    skipped: bool = field(default=False, repr=False)

    def __post_init__(self) -> None:
        if type(self.holds) is not bool:
            raise TypeError(f"an outcome holds or not; {self.holds!r} is neither ({self.detail})")
        if not self.detail:
            raise TypeError("an outcome says what was found; its detail is empty")
        if self.holds and self.decisions < 1:
            raise TypeError(f"a check that decided nothing cannot hold ({self.detail})")

    def __bool__(self) -> bool:
        return self.holds


def skipped(why: str) -> Outcome:
    """The outcome of a check that cannot run here, e.g. ``skipped("coqc is not installed")``."""
    return Outcome(False, why, decisions=0, skipped=True)


def all_hold(*outcomes: Outcome) -> Outcome:
    """Holds when there are parts and every one does; tells the first part that does not, else all of them.

    >>> all_hold(Outcome(True, "a"), Outcome(True, "b"))
    Outcome(holds=True, detail='a; b')
    >>> all_hold().holds
    False
    """
    failed = [outcome for outcome in outcomes if not outcome.holds]
    if failed:
        return failed[0]
    if not outcomes:
        return Outcome(False, "nothing was checked", decisions=0)
    return Outcome(True, "; ".join(outcome.detail for outcome in outcomes), sum(part.decisions for part in outcomes))


@dataclass
class Tally:
    """Collects many decisions of one check.

    >>> tally = Tally()
    >>> tally.expect(1 + 1 == 2, "arithmetic fails")
    True
    >>> tally.outcome("sums"), Tally().outcome("nothing")
    (Outcome(holds=True, detail='sums: 1 decision'), Outcome(holds=False, detail='nothing: nothing was decided'))
    """

    decisions: int = 0
    failures: list[str] = field(default_factory=list)

    def expect(self, holds: bool | np.bool_, otherwise: str) -> bool:
        """Count one decision; ``otherwise`` is the sentence to report if it went against the statement.

        Only a Boolean is accepted: ``None``, an undecided ball or a solver's ``unknown`` is an error, never a pass.
        """
        if not isinstance(holds, bool | np.bool_):
            raise TypeError(f"a decision must be True or False, not {holds!r} ({otherwise})")
        self.decisions += 1
        if not holds and len(self.failures) < _SHOWN_FAILURES:
            self.failures.append(otherwise)
        return bool(holds)

    def outcome(self, detail: str) -> Outcome:
        """Holds if something was decided and nothing failed."""
        if self.decisions == 0:
            return Outcome(False, f"{detail}: nothing was decided", decisions=0)
        if self.failures:
            return Outcome(False, f"{detail}: {'; '.join(self.failures)}", self.decisions)
        return Outcome(True, f"{detail}: {self.decisions} decision{'s' * (self.decisions != 1)}", self.decisions)
