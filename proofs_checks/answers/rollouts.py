"""G7 and G7': features from rollouts."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.answers.checks import rollouts
from proofs_checks.answers.evidence import text
from proofs_checks.claim import Claim, link
from proofs_checks.evidence import cited, covered, exact, mutant, proved_step

CLAIMS = (
    Claim(
        label="companion G7",
        name="features from rollouts",
        topic="answers",
        verdict="true",
        statement=r"With $N$ rollouts a candidate fixed before them, with probability $1-\delta_\phi$ every coordinate "
        r"is within $\varepsilon_j = \sqrt{2V_jL/N} + 7R_jL/(3(N-1))$, $L = \log(4d|\Pi|/\delta_\phi)$, and the "
        r"certified gap grows by at most $W\lVert\varepsilon(\pi) + \varepsilon(\hat\pi)\rVert$. The $k$-th look may "
        r"spend $\delta_\phi/(k(k+1))$.",
        because="Maurer and Pontil's empirical Bernstein bound, a union over coordinates and sides, and Cauchy and "
        "Schwarz.",
        assumptions=(
            "rollouts are independent and as many as fixed beforehand",
            "coordinates lie in sure ranges (clip them)",
        ),
        links=(
            link("each mean is within its radius", "coins", "cited"),
            link("errors of the features change a utility by at most this", "linear"),
            link("the looks spend delta together", "looks"),
            link("the union over coordinates, candidates and sides"),
        ),
        evidence=(
            exact(
                "coins of six biases and up to 48 tosses: the exact probability of missing is at most $\\delta$ "
                "(rationals, balls)",
                rollouts.coins,
                mutant("a hundredth of the range's part", share=Fraction(1, 100)),
            ),
            proved_step(
                "the error of the features against the ball, in two coordinates (Z3)",
                rollouts.linear,
                mutant("twice the square", factor=2),
            ),
            exact("the first $n$ looks spend $\\delta n/(n+1)$", rollouts.looks, mutant("k(k + 2)", shift=2)),
            cited("Maurer and Pontil 2009, Theorem 4 (quoted from memory)"),
            text("bernstein_radius", "rollout_gap", "look_delta"),
        ),
        proof=r"Theorem 4 of Maurer and Pontil, one-sided at $\delta_\phi/(2d|\Pi|)$, is "
        r"$\log(2\cdot2d|\Pi|/\delta_\phi) = L$. Then $\langle\phi - \hat\phi, w\rangle \le "
        r"\lVert\varepsilon\rVert\lVert w\rVert$.",
    ),
    Claim(
        label="companion G7'",
        name="fresh rollouts after the answers",
        topic="answers",
        verdict="true",
        statement=r"Fix $C_t$, $\hat\pi$, a contender and $\lVert w - m\rVert_A \le \rho$ around $C_t$, then draw $N$ "
        r"fresh pairs with differences $y_i$ of mean $v$. With probability $1-\delta'$: $\max_{C_t}\langle v, w\rangle "
        r"\le \max_{C_t}\langle\bar y, w\rangle + \mathrm{EB}(\langle y_i, m\rangle; \delta'/2) + \rho b(1 + "
        r"\sqrt{2\log(2/\delta')})/\sqrt N$.",
        because="The error of the mean is split at the middle of the ellipsoid.",
        assumptions=("everything but the rollouts is fixed before them", r"$\lVert y\rVert_{A^{-1}} \le b$ surely"),
        links=(
            link("the bound holds in simulation", "fresh"),
            link("the deviation of a mean of bounded vectors, by bounded differences"),
        ),
        evidence=(
            covered(
                "the largest true advantage over random ellipsoids, 20 fresh pairs, $\\delta' = 1/5$",
                rollouts.fresh,
                mutant("nothing added", share=0.0),
            ),
            text("fresh_rollout_gap"),
        ),
        proof=r"$\langle v, w\rangle = \langle\bar y, w\rangle + \langle v - \bar y, m\rangle + \langle v - \bar y, w "
        r"- m\rangle$. The second term is G7 for one number at $\delta'/2$, the third at most $\rho\lVert\bar y - "
        r"v\rVert_{A^{-1}}$, whose mean is at most $b/\sqrt N$ and which one rollout changes by at most $2b/N$, so "
        r"that bounded differences add $b\sqrt{2\log(2/\delta')/N}$ at $\delta'/2$.",
    ),
)
