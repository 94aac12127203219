"""The definitions that the kernel-checked theorems speak of are generated from the package's own Python formulas."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from bridge_theory.arithmetic.coq_terms import CoqTerms, Term, natural, number
from bridge_theory.catalog import FORMULAS
from bridge_theory.core import Arithmetic, Value
from bridge_theory.formula import Formula
from proofs_checks.kernel import formulas

X, Y = Term("x"), Term("y")


def definition(formula: Formula) -> str:
    terms = CoqTerms()
    terms.define(formula)
    return terms.definitions[formula.name]


def test_the_stored_definitions_are_those_of_the_python_formulas() -> None:
    assert formulas.FILE.read_text(encoding="utf-8") == formulas.source(), (
        "proofs_checks/kernel/Formulas.v must be what the formulas give; run python -m proofs_checks.kernel.formulas"
    )


def test_every_formula_has_one_definition() -> None:
    text = formulas.source()
    assert {name: text.count(f"\nDefinition {name} ") for name in FORMULAS} == dict.fromkeys(FORMULAS, 1)


def test_a_changed_formula_changes_its_definition() -> None:
    def changed(m: Arithmetic, *, S: Value, A: Value, delta: Value) -> Value:
        return m.sqrt(5 * S * m.log(2 * A / delta))

    alpha = FORMULAS["alpha_offline"]
    stored = definition(alpha)
    changed.__name__ = alpha.name
    assert definition(replace(alpha, function=changed)) == stored.replace("(4 *", "(5 *")
    assert stored != stored.replace("(4 *", "(5 *")


@pytest.mark.parametrize(
    ("term", "text"),
    [
        (X - (Y - 1), "x - (y - 1)"),
        (X - Y - 1, "x - y - 1"),
        (X / (Y * 2), "x / (y * 2)"),
        (X / Y * 2, "x / y * 2"),
        ((X + 1) * Y, "(x + 1) * y"),
        ((X * Y) ** 2, "(x * y) ^ 2"),
        (X * Y**2, "x * y ^ 2"),
        ((X**2) ** 3, "(x ^ 2) ^ 3"),
        (-X * Y, "(- x) * y"),
        (-(X + Y), "(- (x + y))"),
        (2 / X - number(Fraction(1, 3)), "2 / x - 1 / 3"),
        (X * Fraction(1, 3), "x * (1 / 3)"),
        (natural("n") ** 2 / natural("n"), "INR n ^ 2 / INR n"),
        (CoqTerms().log(natural("n") + 1), "ln (INR n + 1)"),
        (CoqTerms().power(1 - X, natural("n")), "(1 - x) ^ n"),
        (CoqTerms().min(X, Y, 1), "Rmin (Rmin x y) 1"),
    ],
)  # fmt: skip
def test_a_term_means_what_python_computes(term: Term, text: str) -> None:
    assert term.text == text


@pytest.mark.parametrize("wrong", [0.5, "x", None])
def test_a_number_that_is_not_exact_is_refused(wrong: object) -> None:
    with pytest.raises(TypeError, match="exact numbers"):
        X + wrong  # type: ignore[operator]


def test_an_exponent_that_is_not_a_natural_variable_is_refused() -> None:
    with pytest.raises(TypeError, match="natural variable"):
        CoqTerms().power(X, X)
