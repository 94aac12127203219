"""What a certificate is conditional on: which bounds a configuration leaves, and what no log can show."""

from __future__ import annotations

import numpy as np

from proofs_checks.verify.consistency import ALL, VERSION_SPACE, best_policy_is_searched
from proofs_checks.verify.facts import Facts


def theory_withheld(given: Facts) -> list[str]:
    """Why no bound but the trivial one is available, whatever the run did; empty when all are."""
    config = given.configuration
    answers = given.outcomes
    reasons = {
        f"the answers come from the oracle {config['oracle']!r}, not from the Bradley-Terry model": config["oracle"]
        != "bradley-terry",
        "some answers are missing or ties": bool((~np.isin(answers, (0.0, 1.0))).any()),
        f"the fitted slope is {float(given.slope):g}, not the Bradley-Terry model's 1": given.slope != 1,
        "noise changed the recorded actions, so that counts are not those of the environment": given.algorithm
        == "bridge"
        and config.get("noise") != 0,
    }
    return [reason for reason, holds in reasons.items() if holds]


def notes(given: Facts) -> tuple[str, ...]:
    """What limits the bounds of a certificate."""
    withheld = theory_withheld(given)
    if withheld:
        return tuple(f"only the trivial bound is certified: {reason}" for reason in withheld)
    kinds = {"fixed": "hand-set multiplier and bonuses have", "stated": "stated multiplier and bonuses have"}
    kind = kinds.get(given.configuration["confidence"])
    if kind is None:
        return ()
    return (f"the run's {kind} no guarantee; the bounds use the certified radius and bonuses, and the sets they give",)


def assumptions(given: Facts) -> tuple[str, ...]:
    """What the bounds assume and a log cannot show."""
    searched = best_policy_is_searched(given)
    comparator = {
        ALL: "regret is measured against the best stationary deterministic policy, which is searched because all are",
        VERSION_SPACE: "the demonstrations come from a best stationary deterministic policy, so that it is searched: "
        f"{VERSION_SPACE}",
        None: "regret is measured against the best of the policies searched; a log cannot show how good that is",
    }
    general: tuple[str, ...] = ("the utility of a policy is <phi, w*> with ||w*|| <= W", comparator[searched])
    if given.configuration["environment"].endswith(".npz"):
        kept = "dynamics" if given.known else "first states"
        general += (f"the {kept} in the log are those of its environment's file",)
    if theory_withheld(given):
        return general
    return (
        *general,
        "answers are independent given the trajectories and follow the Bradley-Terry model with w*",
        "trajectories and demonstrations are fresh, independent draws from the real environment, also the two rollouts "
        "of a comparison",
    )
