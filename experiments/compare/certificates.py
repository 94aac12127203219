"""The certified data-dependent bound of a run: what the independent checker finds in its logs."""

from __future__ import annotations

from bridge_theory.errors import InputError
from experiments.compare.subject import Subject
from experiments.compare.theory_curves import Curve


def certified(subject: Subject, label: str) -> Curve:
    """The least of the bounds of R4 that the checker certifies, for every seed.

    Raises:
        InputError: when the run has no logs, or a log is not certified.
    """
    raise InputError("the run has no logs; store them with 'bridge-rl run ... --log'.")
