"""Is a theorem about this run? Which of its assumptions the run does not meet."""

from __future__ import annotations

from bridge_algos.run.candidates import EXHAUSTIVE
from bridge_algos.run.config import RADII
from bridge_algos.run.world import EXPELLED, HAND_SET, caveats
from experiments.compare.subject import Subject


def missing_of_certified(subject: Subject) -> tuple[str, ...]:
    """What a certificate needs beyond its log, so that its comparator is the policy that our regret is against.

    The checker bounds the regret against the best of the policies searched, and judges everything else by itself.
    """
    return tuple(_of_the_search(subject) + [EXPELLED] * (subject.config.noise > 0))


def missing_of_repaired(subject: Subject) -> tuple[str, ...]:
    """Assumptions of R4, R5 and R7 that the run does not meet."""
    config = subject.config
    found = _of_every_theorem(subject)
    if config.confidence != "repaired":
        found.append(f"it is about the repaired sets, this run used the {config.confidence} ones")
    exact_pairs = ("uncertainty_and_bonus", "max_uncertainty") if subject.known else ("uncertainty_and_bonus",)
    if config.pair_rule not in exact_pairs:
        found.append(f"the pair rule {config.pair_rule} does not play the arg-max pair")
    if config.fit != "exact":
        found.append("the weights are not at their optimum")
    return tuple(found)


def missing_of_stated(subject: Subject) -> tuple[str, ...]:
    """Assumptions of the paper's regret theorem and lemmas that the run does not meet."""
    config = subject.config
    found = _of_every_theorem(subject)
    if config.confidence != "stated":
        found.append(f"it is about the stated sets, this run used the {config.confidence} ones")
    wanted = "stated-known" if subject.known else "stated"
    if config.radius != wanted:
        found.append(f"it is about the offline set of radius {wanted!r}, this run used {config.radius!r}")
    if config.comparisons != 1:
        found.append("it is about one comparison a round")
    if config.fit != "exact":
        found.append("the weights are not at their optimum")
    return tuple(found)


def _of_every_theorem(subject: Subject) -> list[str]:
    # the confidence sets themselves are judged above
    own = caveats(subject.config.but(confidence="repaired"), subject.world)
    return list(dict.fromkeys(own + _of_the_search(subject)))


def _of_the_search(subject: Subject) -> list[str]:
    """Why the best stationary policy may not be among the policies searched, noise aside."""
    config, world, found = subject.config, subject.world, []
    if world.demonstrations is not None:
        found.append("a file does not show whether its demonstrations come from the best policy")
    elif not world.expert.is_maximiser:
        found.append("the expert is not certified to be the best policy")
    elif world.expert.policy.ndim == 2:
        found.append("the expert is time-dependent, so that the best stationary policy may disagree with it")
    if not bool(subject.results.search_way.isin(EXHAUSTIVE).all()):
        found.append("only a sample of the offline set was searched")
    if config.radius not in RADII:
        found.append(HAND_SET)
    elif config.radius == "stated-known" and not subject.known:
        found.append("the offline radius 'stated-known' is about known dynamics")
    return found
