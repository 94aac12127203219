"""No printed sentence is false more often than it admits: every bound about a probability, in simulated data sets.

Values are those that a user gets who gives the sizes and leaves the rest to be filled in. Data come from deterministic
and from stochastic experts, wherever the printed assumptions allow one.
"""

from __future__ import annotations

import importlib
import inspect
from fractions import Fraction

import numpy as np
import offline_sentences
import online_sentences
import pytest
from printed_sentences import DETERMINISTIC, FALSE_ALARM, STOCHASTIC, VERDICTS, Tally, experts_of, is_about_probability
from printed_sentences import tallied as _tallied

from bridge_theory import Setting, missing_mass_expected, paper, transition_error_closed_form
from bridge_theory.bound import Bound
from bridge_theory.catalog import FORMULAS, all_bounds

SIMULATIONS = (*offline_sentences.SIMULATIONS, *online_sentences.SIMULATIONS)
TRIALS = 60

THE_PAPER_ALONE = {
    "alpha_dT": "refuted in early rounds, and cited",
    "beta_t": "its proof takes kappa on feature differences, where it is too small; beta_repaired is simulated",
    "bonus_sum_stated": "refuted",
    "confidence_radius": "open, with the kappa of beta_t; confidence_radius_repaired is simulated",
    "feature_difference_sum": "refuted",
    "gamma_known": "rests on alpha_dT",
    "gamma_true_bonus": "rests on alpha_dT",
    "gamma_unknown": "rests on alpha_dT",
    "mle_covering_stated": "refuted: as typeset it may be negative",
    "mle_finite_stated": "refuted: as typeset it may be negative",
    "played_bonus_sum_stated": "open",
    "regret_known_from_sum": "rests on gamma_known",
    "regret_known_stated": "refuted",
    "regret_unknown_squared": "rests on gamma_unknown",
    "regret_unknown_stated": "refuted by a sign",
    "squared_bonus_sum_stated": "refuted",
    "squared_true_bonus_sum_stated": "open",
}
"""Statements of the paper that nothing here stands for: their words say that it is the paper that states them."""

IN_THE_LEDGER = {
    "gamma_unknown_repaired": "C.6",
    "norm_relation": "R9",
    "norm_relation_sharp": "R9",
    "radius_sum": "R7",
    "radius_sum_covered": "R7",
    "regret_known_apriori": "R5",
    "regret_known_log": "R5",
    "regret_known_repaired": "R5",
    "regret_unknown_covered": "R7",
    "regret_unknown_repaired": "R7",
    "xi_repaired": "C.8",
}
"""Statements above the trivial value at every size that can be simulated, by the repair whose evidence they rest on."""

BY_A_CHECK = {
    "empirical_from_true_bonus": "proofs_checks.online.checks.bonus.relation_of_bonuses",
    "empirical_from_true_bonus_sharp": "proofs_checks.online.checks.bonus.relation_of_bonuses",
}
"""Implications between two bonuses, proved by a check of the ledger."""

PARTS = {"xi": "empirical_bonus", "xi_bar": "expected_bonus"}
"""One cell's share of a bonus, and the simulated bonus that adds the shares up."""

SHARES = ("net_delta", "online_bonus_delta", "step_bonus_delta")
"""How the paper divides its failure probability: numbers, about no event."""

ON_AVERAGE = ("missing_mass_expected",)
"""Computed exactly in a test of its own."""

ABOUT_PROBABILITY = {bound.name: bound for bound in all_bounds() if is_about_probability(bound)}
ABOUT_ANSWERS = tuple(name for name, bound in ABOUT_PROBABILITY.items() if bound.group == "answers")
"""Statements about certified answers: each rests on the ledger's claim of its own source, whose checks simulate it."""

_NOT_SIMULATED = {*THE_PAPER_ALONE, *IN_THE_LEDGER, *BY_A_CHECK, *PARTS, *SHARES, *ON_AVERAGE, *ABOUT_ANSWERS}


