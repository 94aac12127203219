"""What a session has certified, in numbers and in one sentence."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Certificate:
    """The state of a session's guarantee, after ``answers`` answers.

    Args:
        certified: whether the goal is reached.
        recommended: index of the recommended candidate.
        gap: nats; the best candidate's utility exceeds the recommended one's by at most this. Where the goal is not
            reached, the bound may be far from tight: only what decides is computed.
        share: of what there is to gain over the reference, at least this much is gained; None without a reference, 0
            where nothing is certified.
        failure_probability: delta, for the whole session and every way of stopping it, plus that of the candidates.
        assumptions: sentences on which the guarantee rests.
        needs_weight_bound: whether the guarantee still rests on W.
        answers, skipped: answers counted, and questions left without one.
        candidates: how many were compared.
        goal: in words.
    """

    certified: bool
    recommended: int
    gap: float
    share: float | None
    failure_probability: float
    assumptions: tuple[str, ...]
    needs_weight_bound: bool
    answers: int
    skipped: int
    candidates: int
    goal: str

    @property
    def sentence(self) -> str:
        """The certificate in words: what holds, how surely, and on what it rests."""
        count = f"{self.answers} answer{'' if self.answers == 1 else 's'}"
        among = f"about these {self.candidates} candidates"
        if not self.certified:
            return (
                f"Not certified after {count}, {among}: the gap is at most {self.gap:.4g} nats; the goal is that "
                f"{self.goal}."
            )
        return (
            f"Certified after {count}, {among}: {self.goal}. This fails with probability at most "
            f"{self.failure_probability:.4g}, whenever the session is stopped, if " + "; ".join(self.assumptions) + "."
        )
