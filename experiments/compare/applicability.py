"""Is a theorem about this run? Which of its assumptions the run does not meet."""

from __future__ import annotations

from bridge_algos.run.candidates import EXHAUSTIVE
from bridge_algos.run.config import RunConfig
from bridge_algos.run.world import World, caveats
from experiments.compare.subject import Subject


def missing_of_certified(subject: Subject) -> tuple[str, ...]:
    """Why the certificates are about another regret than ours, which is against the best stationary policy found.

    The checker bounds the regret against the best of the policies searched. Whether that is ours needs no assumption:
    the results say how good the best of them is. Everything else the checker judges by itself.
    """
    if not subject.lacking:
        return ()
    return (
        f"in {subject.lacking} of {subject.results.sizes['seed']} seeds the best policy is not among those searched, "
        "which the certificate is about",
    )


def missing_of_repaired(subject: Subject, sets: tuple[str, ...] = ("repaired",)) -> tuple[str, ...]:
    """Assumptions of R4, R5 and R7 that the run does not meet.

    Args:
        sets: with which confidence sets the theorem holds; R4 also with the likelihood set (companion G6).
    """
    config = subject.config
    found = _of_every_theorem(subject)
    if config.confidence not in sets:
        found.append(f"it is about the repaired sets, this run used the {config.confidence} ones")
    exact_pairs = ("uncertainty_and_bonus", "max_uncertainty") if subject.known else ("uncertainty_and_bonus",)
    if config.pair_rule not in exact_pairs:
        found.append(f"the pair rule {config.pair_rule} does not play the arg-max pair")
    if config.fit != "exact" and config.confidence != "likelihood":  # whose set needs no fitted weights
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
    return list(dict.fromkeys(of_the_run(subject.config, subject.world) + _of_the_search(subject)))


def of_the_run(config: RunConfig, world: World) -> list[str]:
    """What of a run's settings takes the guarantees away, whatever its confidence sets and the policies it searched."""
    found = caveats(config.but(confidence="repaired"), world)
    if world.demonstrations is not None:
        found.append("a file does not show whether its demonstrations come from the best policy")
    elif not world.expert.is_maximiser:
        found.append("the expert is not certified to be the best policy")
    elif world.expert.policy.ndim == 2:
        found.append("the expert is time-dependent, so that the best stationary policy may disagree with it")
    return found


def _of_the_search(subject: Subject) -> list[str]:
    """Why the policies searched may not be the whole of an offline set that contains the best stationary policy."""
    found = []
    if not bool(subject.results.search_way.isin(EXHAUSTIVE).all()):
        found.append("only a sample of the offline set was searched")
    if subject.config.radius == "stated-known" and not subject.known:
        found.append("the offline radius 'stated-known' is about known dynamics")
    return found
