"""SymPy symbols and LaTeX for the parameters; loaded only when an expression is asked for."""

from __future__ import annotations

from typing import Any

import sympy

from bridge_theory.parameters import PARAMETERS, parameter


def symbol_for(name: str) -> Any:
    """The SymPy symbol (or indexed base, for an array) of a parameter, with the sign its domain implies.

    Source: the parameter table. Errors: ``InputError`` for an unknown name.

    >>> symbol_for("S").is_integer, symbol_for("delta").is_positive
    (True, True)
    """
    row = parameter(name)
    if row.array:
        return sympy.IndexedBase(name, nonnegative=True, integer=row.domain.integer or None)
    positive = row.domain.low > 0 or (row.domain.low == 0 and row.domain.opens[0])
    sign = {"positive": True} if positive else {"nonnegative": True} if row.domain.low == 0 else {"real": True}
    return sympy.Symbol(name, **sign, **({"integer": True} if row.domain.integer else {}))


def latex_of(expression: Any) -> str:
    r"""LaTeX of an expression, with the paper's symbols for the parameters.

    >>> latex_of(symbol_for("gamma_min") / 2)
    '\\frac{\\gamma_{\\min}}{2}'
    """
    names = {symbol_for(name): row.latex for name, row in PARAMETERS.items() if not row.array}
    bases = {symbol_for(name): row.latex for name, row in PARAMETERS.items() if row.array}
    return str(sympy.latex(expression, symbol_names=names | bases))
