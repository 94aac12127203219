"""Theorems checked by Coq's kernel, the definitions they speak of, and the gate through which they count.

The definitions of ``Formulas.v`` are generated from the Python formulas: ``policy_error_repaired S A n delta1`` is the
formula of that name, with integers as natural numbers. ``Arithmetic.v`` has what they use beyond Coq's real numbers,
with lemmas to reason about it: ``least_at_most`` and ``least_at_least`` for a minimum over k = 1, 2, ...,
``log_binomial_INR`` for a binomial coefficient, ``if_at_most_yes`` and ``if_at_most_no`` for a branch.
"""
