"""Appendix: a Hellinger ball bounds means and covariances."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.claim import Claim, link
from proofs_checks.evidence import exact, mutant, proved_step
from proofs_checks.offline.checks import moments
from proofs_checks.offline.evidence import text
from proofs_checks.offline.repairs_counts import T12

CLAIMS = (
    Claim(
        label="lem:hellinger_to_moment",
        name="Hellinger ball to moments: mean",
        topic="offline",
        verdict="true",
        statement=r"""If $\lVert f\rVert_\infty \le B$ and $H^2(P, Q) \le R$ then $\lVert\operatorname{E}_Pf -
            \operatorname{E}_Qf\rVert_2 \le 2\sqrt2\,B\sqrt{dR}$.""",
        because=r"""T12 gives $2B\sqrt{dR(2-R)}$. Densities need not be continuous. The main text uses the form
            without $d$, which is true for $\lVert f\rVert_2 \le B$, the assumption made there.""",
        links=(
            link("the sharp bound on means", T12),
            link("the stated bound is above it, for every $R$ in $[0, 1]$", "mean_bounds_compared"),
        ),
        evidence=(
            proved_step(
                r"$(2\sqrt2B\sqrt R)^2 - (2B\sqrt{R(2-R)})^2 = 4B^2R^2$ (SymPy)",
                moments.mean_bounds_compared,
                mutant("2 instead of 4", factor=2),
            ),
            exact(
                "means of generated laws and features, by both formulas",
                moments.means,
                mutant("half the total variation", share=Fraction(1, 2)),
            ),
            text("mean_difference_stated", "mean_difference_sharp"),
        ),
        repairs=(T12,),
        proof=r"""$\lVert\sum f(p-q)\rVert_2 \le \sqrt dB\cdot2\operatorname{TV}$ and $\operatorname{TV} \le
            \sqrt{2H^2}$.""",
    ),
    Claim(
        label="lem:hellinger_to_moment",
        part="covariance",
        name="Hellinger ball to moments: covariance",
        topic="offline",
        verdict="true",
        statement=r"""$\lVert\operatorname{Cov}_P - \operatorname{Cov}_Q\rVert_{op} \le 6dB^2\sqrt{2R}$ under the same
            assumptions.""",
        because=r"""T12 has 4 in place of 6, and $4t(1-t)$ of the total variation exactly. The proof has a sign error
            without effect.""",
        links=(
            link("the sharp bound on covariances", T12),
            link("the stated bound is above it, for every $R$ in $[0, 1]$", "covariance_bounds_compared"),
        ),
        evidence=(
            proved_step(
                "the stated bound exceeds the sharp one for every $R$ in $[0, 1]$ (Z3)",
                moments.covariance_bounds_compared,
                mutant("1 instead of 6", factor=1),
            ),
            proved_step(
                "the formulas of bridge_theory in this order for $R$ from $1/10000$ to 1 (balls)",
                moments.covariance_formulas_compared,
                mutant("three times the sharp one", factor=3),
            ),
            exact(
                "variances of generated laws and features, by both formulas",
                moments.covariances,
                mutant("half the total variation", share=Fraction(1, 2)),
            ),
            text("covariance_difference_stated", "covariance_difference_sharp"),
        ),
        repairs=(T12,),
    ),
)
