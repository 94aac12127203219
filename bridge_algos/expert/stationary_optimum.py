"""What is known of the best stationary deterministic policy: the best one found and a certified bound on all others."""

from __future__ import annotations

from dataclasses import dataclass

from bridge_algos.mdp import IntArray


@dataclass(frozen=True, eq=False)
class StationaryOptimum:
    """A stationary deterministic policy and a certified bound on all others.

    Args:
        policy: (S,) integers, the best policy found.
        value: its expected return.
        upper: no stationary deterministic policy returns more (rounding errors included).
        tolerance: the part of ``upper - value`` that rounding errors explain.
        method: ``"enumeration"`` or ``"branch and bound"``.
        evaluations: policies evaluated, or relaxed problems solved.
    """

    policy: IntArray
    value: float
    upper: float
    tolerance: float
    method: str
    evaluations: int

    @property
    def gap(self) -> float:
        """Certified distance from the optimum, upper - value."""
        return self.upper - self.value

    @property
    def optimal(self) -> bool:
        """Whether the policy is certified to be optimal up to rounding errors."""
        return self.gap <= self.tolerance

    def describe(self) -> str:
        """What was certified, in one sentence."""
        if self.optimal:
            return (
                f"the best stationary deterministic policy returns {self.value:.6g}, optimal up to {self.gap:.1e} by "
                f"{self.method}"
            )
        return (
            f"the best stationary deterministic policy found returns {self.value:.6g}, not certified as optimal: "
            f"{self.method} stopped after {self.evaluations} evaluations and leaves a gap of {self.gap:.3g}"
        )
