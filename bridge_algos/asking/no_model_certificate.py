"""What a session without a model of utility has certified, in numbers and in one sentence."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PairwiseCertificate:
    """The state of the guarantee.

    Args:
        certified: whether the recommended item is preferred to every other with probability at least 1/2 - eps.
        no_winner: whether no item is: each one loses to another more often.
        recommended: its index.
        least: lower bound on the smallest of its preference probabilities.
        eps: as given.
        failure_probability: delta, for all pairs and every way of asking and stopping.
        answers, skipped: answers counted, and questions left without one.
        items: how many were compared.
        contradiction: in words, when the answers contradict that preferences stay the same.
    """

    certified: bool
    no_winner: bool
    recommended: int
    least: float
    eps: float
    failure_probability: float
    answers: int
    skipped: int
    items: int
    contradiction: str | None

    @property
    def sentence(self) -> str:
        """What holds, how surely, and on what it rests."""
        after = f"after {self.answers} answer{'' if self.answers == 1 else 's'}, about these {self.items} items"
        level = f"{0.5 - self.eps:.4g}"
        if self.contradiction is not None:
            return f"Not certified {after}: {self.contradiction}."
        if not self.certified and not self.no_winner:
            return f"Not certified {after}: no item is known to be preferred to every other with probability {level}."
        found = (
            f"Certified {after}: item {self.recommended} is preferred to every other with probability at least {level}"
            if self.certified
            else f"No winner at eps = {self.eps:g} {after}: each item loses to another one, over which it is preferred "
            f"with probability below {level}"
        )
        return (
            f"{found}. This fails with probability at most {self.failure_probability:.4g}, whenever the session is "
            "stopped, if both items of a question are drawn afresh, their order is random, preferences do not drift, "
            "and questions are left unanswered for no reason that depends on the answer."
        )
