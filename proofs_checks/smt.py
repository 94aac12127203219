"""Z3 queries over the reals, small and named: ``unsat`` of the negation is a proof, anything else is a failure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import z3

from proofs_checks.outcome import Outcome


def reals(names: str) -> list[Any]:
    """Real variables, by their names separated by spaces.

    >>> [str(x) for x in reals("u v")]
    ['u', 'v']
    """
    return [z3.Real(name) for name in names.split()]


def prove(name: str, hypotheses: Sequence[Any], conclusion: Any, seconds: float = 10) -> Outcome:
    """Whether the conclusion follows from the hypotheses for all real values of the variables.

    The hypotheses must have a solution, otherwise they would imply everything; a query that times out proves nothing.

    >>> x, = reals("x")
    >>> prove("squares", [x > 1], x * x > x).details
    'squares: unsat'
    >>> prove("squares", [x > 0], x * x > x).holds
    False
    """
    possible = _solve(hypotheses, seconds)[0]
    if possible != z3.sat:
        return Outcome(1, (f"{name}: the hypotheses alone are {possible}, so that nothing is proved",))
    answer, model = _solve([*hypotheses, z3.Not(conclusion)], seconds)
    if answer == z3.unsat:
        return Outcome(1, details=f"{name}: unsat")
    if answer == z3.sat:
        point = ", ".join(f"{variable} = {model[variable]}" for variable in sorted(model, key=str))
        return Outcome(1, (f"{name}: false at {point}",))
    return Outcome(1, (f"{name}: undecided after {seconds:g} s",))


def _solve(formulas: Sequence[Any], seconds: float) -> tuple[Any, Any]:
    solver = z3.SolverFor("QF_NRA")
    solver.set("timeout", int(1000 * seconds))
    solver.add(*formulas)
    answer = solver.check()
    return answer, solver.model() if answer == z3.sat else None