@pytest.fixture(scope="module")
def tallies() -> dict[tuple[str, str], Tally]:
    found = {}
    for place, kind in enumerate((DETERMINISTIC, STOCHASTIC)):
        streams = np.random.default_rng([20251, place]).spawn(TRIALS)
        one = _tallied(simulate(rng, kind) for rng in streams for simulate in SIMULATIONS)
        found |= {(name, kind): tally for name, tally in one.items()}
    return found


def test_every_bound_about_a_probability_is_simulated_or_says_why_not(tallies) -> None:
    simulated = {name for name, _ in tallies}
    assert set(ABOUT_PROBABILITY) - simulated == _NOT_SIMULATED, "simulate the bound, or list it with what it rests on"
    assert not simulated & _NOT_SIMULATED


def test_every_kind_of_expert_that_the_words_allow_is_simulated(tallies) -> None:
    wanted = {(name, kind) for name in ABOUT_PROBABILITY if name not in _NOT_SIMULATED for kind in _kinds(name)}
    assert wanted <= set(tallies)
    assert not [(name, kind) for name, kind in tallies if kind not in _kinds(name)]


def _kinds(name: str) -> tuple[str, ...]:
    bound = FORMULAS[name]
    assert isinstance(bound, Bound)
    return experts_of(bound)


def test_no_printed_sentence_is_false_more_often_than_it_admits(tallies) -> None:
    """The verdicts on true sentences together go wrong with a probability below 1e-6, by exact binomial tails."""
    assert len(tallies) <= VERDICTS
    too_often = {key: (t.false, t.trials, float(t.claimed)) for key, t in tallies.items() if t.false > t.allowed}
    assert too_often == {}


def test_a_bound_that_is_too_small_would_be_noticed(tallies) -> None:
    """Each simulation would catch a bound of zero; events, whose probability is bounded, are counted themselves."""
    events = {"exact_recovery_failure", "coverage_failure", "containment_failure_known", "containment_failure_unknown"}
    weak = {
        name
        for name in {name for name, _ in tallies} - events
        if all(t.positive <= t.allowed for (other, _), t in tallies.items() if other == name)
    }
    assert weak <= {"offline_radius_closed"}, weak  # it is exactly zero


def test_rows_of_a_deterministic_expert_would_be_noticed() -> None:
    """What used to be filled in: S rows, however stochastic the expert; then .0389 is exceeded in every data set."""
    streams = np.random.default_rng(20251).spawn(TRIALS)
    draws = [list(offline_sentences.many_actions(rng, STOCHASTIC)) for rng in streams]
    once = [[s for s in sentences if s.bound == "transition_error_closed_form"] for d in draws for sentences in d]
    truths = [sentence.truth for sentences in once for sentence in sentences]
    size = {"S": 2, "A": 1000, "H": 1, "n": 1000, "delta": "0.05"}
    old = transition_error_closed_form.value(Setting(**size, rows=2))
    assert old.enclosure.at_most == "0.0388739"
    assert min(truths) > 4 * old.enclosure.upper
    tally = Tally(trials=len(truths), false=sum(t > old.enclosure.upper for t in truths), claimed=Fraction(1, 20))
    assert tally.false == tally.trials > tally.allowed
    assert transition_error_closed_form.value(Setting(**size)).vacuous


def test_the_missing_mass_is_as_small_on_average_as_it_says() -> None:
    """The mean is exact, sum q (1 - q)^n; it is largest where every state has the probability 1 / (n + 1)."""
    for S, n in ((2, 1), (5, 10), (30, 200)):
        limit = missing_mass_expected.value(S=S, n=n).enclosure.upper
        rows = np.vstack([np.random.default_rng(S).dirichlet(np.full(S, 0.3), size=200), _hardest(S, n)])
        means = (rows * (1 - rows) ** n).sum(axis=1)
        assert (means <= limit + 1e-12).all()
        assert means[-1] > limit * (S - 1) / S - 1e-12


def _hardest(S: int, n: int) -> np.ndarray:
    q = np.full(S, 1 / (n + 1))
    q[0] = max(0.0, 1 - q[1:].sum())
    return q / q.sum()


