"""A value knows what it is: terms, shares, vacuity, failure probability, words, and how a notebook shows it."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import pytest
from points import ANSWERS

import bridge_theory
from bridge_theory import (
    Setting,
    alpha_offline,
    offline_radius,
    offline_radius_closed,
    offline_radius_repaired,
    policy_error_stated,
    regret_known_stated,
    regret_trivial,
    transition_error_rate,
)
from bridge_theory.bound import Bound
from bridge_theory.bound import bound as make_bound
from bridge_theory.catalog import all_bounds, all_rates, by_group, by_label
from bridge_theory.core import Arithmetic, Value, bound, falls, least, total
from bridge_theory.errors import InputError, UndefinedInPaperError
from bridge_theory.parameters import PARAMETERS
from bridge_theory.solve import solve_for

_SETTING = Setting(S=5, A=4, H=8, n=2, delta="0.05", gamma_min="0.1")


def _mutant(**options: Any) -> dict[str, Any]:
    described = {"title": "mutant", "symbol": "x", "source": "test", "group": "offline", "status": "stated"}
    return {**described, "words": "at most {value}", **options}


def test_terms_add_up() -> None:
    value = offline_radius.value(_SETTING)
    assert list(value.terms) == ["policy", "transition", "transfer"]
    assert sum(value.shares.values()) == pytest.approx(1)
    assert value.dominant == "transfer"
    assert sum(term.middle for term in value.terms.values()) == pytest.approx(value.enclosure.middle)


def test_smallest_term_dominates_a_minimum() -> None:
    @bound(**_mutant())
    def pair(m: Arithmetic, *, R1: Value, R2: Value) -> Value:
        return least(first=R1, second=R2)

    value = pair.value(R1=3, R2=2)
    assert (value.dominant, value.shares, value.enclosure.upper) == ("second", {}, 2.0)


def test_plain_formulas_have_no_terms() -> None:
    value = alpha_offline.value(_SETTING)
    assert (value.terms, value.shares, value.dominant) == ({}, {}, None)
    assert (value.trivial, value.vacuous, value.failure.exact) == (None, None, 0)


def test_words_say_probability_value_and_assumptions() -> None:
    words = offline_radius.value(_SETTING).words
    claim = "As the paper states, with probability at least 0.95, the expert lies within Hellinger distance 1261"
    assert words.startswith(claim)
    assert "provided the expert is deterministic" in words
    assert words.endswith("This is no better than the trivial value.")
    sure = offline_radius_closed.value()
    assert sure.words.startswith("The expert lies within Hellinger distance 0")
    assert not sure.vacuous


def test_trivial_value_may_depend_on_the_setting() -> None:
    value = regret_known_stated.value(_SETTING, d=3, B=1, W="0.5", lam=1, T=1000)
    assert value.trivial.lower <= 1000 <= value.trivial.upper
    assert value.enclosure.lower > value.trivial.upper
    assert value.vacuous
    assert regret_trivial.value(B=1, W="0.5", T=1000).enclosure.upper == 1000


def test_failure_is_the_sum_of_what_is_spent_or_a_formula() -> None:
    spent = bridge_theory.regret_known_repaired.value(_SETTING, d=3, B=1, W="0.5", lam=1, T=1000).failure
    assert spent.lower <= 0.05 <= spent.upper

    @bound(**_mutant(spends=("delta",), failure=lambda m, delta: 2 * delta))
    def twice(m: Arithmetic, *, delta: Value) -> Value:
        return 1 / delta

    assert "probability at least 0.8," in twice.value(delta="0.1").words


@pytest.mark.parametrize(("trivial", "vacuous"), [(2, False), (0, None)])
def test_undecided_vacuity_is_none(trivial: int, vacuous: bool | None) -> None:
    @bound(**_mutant(trivial=trivial))
    def touching(m: Arithmetic, *, R1: Value) -> Value:
        return m.sqrt(m.number(2)) ** 2 - 2 + 0 * R1

    assert touching.value(R1=1).vacuous is vacuous


def test_conventions_of_a_setting() -> None:
    assert policy_error_stated.value(_SETTING).parameters["delta1"] == Fraction(1, 40)


def test_setting_is_an_immutable_mapping() -> None:
    assert Setting(**_SETTING) == _SETTING
    assert len({_SETTING, Setting(**_SETTING)}) == 1
    assert repr(_SETTING) == "Setting(S=5, A=4, H=8, n=2, delta=0.05, gamma_min=0.1)"
    assert len(_SETTING) == 6
    with pytest.raises(InputError, match=r"write setting.replace\(n=...\)"):
        _SETTING.n = 3
    with pytest.raises(AttributeError, match="this setting has no 'T'"):
        _ = _SETTING.T
    assert not hasattr(Setting(), "_anything")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"delta": 1.5}, r"delta = 1.5 is outside its domain; expected 0 < delta < 1 \(failure probability\)"),
        ({"S": "2.5"}, "S = 2.5 is outside its domain; expected an integer, S >= 1"),
        ({"S": Fraction(1, 3)}, "S = 1/3 is outside its domain"),
        ({"W": 0}, "W = 0 is outside its domain; expected W > 0"),
        ({"gamma_min": float("nan")}, "gamma_min = nan is not a finite number"),
        ({"S": "five"}, "S = 'five' is not a finite number"),
        ({"S": True}, "S = True is not a finite number"),
        ({"S": None}, "S = None is not a finite number"),
        ({"delta": "1/0"}, "delta = '1/0' is not a finite number"),
        ({"states": 5}, "'states' is not a parameter of any bound; the known ones are S, A, H"),
        ({"counts": 3}, "counts = 3 is one number; pass an array"),
        ({"counts": []}, "counts is empty"),
        ({"counts": [1, -1]}, "counts = -1 is outside its domain"),
    ],
)
def test_values_outside_the_domain_are_refused_in_one_sentence(values: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Setting(**values)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"delta": [0.5, 2]}, "delta = an array with entries outside the domain is outside its domain"),
        ({"delta": 2}, "delta = 2 is outside its domain"),
        ({"S": [1.5]}, "outside its domain"),
        ({"S": "x"}, "S = 'x' is not a finite number"),
        ({"S": object()}, "is not numeric"),
        ({"S": 1, "A": 1}, "alpha_offline needs delta; its parameters are S, A, delta"),
        ({"S": 1, "A": 1, "delta": 0.5, "n": 3}, "alpha_offline does not take n"),
    ],
)
def test_estimates_refuse_the_same_mistakes(values: dict[str, object], message: str) -> None:
    point = values if len(values) > 1 else {"S": 5, "A": 4, "delta": 0.5} | values
    with pytest.raises(InputError, match=message):
        alpha_offline.estimate(**point)


def test_exact_inputs_of_every_kind_agree() -> None:
    from decimal import Decimal

    import numpy as np

    kinds = ["0.05", Fraction(1, 20), Decimal("0.05")]
    assert len({alpha_offline.enclosure(S=5, A=np.int64(4), delta=kind).lower for kind in kinds}) == 1
    assert alpha_offline.estimate(S=5, A=4, delta=Fraction(1, 20)) == alpha_offline.estimate(S=5, A=4, delta="0.05")


def test_undefined_points_name_the_repaired_form() -> None:
    with pytest.raises(UndefinedInPaperError, match=r"the paper's text has no value there .*; use \w+ instead"):
        bridge_theory.xi.enclosure(S=5, A=4, H=8, eta=1, delta="0.05", N=1)
    with pytest.raises(UndefinedInPaperError):
        bridge_theory.xi.estimate(S=5, A=4, H=8, eta=1, delta=0.05, N=[5, 1])
    with pytest.raises(InputError, match="it requires a class of at least two elements"):
        bridge_theory.mle_finite_sharp.enclosure(n=5, delta="0.05", class_size=1)


def test_missing_parameters_of_a_value_are_named() -> None:
    with pytest.raises(InputError, match="offline_radius needs gamma_min; add them to the setting"):
        offline_radius.value(Setting(S=5, A=4, H=8, n=2, delta="0.05"))


def test_a_rate_has_no_certified_value() -> None:
    point = {"S": 5, "A": 4, "H": 8, "n": 1000, "delta": 0.05}
    assert transition_error_rate.estimate(**point) > 0
    with pytest.raises(InputError, match="is a rate without stated constants"):
        transition_error_rate.enclosure(**point)
    assert r"\tilde O" in transition_error_rate._repr_latex_()
    assert "rate transition_error_rate" in repr(transition_error_rate)


def test_decorating_checks_its_declarations() -> None:
    with pytest.raises(InputError, match="'budget' is not a parameter"):
        make_bound(**_mutant(spends=("budget",)))(lambda m, *, S: S)
    with pytest.raises(TypeError, match="declares a direction in"):
        make_bound(**_mutant(monotone={"n": falls("wrong")}))(lambda m, *, S: S)


def test_expressions_are_symbolic_and_accept_numbers() -> None:
    expression = alpha_offline.expression()
    assert {symbol.name for symbol in expression.free_symbols} == {"S", "A", "delta"}
    assert float(alpha_offline.expression(S=5, A=4, delta="0.05")) == pytest.approx(10.0749, abs=1e-4)
    assert r"|\mathcal{S}|" in alpha_offline.latex()
    with pytest.raises(InputError, match="does not take beta"):
        alpha_offline.expression(beta=3)
    assert r"\min_{k \geq 1}" in bridge_theory.transition_error_repaired.latex()
    assert "Sum" in str(bridge_theory.transition_kl_budget.expression())


def test_minimum_as_an_expression() -> None:
    import sympy

    from bridge_theory.arithmetic.symbols import MinimumOverIntegers

    k, n = sympy.Symbol("k", positive=True, integer=True), sympy.Symbol("n", positive=True)
    expression = MinimumOverIntegers(k + n / k, k)
    assert expression.free_symbols == {n}
    assert expression.subs(k, 3) == expression
    assert expression.evalf() == expression
    assert expression.subs(n, 10).evalf() == pytest.approx(min(j + 10 / j for j in range(1, 20)))


def test_notebook_representations() -> None:
    value = offline_radius.value(_SETTING)
    assert "<table>" in offline_radius._repr_html_()
    assert offline_radius._repr_latex_().startswith(r"$\mathrm{Radius} = ")
    assert "96.6%" in value._repr_html_()
    assert "vacuous" in value._repr_html_()
    assert r"\in [1261.00" in value._repr_latex_()
    assert "offline_radius(S=5" in repr(value)
    assert str(value).startswith("offline_radius = [1261.00")
    assert "<td>" in alpha_offline.value(_SETTING)._repr_html_()
    assert r"$|\mathcal{S}|$" in _SETTING._repr_html_()
    assert r"\delta = 0.05" in _SETTING._repr_latex_()
    solution = solve_for("n", offline_radius, 1, S=5, A=4, H=8, delta="0.05", gamma_min="0.1")
    assert "meets the target" in solution._repr_html_()
    assert "exceeds the target" in solution._repr_html_()
    assert "n = 150158" in solution._repr_latex_()
    never = solve_for("n", offline_radius, 0, S=5, A=4, H=8, delta="0.05", gamma_min="0.1")
    assert "for every" in never._repr_latex_()
    assert "No n up to" in never._repr_html_()


def test_catalog_finds_by_name_label_and_group() -> None:
    names = {formula.name for formula in by_label("thm:tabular_confidence_set")}
    assert names >= {"offline_radius", "alpha_offline", "beta_offline"}
    assert by_label("offline_radius") == (offline_radius,)
    assert "concentrability_sharp" in {formula.name for formula in by_label("T5")}
    assert offline_radius_repaired in by_label("T9")
    assert [formula.name for formula in by_label("G2")] == ["dual_certificate"]
    assert {formula.group for formula in by_label("G1'")} == {"answers"}
    with pytest.raises(InputError, match="closest: offline_radius"):
        by_label("offline_radios")
    with pytest.raises(InputError, match="no formula is called 'qqqq'"):
        by_label("qqqq")
    assert {b.group for b in all_bounds()} == {"offline", "online", "regret", "answers"}
    assert all(b in all_bounds() for b in by_group("regret"))
    assert not set(all_rates()) & set(all_bounds())


@pytest.mark.parametrize("formula", [*all_bounds(), *all_rates()], ids=lambda formula: formula.name)
def test_every_formula_documents_itself(formula: object) -> None:
    text = formula.__doc__
    for heading in ("Statement", "Source:", "Assumptions:", "Arguments:", "Returns", "Errors:", ">>>"):
        assert heading in text, f"{formula.name} lacks {heading}"
    assert all(name in PARAMETERS for name in formula.parameters)


def test_terms_compose_as_plain_values() -> None:
    @bound(**_mutant())
    def inner(m: Arithmetic, *, S: Value) -> Value:
        return total(one=S, two=2 * S)

    @bound(**_mutant())
    def outer(m: Arithmetic, *, S: Value) -> Value:
        return inner(m, S=S) + 1

    assert outer.enclosure(S=3).upper == 10


def test_words_round_bounds_up_and_probabilities_down() -> None:
    known = {"S": 5, "A": 4, "H": 8, "delta": "0.05", "gamma_min": "0.1"}
    just_above = offline_radius.value(n=150157, **known)
    assert 1 < just_above.enclosure.lower < 1.00001
    assert "Hellinger distance 1.00001 of" in just_above.words
    assert "probability at least 0.999999, " in offline_radius.value(n=9, **known | {"delta": "1e-9"}).words
    # 4 sqrt(log 2) = 3.330218...: a floor is rounded down
    floor = bridge_theory.elliptical_floor.value(W=1, d=1, T=1, gamma=10, diameter=1)
    assert "cannot be below 3.33021," in floor.words
    # exact rationals do not grow in the last digit
    failure = bridge_theory.containment_failure_known.value(delta_off="0.03", delta_w="0.02")
    assert failure.enclosure.exact == Fraction(1, 20)
    assert "probability at most 0.05," in failure.words
    assert regret_trivial.value(B="0.1", W="0.3", T=1000).enclosure.at_most == "60"


def test_a_value_beyond_float64_has_no_shares() -> None:
    @bound(**_mutant(trivial=1))
    def huge(m: Arithmetic, *, R1: Value) -> Value:
        return total(first=R1, second=m.exp(R1))

    value = huge.value(R1="1e300")
    assert (value.shares, value.dominant, value.vacuous) == ({}, None, True)
    assert value.words.startswith("As the paper states, at most inf")


@pytest.mark.parametrize(
    "name",
    ["gamma_known", "norm_relation", "norm_relation_sharp", "gamma_unknown", "gamma_unknown_repaired",
     "squared_true_bonus_sum_stated"],
)  # fmt: skip
def test_a_round_is_one_of_the_rounds(name: str) -> None:
    point = {
        "B": 1, "W": 1, "lam": 1, "d": 1, "T": 9, "delta": "0.05", "delta_w": "0.05", "delta_V": "0.05",
        "delta_P": "0.05", "bonus_square_sum": 1, "S": 5, "A": 4, "H": 8, "eta": 1, "epsilon": "0.1", "n": 1000,
        "gamma_min": "0.1", "S_reach": 5, "delta_martingale": "0.05",
    }  # fmt: skip
    formula = getattr(bridge_theory, name)
    known = {key: value for key, value in point.items() if key in formula.parameters}
    assert formula.enclosure(t=9, **known).lower > 0
    with pytest.raises(InputError, match="t = 10, T = 9: it requires t <= T"):
        formula.enclosure(t=10, **known)


def test_tables_of_different_lengths_are_refused() -> None:
    with pytest.raises(InputError, match="it requires one row error for each cell of the occupancy"):
        bridge_theory.trajectory_error_one_sided.enclosure(occupancy=[1, 1], row_errors=[0])
    with pytest.raises(InputError, match="it requires both occupancies of the same cells"):
        bridge_theory.trajectory_error_symmetrised.estimate(occupancy=[1], occupancy_hat=[1, 1], row_errors=[0])


def test_estimates_beyond_float64_are_refused() -> None:
    for huge in (10**400, Fraction(10**400, 3)):
        with pytest.raises(InputError, match="is beyond float64"):
            bridge_theory.kappa.estimate(B=huge, W=1)


def test_exact_values_beyond_float64_keep_their_size_and_their_order() -> None:
    assert regret_trivial.value(B="1e200", W="1e200", T=1).enclosure.at_most == "2e+400"
    assert "at most 2e-400," in regret_trivial.value(B="1e-400", W=1, T=1).words
    point = {"lam": 8, "d": 1, "K": 1, "delta_w": "0.025", "delta_F": "0.025", "B": "1e-100", "W": "1e250"}
    below = bridge_theory.regret_known_repaired.value(**point, T=10**250, diameter="1e-100", Delta_n="1e-60")
    assert below.enclosure.upper == below.trivial.upper == math.inf  # 2e340 and 2e400
    assert below.vacuous is False
    equal = bridge_theory.regret_known_repaired.value(**point, T=1, diameter="2e-100", Delta_n=1)
    assert equal.vacuous is True
    zero = bridge_theory.mle_finite_stated.value(n=1, delta="0.05", class_size=5, chi2=7)  # 6 log(1/2) + 2 log(8)
    assert (zero.enclosure.narrow, zero.vacuous) == (False, False)


def test_a_failure_beyond_float64_certifies_nothing() -> None:
    point = {"S": 5, "A": 4, "H": 8, "n": 1, "T": 10, "K": 1, "Delta_n": 0, "delta_P": "0.05", "delta_M": "0.05"}
    value = bridge_theory.radius_sum_covered.value(S_reach=10**400, gamma_min="0.1", **point)
    assert value.words.startswith("Nothing is certified, for its events may fail with a total probability of ")
    assert not value.certified


@pytest.mark.parametrize("formula", by_group("answers"), ids=lambda formula: formula.name)
def test_every_formula_about_answers_says_its_value_in_words(formula: Bound) -> None:
    setting = {"d": 2, "t": 40, "B": 1, "W": 2, "lam": "0.5", "delta": "0.05", "delta_phi": "0.05"} | ANSWERS
    value = formula.value(**{name: setting[name] for name in formula.parameters})
    assert value.enclosure.narrow
    shown = {value.enclosure.at_most, value.enclosure.at_least}
    assert any(number in value.words for number in shown)
    spent = "With probability at least 0.95, " if formula.spends else ""
    assert value.words.startswith(spent)
