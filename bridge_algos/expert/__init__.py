"""Optimal policies with certificates: dynamic programming, linear programs, and the best stationary policy."""

from bridge_algos.expert.branch_and_bound import branch_and_bound
from bridge_algos.expert.certificate import Certificate
from bridge_algos.expert.dynamic_programming import backward_induction, policy_iteration
from bridge_algos.expert.experts import KINDS, Expert, make_expert
from bridge_algos.expert.linear_program import SolverError
from bridge_algos.expert.stationary import best_stationary, enumerate_stationary
from bridge_algos.expert.stationary_optimum import StationaryOptimum

__all__ = [
    "KINDS",
    "Certificate",
    "Expert",
    "SolverError",
    "StationaryOptimum",
    "backward_induction",
    "best_stationary",
    "branch_and_bound",
    "enumerate_stationary",
    "make_expert",
    "policy_iteration",
]
