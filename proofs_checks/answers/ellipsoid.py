"""G5: an ellipsoid around the likelihood set."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.answers.checks import ellipsoid, quadratics
from proofs_checks.answers.evidence import text
from proofs_checks.claim import Claim, link
from proofs_checks.evidence import exact, mutant, proved_step

CLAIMS = (
    Claim(
        label="companion G5",
        name="ellipsoid around the likelihood set",
        topic="answers",
        verdict="true",
        statement=r"For any $\hat w$, $\eta \ge 0$, $z_s = \langle x_s, \hat w\rangle$ and $r_s \ge |\langle x_s, w - "
        r"\hat w\rangle|$ over the current enclosure, let $c_s = \sigma'(z_s)2(e^{-r_s} + r_s - 1)/r_s^2$, $A = \sum "
        r"c_sx_sx_s^\top + \eta I$ positive definite, $u = -\nabla\ell_t(\hat w) + \eta\hat w$, $b = \ell_t(\hat w) - "
        r"Q_t + \log(1/\delta)$. Then $C_t$ within the ball lies in $\lVert w - (\hat w - A^{-1}u)\rVert_A^2 \le 2b + "
        r"\eta(W^2 - \lVert\hat w\rVert^2) + \lVert u\rVert_{A^{-1}}^2$.",
        because="The curvature of the loss falls at most exponentially with the distance; summed up, the set lies in a "
        "quadratic's sublevel set.",
        links=(
            link("the loss lies above a quadratic within the reach", "curvature_inequality"),
            link("the factor falls with the reach, so that a larger reach is safe", "factor_falls"),
            link("the square is completed", "completed_square"),
            link("the sum over the answers, and repeated passes keep the enclosure"),
        ),
        evidence=(
            proved_step(
                r"$f(z + y) - f(z) - f'(z)y - \sigma'(z)(e^{-|y|} + |y| - 1)$ vanishes to first order at $y = 0$ and "
                r"is convex on either side, for all real $z$ (SymPy, Z3)",
                quadratics.curvature_inequality,
                mutant("the curvature may not fall", power=1),
            ),
            proved_step(
                r"$2(e^{-r} + r - 1)/r^2$ falls, and bridge_theory computes it (SymPy, Z3)",
                quadratics.factor_falls,
                mutant("the other sign", sign=-1),
            ),
            proved_step(
                "both sides of the completed square are the same, with the formula of bridge_theory (SymPy)",
                ellipsoid.completed_square,
                mutant("without the factor 2", factor=1),
            ),
            exact(
                "the inequality at 936 rational points (balls)",
                quadratics.curvature_at_points,
                mutant("a quarter more curvature", share=Fraction(5, 4)),
            ),
            exact(
                "points at the edge of random sets lie inside the ellipsoid of four passes (balls)",
                ellipsoid.encloses,
                mutant("a twentieth of the squared radius", share=Fraction(1, 20)),
            ),
            text("curvature_factor", "ellipsoid_radius_squared"),
        ),
        proof=r"With $f(z) = \log(1 + e^{-z})$, $f'' = \sigma'$ and $\sigma'(z + y) \ge \sigma'(z)e^{-|y|}$; integrate "
        r"twice to $f(z + y) \ge f(z) + f'(z)y + \sigma'(z)(e^{-|y|} + |y| - 1)$, and the last bracket is at least "
        r"$\frac{e^{-r} + r - 1}{r^2}y^2$ for $|y| \le r$. Sum over the answers: $\frac12\Delta^\top(A - \eta I)\Delta "
        r"- \langle\nabla\ell_t(\hat w), \Delta\rangle \le b$ on $C_t$. Add $\frac\eta2(\lVert w\rVert^2 - W^2) \le 0$ "
        r"and complete the square. Each pass encloses the set, so that its reaches serve the next one.",
    ),
)
