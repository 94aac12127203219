"""What a session has certified, in numbers and in one sentence."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, log

from bridge_algos.asking.model_test import DELTA_MODEL


@dataclass(frozen=True)
class Certificate:
    """The state of a session's guarantee, after ``answers`` answers.

    Args:
        certified: whether the goal is reached.
        recommended: index of the recommended candidate.
        gap: nats; the best candidate's utility exceeds the recommended one's by at most this. Where the goal is not
            reached, the bound may be far from tight: only what decides is computed. It means nothing beside a
            contradiction.
        share: of what there is to gain over the reference, at least this much is gained; None without a reference, 0
            where nothing is certified.
        failure_probability: delta, for the whole session and every way of stopping it, plus that of the candidates.
        assumptions: sentences on which the guarantee rests.
        needs_weight_bound: whether the guarantee still rests on W.
        answers, skipped: answers counted, and questions left without one.
        candidates: how many were compared.
        goal: in words.
        room: nats by which the log-likelihood of the best weights found lies above the threshold; near 0 the answers
            hardly fit the model, below 0 they do not.
        evidence: nats that the model test holds against the model; it is refuted at ``log(1 / delta_M)``.
        contradiction: in words, when the answers contradict the model; nothing is certified then.
        warnings: sentences on what looks wrong.
        reached: whether the answers show the goal, if they follow the model; without ``certified``, a certificate waits
            for check questions.
        checks: answers to check questions that agreed with the fit, and that did not.
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
    room: float = inf
    evidence: float = -inf
    contradiction: str | None = None
    warnings: tuple[str, ...] = ()
    reached: bool = False
    checks: tuple[int, int] = (0, 0)

    @property
    def sentence(self) -> str:
        """The certificate in words: what holds, how surely, and on what it rests."""
        count = f"{self.answers} answer{'' if self.answers == 1 else 's'}"
        among = f"about these {self.candidates} candidates"
        beside = self._beside
        if self.contradiction is not None:
            return f"Not certified after {count}, {among}: {self.contradiction}.{beside}"
        if self.reached and not self.certified:
            return (
                f"Not certified after {count}, {among}: the answers show that {self.goal}; whether they follow the "
                f"model is not checked enough.{beside}"
            )
        if not self.certified:
            return (
                f"Not certified after {count}, {among}: the gap is at most {self.gap:.4g} nats; the goal is that "
                f"{self.goal}.{beside}"
            )
        return (
            f"Certified after {count}, {among}: {self.goal}. This fails with probability at most "
            f"{self.failure_probability:.4g}, whenever the session is stopped, if "
            + "; ".join(self.assumptions)
            + f".{beside}"
        )

    @property
    def _beside(self) -> str:
        """How well the model fits, and what looks wrong."""
        if not self.answers:
            return ""
        fit = (
            f" The best weights lie {self.room:.3g} nats above the threshold (none are left at 0); the model test "
            f"holds {self.evidence:.2g} nats against the model (refuted at {log(1 / DELTA_MODEL):.2g})."
        )
        if sum(self.checks):
            fit += (
                f" Of {sum(self.checks)} answers to check questions, which the other answers predict most surely, "
                f"{self.checks[0]} agreed."
            )
        return fit + "".join(f" Warning: {warning}." for warning in self.warnings)
