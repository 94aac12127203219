"""Theorems checked by Coq's kernel, the definitions they speak of, and the gate through which they count.

The definitions of ``Formulas.v`` are generated from the Python formulas: ``policy_error_repaired S A n delta1`` is the
formula of that name, with integers as natural numbers. ``Arithmetic.v`` has what they use beyond Coq's real numbers,
with lemmas to reason about it: ``least_at_most`` and ``least_at_least`` for a minimum over k = 1, 2, ...,
``log_binomial_INR`` for a binomial coefficient, ``if_at_most_yes`` and ``if_at_most_no`` for a branch.

To add a theorem: prove it and its instance, list it in ``theorems.json``, run ``python -m proofs_checks.kernel.gate
--record``. The gate accepts the commands that ``sentences.py`` lists and the four axioms of ``build.py``. An instance
has no premises and applies its theorem to concrete data. A wrong variant in ``mutants.json`` changes one text of the
statement, as Coq prints it, and says by which tactics the negation follows from its hypothesis ``claim``.
"""
