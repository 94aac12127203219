"""An engine of the ledger proves, refutes or admits that it cannot decide; it never passes by accident."""

from fractions import Fraction
from math import comb

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from bridge_theory.arithmetic import flint_balls
from bridge_theory.catalog import FORMULAS, all_bounds
from bridge_theory.errors import InputError
from proofs_checks.answers.checks import transcription as answers
from proofs_checks.balls import prove_positive
from proofs_checks.context import Context
from proofs_checks.coverage import FALSE_ALARM, Coverage, cumulative
from proofs_checks.ledger import claims
from proofs_checks.online.checks import directions, environments
from proofs_checks.online.checks.transcription import ONLINE
from proofs_checks.online.checks.transcription_regret import REGRET
from proofs_checks.slopes import SLOPES, Slope, lifted, prove_monotone
from proofs_checks.smt import prove, reals
from proofs_checks.symbolic import identity


@given(st.integers(1, 30), st.integers(0, 30), st.fractions(0, 1, max_denominator=20))
def test_binomial_tails_are_exact(trials, failures, chance):
    terms = (comb(trials, k) * chance**k * (1 - chance) ** (trials - k) for k in range(min(failures, trials) + 1))
    assert cumulative(trials, failures, chance) == sum(terms, Fraction(0))


@given(st.integers(20, 300), st.sampled_from([Fraction(1, 20), Fraction(1, 10), Fraction(1, 4)]))
def test_correct_statements_pass_except_with_tiny_probability(trials, claimed):
    seen = Coverage(claimed, trials, 0)
    assert seen.false_alarm < FALSE_ALARM
    assert 1 - cumulative(trials, seen.threshold - 1, claimed) >= FALSE_ALARM
    assert not Coverage(claimed, trials, seen.threshold + 1).passes
    assert seen.power(claimed) == pytest.approx(float(seen.false_alarm))
    assert seen.power(Fraction(1)) == 1


@given(st.integers(1, 60), st.data())
def test_confidence_limits_enclose_the_frequency_and_err_with_the_stated_probability(trials, data):
    failures = data.draw(st.integers(0, trials))
    seen = Coverage(Fraction(1, 2), trials, failures)
    assert seen.lower <= Fraction(failures, trials) <= seen.upper
    if failures < trials:
        assert cumulative(trials, failures, seen.upper) <= FALSE_ALARM
    if failures:
        assert 1 - cumulative(trials, failures - 1, seen.lower) <= FALSE_ALARM


def test_contradictory_hypotheses_prove_nothing_and_neither_does_a_timeout():
    x, y, z = reals("x y z")
    assert "nothing is proved" in prove("vacuous", [x > 1, x < 0], y > y).failures[0]
    hard = x**7 * y + y**7 * z + z**7 * x + x * y * z
    assert not prove("hard", [x > 0, y > 0, z > 0, hard * hard < 1], hard + x**9 < y**5, seconds=0.001).holds


def test_an_inequality_with_a_zero_is_not_proved_and_a_violation_is_located():
    touching = prove_positive("square", lambda x: (x - flint_balls.ball(Fraction(1, 3))) ** 2, {"x": (0, 1)}, most=200)
    assert not touching.holds
    assert "undecided" in touching.failures[0]
    beyond = prove_positive("line", lambda x, y: x - y, {"x": (2, 3), "y": (0, "5/2")})
    assert "not positive" in beyond.failures[0]
    assert prove_positive("line", lambda x, y: x - y, {"x": (2, 3), "y": (0, "19/10")}).holds
    assert prove_positive("zero", lambda x: 0 * x, {"x": (0, 1)}, weakly=True).holds


def test_identities_that_fail_only_somewhere_are_rejected():
    x = sympy.Symbol("x", real=True)
    assert not identity("absolute value", sympy.Abs(x - 1), x - 1).holds
    assert "cannot reduce" in identity("absolute value", sympy.Abs(x), sympy.Max(x, -x)).failures[0]


DIFFERENTIABLE = [
    (bound, name) for group in ("offline", "online", "regret") for bound, name in directions.declared(group)
]


@pytest.mark.parametrize(("bound", "name"), DIFFERENTIABLE, ids=lambda item: getattr(item, "name", item))
def test_slopes_enclose_difference_quotients(bound, name):
    point = {key: float(Fraction(low)) for key, (low, _) in directions._box(bound, "").items()}
    exact = {key: Fraction(low) for key, (low, _) in directions._box(bound, "").items()}
    with flint_balls.working_precision(200):
        balls = {k: Slope(flint_balls.ball(v), (flint_balls.ball(int(k == name)),)) for k, v in exact.items()}
        slopes = [float(slope) for slope in lifted(bound(SLOPES, **balls)).slopes]
        step = exact[name] / 10**20
        ends = [{k: flint_balls.ball(v) for k, v in {**exact, name: exact[name] + s * step}.items()} for s in (1, -1)]
        from bridge_theory.arithmetic.balls import BALLS

        quotient = float((bound(BALLS, **ends[0]) - bound(BALLS, **ends[1])) / flint_balls.ball(2 * step))
    assert any(slope == pytest.approx(quotient, rel=1e-9, abs=1e-12) for slope in slopes), (point, slopes, quotient)


def test_a_direction_needs_all_parameters():
    bound = next(bound for bound in all_bounds() if bound.name == "reach_size")
    with pytest.raises(InputError, match="gamma_min"):
        prove_monotone(bound, "S", {"S": (1, 2), "A": (1, 1), "H": (1, 1)}, "rises")


def test_every_online_formula_is_transcribed():
    tables = {"empirical_bonus", "expected_bonus", "transition_bonus"}
    formulas = {name for name, formula in FORMULAS.items() if formula.group in ("online", "regret")}
    assert formulas == {*ONLINE, *REGRET, *tables}


def test_every_formula_about_answers_is_transcribed_and_is_evidence_of_a_claim():
    formulas = {name for name, formula in FORMULAS.items() if formula.group == "answers"}
    transcribed = [item for claim in claims() for item in claim.evidence if item.check is answers.formulas]
    assert formulas == set(answers.ANSWERS) == {name for item in transcribed for name in item.arguments["names"]}


def test_formulas_left_out_of_the_directions_exist():
    assert set(directions.LEFT_OUT) <= set(FORMULAS)


@pytest.mark.parametrize("group", ["offline", "online", "regret"])
def test_all_declared_directions_are_proved(group):
    outcome = directions.directions(Context(quick=False), group=group)
    assert outcome.holds, outcome.failures


@pytest.mark.parametrize("known", [True, False], ids=["known", "unknown"])
@pytest.mark.parametrize("environment", ["dense garnet", "chain", "starmdp", "gridworld", "frozenlake"])
def test_the_best_policy_is_kept_and_the_regret_is_bounded(environment, known):
    outcome = environments.good_runs(Context(quick=True, name="tests"), environment=environment, known=known)
    assert outcome.holds, outcome.failures
    assert "covered" in outcome.details


@pytest.mark.parametrize("environment", ["garnet", "chain", "starmdp", "gridworld", "frozenlake"])
def test_the_offline_set_contains_the_expert_and_is_narrow(environment):
    outcome = environments.offline_geometry(Context(quick=True, name="tests"), environment=environment)
    assert outcome.holds, outcome.failures
    assert np.all(outcome.decisions >= 8)
