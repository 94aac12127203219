"""What a study of asking is configured by; frozen, checked, and written into every session's file."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from bridge_algos.asking.candidates import LISTED
from bridge_algos.asking.goal import goal
from bridge_algos.asking.rules import check_rule
from bridge_algos.asking.tabular import POOL, REFERENCES
from bridge_algos.asking.utility import ADDITIVE
from bridge_theory.errors import InputError

DYNAMICS = ("known", "unknown")


@dataclass(frozen=True)
class AskConfig:
    """A simulated teacher is asked about a tabular environment.

    Args:
        environment: a name, or an MDP's .npz file.
        embedding: one of ADDITIVE.
        utility_range: best minus worst utility in nats; W is then 2 ||w*||.
        weight_norm: instead of a range, ||w*|| times the embedding's bound B; that is then also B W.
        until: when to stop.
        delta: failure probability of a session.
        n_demonstrations: of the utility's best stationary policy, by each seed anew.
        demonstrations: an .npz file of demonstrations that every seed uses instead.
        asking: the rule that chooses questions.
        reference: what shares are measured against.
        max_questions: a session without a certificate ends here.
        pool: trajectories simulated for questions.
        limit: policies listed as candidates, at most; beyond, a sample.
        dynamics: "known", or "unknown": features of candidates are then estimated from simulated rollouts.
    """

    environment: str
    embedding: str = "state_action_counts"
    utility_range: float | None = 5.0
    weight_norm: float | None = None
    until: str = "10%"
    delta: float = 0.05
    n_demonstrations: int = 2
    demonstrations: str | None = None
    asking: str = "pool"
    reference: str = "random"
    max_questions: int = 1000
    pool: int = POOL
    limit: int = LISTED
    dynamics: str = "known"

    def __post_init__(self) -> None:
        check_rule(self.asking)
        goal(self.until, 1.0)
        if self.embedding not in ADDITIVE:
            raise InputError(f"the embedding must be one of {', '.join(ADDITIVE)}, got {self.embedding!r}.")
        if self.reference not in REFERENCES:
            raise InputError(f"the reference must be one of {', '.join(REFERENCES)}, got {self.reference!r}.")
        if self.dynamics not in DYNAMICS:
            raise InputError(f"dynamics must be one of {', '.join(DYNAMICS)}, got {self.dynamics!r}.")
        if self.dynamics == "unknown" and goal(self.until, 1.0).rho:
            raise InputError("a share of the gain needs known dynamics; with unknown ones give until='10%', say.")
        if not 0 < self.delta < 1:
            raise InputError(f"delta must lie strictly between 0 and 1, got {self.delta}.")
        for name, least in (("n_demonstrations", 0), ("max_questions", 0), ("pool", 2), ("limit", 1)):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or value < least:
                raise InputError(f"{name} must be a whole number of at least {least}, got {value!r}.")
        if (self.utility_range is None) == (self.weight_norm is None):
            raise InputError("give either the range of utilities or B W, not both and not neither.")
        for name in ("utility_range", "weight_norm"):
            value = getattr(self, name)
            if value is not None and not 0 < value < 1e6:
                raise InputError(f"{name} must be a positive number below a million, got {value!r}.")

    def record(self) -> dict[str, Any]:
        """The configuration as plain values; dynamics are named where they are unknown."""
        return {name: value for name, value in asdict(self).items() if (name, value) != ("dynamics", "known")}