@pytest.mark.parametrize("name", THE_PAPER_ALONE)
def test_what_only_the_paper_states_is_said_to_be_the_papers(name: str) -> None:
    bound = ABOUT_PROBABILITY[name]
    assert bound.status == "stated"
    assert bound.source in paper.entries() or bound.source.startswith("audit ")


@pytest.mark.parametrize(("name", "repair"), IN_THE_LEDGER.items())
def test_what_rests_on_the_ledger_has_evidence_there(name: str, repair: str) -> None:
    from proofs_checks.ledger import repairs

    (found,) = {id(item): item for item in repairs() if item.name == repair}.values()
    assert name in found.formulas
    assert any(item.check is not None for item in found.evidence)


@pytest.mark.parametrize(("name", "check"), BY_A_CHECK.items())
def test_what_rests_on_a_check_is_named_by_it(name: str, check: str) -> None:
    from proofs_checks.ledger import all_evidence, claims

    module, function = check.rsplit(".", 1)
    checker = getattr(importlib.import_module(module), function)
    assert f"theory.{name}" in inspect.getsource(checker)
    assert any(item.check is checker for claim in claims() for item in all_evidence(claim))


@pytest.mark.parametrize("name", ABOUT_ANSWERS)
def test_what_is_said_about_answers_rests_on_a_claim_that_holds(name: str) -> None:
    from proofs_checks.ledger import all_evidence, claims

    own = [claim for claim in claims() if claim.label == FORMULAS[name].source]
    assert own
    assert all(claim.verdict.startswith(("true", "cited")) for claim in own)
    assert any(item.check is not None for claim in own for item in all_evidence(claim)) or name == "fewest_answers"


@pytest.mark.parametrize(("part", "whole"), PARTS.items())
def test_parts_are_added_up_by_a_simulated_bound(part: str, whole: str, tallies) -> None:
    bound = FORMULAS[whole]
    given = {"S": 2, "A": 2, "H": 3, "eta": 1, "delta": "0.05", "epsilon": "0.1"}
    share = FORMULAS[part].estimate(N=40, **{k: v for k, v in given.items() if k in FORMULAS[part].parameters})
    together = bound.estimate(
        occupancy=[1.5, 0.5], counts=[40, 40], **{k: v for k, v in given.items() if k in bound.parameters}
    )
    assert together == pytest.approx(2 * share)
    assert whole in {name for name, _ in tallies}


@pytest.mark.parametrize("name", SHARES)
def test_shares_of_a_failure_probability_are_about_no_event(name: str) -> None:
    bound = ABOUT_PROBABILITY[name]
    assert (bound.spends, bound.failure, bound.assumptions, bound.status) == ((), None, (), "stated")


def test_every_stated_sentence_names_the_paper() -> None:
    point = {
        "S": 4, "A": 2, "H": 3, "n": 50, "T": 20, "t": 5, "d": 2, "B": 1, "W": 1, "lam": 1, "delta": "0.05", "N": 40,
        "gamma_min": "0.25", "epsilon": "0.1", "eta": 1, "R": "0.1", "R1": "0.1", "R2": "0.1", "C": 2, "chi2": 0,
        "class_size": 9, "log_covering": 3, "norm_sum": 1, "bonus_sum": 1, "bonus_square_sum": 1, "potential": 1,
        "true_bonus": 1, "occupancy": [1, 1], "counts": [40, 40],
    }  # fmt: skip
    for bound in all_bounds():
        if bound.status == "stated":
            value = bound.value(Setting(**{k: v for k, v in point.items() if k in bound.parameters} | _bases(point)))
            whose = "As the paper would state after audit " if "audit" in bound.source else "As the paper states, "
            assert value.words.startswith(whose), bound.name


def _bases(point: dict[str, object]) -> dict[str, object]:
    return {key: point[key] for key in ("S", "A", "B", "T", "delta")}


def test_a_false_alarm_is_improbable() -> None:
    assert Fraction(1, 10**6) >= VERDICTS * (FALSE_ALARM / VERDICTS)
