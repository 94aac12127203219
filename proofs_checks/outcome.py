"""What one run of a check says: how many decisions it made, and which of them went against the statement."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

_SHOWN_FAILURES = 5


@dataclass(frozen=True)
class Outcome:
    """The result of one check.

    Attributes:
        decisions: how many yes-or-no questions were decided. None decided is not a pass.
        failures: one sentence for each of the first few questions decided against the statement, or left undecided.
        details: one sentence with the numbers of the check.
        skipped: why the check could not run here (a tool is not installed); a skipped check is no evidence.

    >>> Outcome(3, details="three cases").holds, Outcome(3, ("the second fails",)).holds, Outcome(0).holds
    (True, False, False)
    """

    decisions: int
    failures: tuple[str, ...] = ()
    details: str = ""
    skipped: str = ""

    def __post_init__(self) -> None:
        if type(self.decisions) is not int or not isinstance(self.failures, tuple):
            raise TypeError(f"an outcome is a number of decisions and a tuple of failures, not {self!r}")

    @property
    def holds(self) -> bool:
        """At least one question was decided, and none against the statement."""
        return self.decisions > 0 and not self.failures and not self.skipped


def skipped(why: str) -> Outcome:
    """The outcome of a check that cannot run here, e.g. ``skipped("coqc is not installed")``."""
    return Outcome(0, skipped=why)


def together(*outcomes: Outcome) -> Outcome:
    """One outcome for several: it holds when there are parts and every one does.

    >>> together(Outcome(1, details="a"), Outcome(2, details="b"))
    Outcome(decisions=3, failures=(), details='a; b', skipped='')
    >>> together().holds, together(Outcome(1), Outcome(0, details="an empty part")).failures
    (False, ('nothing was decided: an empty part',))
    """
    empty = [f"nothing was decided: {part.details}" for part in outcomes if not part.decisions and not part.skipped]
    failures = [failure for part in outcomes for failure in part.failures]
    return Outcome(
        sum(part.decisions for part in outcomes),
        tuple([*failures, *empty][:_SHOWN_FAILURES]),
        "; ".join(part.details for part in outcomes if part.details),
        "; ".join(part.skipped for part in outcomes if part.skipped),
    )


@dataclass
class Tally:
    """Collects many decisions of one check.

    >>> tally = Tally()
    >>> tally.expect(1 + 1 == 2, "arithmetic fails")
    True
    >>> tally.outcome("sums").holds, Tally().outcome("nothing").holds
    (True, False)
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

    def outcome(self, details: str = "") -> Outcome:
        """The finished result."""
        return Outcome(self.decisions, tuple(self.failures), details)
