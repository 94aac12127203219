"""What a certificate is conditional on: which bounds a configuration leaves, and what no log can show."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.verify.comparator import comparator
from proofs_checks.verify.consistency import possible
from proofs_checks.verify.facts import Facts


def events(given: Facts) -> dict[str, Fraction]:
    """Failure probability of each event that every bound but the trivial one uses."""
    names = ("weights",) if given.known else ("weights", "transitions")
    return dict.fromkeys(names, given.delta)


def theory_withheld(given: Facts) -> list[str]:
    """Why no bound but the trivial one is available, whatever the run did; empty when all are."""
    config = given.configuration
    total = sum(events(given).values(), start=Fraction(0))
    counted = bool(given.offline.any())
    reasons = {
        _teacher(given): config["oracle"] != "bradley-terry",
        f"the fitted slope is {float(given.slope):g}, not the Bradley-Terry model's 1": given.slope != 1,
        "noise changed the recorded actions, so that counts are not those of the environment": config["noise"] != 0
        and counted,
        "the demonstrations pass transitions that the environment excludes": counted
        and config["noise"] == 0
        and not possible(given, *given.demonstrations),
        "the failure probabilities of the events of the other bounds add up to 1 or more": total >= 1,
    }
    return [reason for reason, holds in reasons.items() if holds]


def likelihood_withheld(given: Facts) -> list[str]:
    """Why there is no bound from the likelihood set (companion G6); it needs neither fitted weights nor their slope."""
    reasons = {
        "the learner did not know the dynamics": not given.known,
        _teacher(given): given.configuration["oracle"] != "bradley-terry",
    }
    return [reason for reason, holds in reasons.items() if holds]


def _teacher(given: Facts) -> str:
    oracle = given.configuration["oracle"]
    return f"the answers come from the oracle {oracle!r}, not from the Bradley-Terry model"


def notes(given: Facts) -> tuple[str, ...]:
    """What limits the bounds of a certificate."""
    withheld = theory_withheld(given)
    if withheld:
        left = "bound is" if likelihood_withheld(given) else "and the likelihood bounds are"
        return tuple(f"only the trivial {left} certified: {reason}" for reason in withheld)
    kinds = {"fixed": "hand-set multiplier and bonuses have", "stated": "stated multiplier and bonuses have"}
    kind = kinds.get(given.configuration["confidence"])
    if kind is None:
        return ()
    return (f"the run's {kind} no guarantee; the bounds use the certified radius and bonuses, and the sets they give",)


def assumptions(given: Facts) -> tuple[str, ...]:
    """What the bounds assume and a log cannot show."""
    found = ["the utility of a policy is <phi, w*> with ||w*|| <= W"]
    if assumed := comparator(given).assumed:
        found.append(assumed)
    if given.configuration["environment"].endswith(".npz"):
        kept = "dynamics" if given.known else "first states"
        found.append(f"the {kept} in the log are those of its environment's file")
    answered = "answers are independent given the trajectories and follow the Bradley-Terry model with w*"
    if theory_withheld(given):
        return (*found, *(() if likelihood_withheld(given) else (answered,)))
    counted = " and demonstrations" if given.offline.any() else ""
    return (
        *found,
        answered,
        f"trajectories{counted} are fresh, independent draws from the real environment, also the two rollouts of a "
        "comparison",
    )
