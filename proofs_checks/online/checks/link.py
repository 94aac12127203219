"""The Bradley-Terry link and the curvature constants."""

from __future__ import annotations

from proofs_checks.outcome import Outcome, together


def inverse_slope(*, constant: int = 2, radius: int = 1) -> Outcome:
    """1/sigma'(x) = 2 + 2 cosh x, and both kappas of ``bridge_theory`` are its values at BW and 2BW."""
    import sympy

    import bridge_theory as theory
    from bridge_theory.symbolic import symbol_for
    from proofs_checks.symbolic import identity

    x = sympy.Symbol("x", real=True)
    slope = sympy.diff(1 / (1 + sympy.exp(-x)), x)
    at = radius * symbol_for("B") * symbol_for("W")
    return together(
        identity("1/sigma'", 1 / slope, constant + 2 * sympy.cosh(x)),
        identity("kappa", theory.kappa.expression(), (1 / slope).subs(x, at)),
        identity("kappa of differences", theory.kappa_differences.expression(), (1 / slope).subs(x, 2 * at)),
    )


def largest_at_the_end(*, sign: int = 1) -> Outcome:
    """2 + 2 cosh rises with |x|: with u = e^a > v = e^c >= 1, cosh a - cosh c = (u - v)(1 - 1/(uv))/2 > 0."""
    import sympy

    from proofs_checks.smt import prove, reals
    from proofs_checks.symbolic import identity

    a, c = sympy.symbols("a c", real=True)
    in_exponentials = (sympy.exp(a) - sympy.exp(c)) * (1 - sympy.exp(-a - c)) / 2
    u, v = reals("u v")
    return together(
        identity("cosh is even", sympy.cosh(-a), sympy.cosh(a)),
        identity("cosh a - cosh c", sympy.cosh(a) - sympy.cosh(c), sign * in_exponentials),
        prove("it is positive", [u > v, v >= 1], sign * (u - v) * (u * v - 1) > 0),
    )


def nonnegative_difference(*, share: int = 1) -> Outcome:
    """||a - b||^2 <= ||a||^2 + ||b||^2 for a, b >= 0, by coordinate, attained; and kappa at sqrt(2) B."""
    import sympy

    import bridge_theory as theory
    from bridge_theory.symbolic import symbol_for
    from proofs_checks.smt import prove, reals
    from proofs_checks.symbolic import identity

    a, b = reals("a b")
    B, W = symbol_for("B"), symbol_for("W")
    first, second = sympy.Matrix([B, 0]), sympy.Matrix([0, B])
    return together(
        prove("one coordinate", [a >= 0, b >= 0], (a - b) * (a - b) <= share * a * a + b * b),
        identity("attained by B e_1 and B e_2", (first - second).dot(first - second), (1 + share) * B**2),
        identity("kappa", theory.kappa_nonnegative.expression(), 2 + 2 * sympy.cosh(sympy.sqrt(2) * B * W)),
    )


def square_dominates(*, constant: int = 4) -> Outcome:
    """kappa^2 - kappa_2 = 4 + 8 cosh(BW) > 0."""
    import sympy

    from proofs_checks.symbolic import identity

    x = sympy.Symbol("x", real=True)
    difference = (2 + 2 * sympy.cosh(x)) ** 2 - (2 + 2 * sympy.cosh(2 * x))
    return identity("kappa^2 - kappa_2", difference, constant + 8 * sympy.cosh(x))


def regret_is_linear(*, weight: int = 2) -> Outcome:
    """Both forms of the pseudo-regret agree in every round, hence for any number of rounds."""
    import sympy

    from proofs_checks.symbolic import identity

    best, one, two, w = sympy.symbols("best one two w", real=True)
    return identity("one round", (weight * best - one - two) * w / 2, (2 * best * w - one * w - two * w) / 2)
