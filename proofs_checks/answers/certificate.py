"""G2, G3 and G3': the dual certificate, the certified gap and the share gained."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.answers.checks import dual, likelihood_set, quadratics
from proofs_checks.answers.evidence import text
from proofs_checks.claim import Claim, link
from proofs_checks.evidence import agrees, exact, mutant, proved, proved_step
from proofs_checks.kernel.evidence import theorem

_CONVEX = proved_step(
    r"the loss has second derivative $e^z/(1 + e^z)^2 > 0$, so that $\ell_t$ lies below its tangents",
    quadratics.convex_loss,
    mutant("the other sign", sign=-1),
)

CLAIMS = (
    Claim(
        label="companion G2",
        name="dual certificate",
        topic="answers",
        verdict="true",
        statement=r"For every direction $v$, every point $w_0$, inside the ball or not, every $c \ge 0$ and cones "
        r"$\langle k_j, w\rangle \ge 0$ with multipliers $\mu_j \ge 0$: $$\max_{w \in C_t, \lVert w\rVert \le W, "
        r"\text{cones}}\langle v, w\rangle \le c(\ell_t(w_0) - \langle\nabla\ell_t(w_0), w_0\rangle - Q_t + "
        r"\log(1/\delta)) + W\lVert v + \textstyle\sum_j\mu_jk_j + c\nabla\ell_t(w_0)\rVert.$$",
        because="Concavity of the log-likelihood and weak duality; nothing that an optimiser returns is trusted.",
        links=(
            link("weak duality from the tangent, the threshold and the cones", "dual_certificate"),
            link("the ball", "dual_certificate_ball"),
        ),
        evidence=(
            theorem("dual_certificate"),
            theorem("dual_certificate_ball"),
            _CONVEX,
            proved_step(
                "the bound follows from concavity, the threshold, the ball and the cones, for all real values (Z3)",
                dual.weak_duality,
                mutant("a negative multiplier", sign=-1),
                mutant("outside the cone", cones=False),
            ),
            proved_step(
                "the inner product in the ball, in the plane that two vectors span (Z3)",
                dual.cauchy_schwarz,
                mutant("twice the squared radius", factor=2),
            ),
            exact(
                "points certainly in the set, the ball and the cones stay below certificates at arbitrary $w_0$, $c$, "
                "$\\mu$ (balls)",
                dual.points_are_below,
                mutant("a quarter of the ball", share=Fraction(1, 4)),
            ),
            agrees(
                "an independent convex solver's maximum is never above the certificate at its own optimum, and nearly "
                "equal, cones included (CVXPY, Clarabel)",
                dual.against_solver,
                mutant("the other sign of the multiplier", sign=-1),
            ),
            text("dual_certificate"),
        ),
        proof=r"On $C_t$: $0 \le \ell_t(w) - Q_t + \log(1/\delta) \le \ell_t(w_0) + \langle\nabla\ell_t(w_0), w - "
        r"w_0\rangle - Q_t + \log(1/\delta)$. Add $c$ times this and $\mu_j\langle k_j, w\rangle \ge 0$ to $\langle v, "
        r"w\rangle$, and maximise over the ball.",
    ),
    Claim(
        label="companion G3",
        name="certified gap at any stopping time",
        topic="answers",
        verdict="true",
        statement=r"If the best policy is a candidate and $C_t$ meets the ball, on the events of the offline set and "
        r"of G1, for every $t$ and every recommendation $\hat\pi$ chosen in any way from the data: $U(\pi^*) - "
        r"U(\hat\pi) \le G_t = \max(0, \max_{\pi \in \Pi_{\text{off}}}\max_{w \in C_t, \lVert w\rVert \le "
        r"W}\langle\phi(\pi) - \phi(\hat\pi), w\rangle)$.",
        because="The best policy is one of the candidates and the true weights one of the points maximised over.",
        assumptions=(
            "the best policy is a candidate, the demonstrator optimal for the same weights",
            "the set is not empty: an empty one refutes the model or the bound on the weights (G4)",
        ),
        links=(
            link(
                "no asker, stopping rule or recommendation makes false certificates likelier than delta",
                "certified_answers",
                "false_certificates",
            ),
            link(
                "the best policy and the true weights are among those maximised over",
                "certified_answers",
                "certified_gap",
            ),
        ),
        evidence=(
            theorem("certified_answers"),
            theorem("certified_answers_version_space"),
            theorem("certified_gap"),
            exact(
                "a gap certified at most log 2 that is larger has probability at most $\\delta$, for the worst asker, "
                "stopping time and recommendation at once (rationals)",
                likelihood_set.false_certificates,
                mutant("the best likelihood instead of the mixture", chosen_after=True),
            ),
            text("certified_gap"),
        ),
        proof=r"$U(\pi^*) - U(\hat\pi) = \langle\phi(\pi^*) - \phi(\hat\pi), w^*\rangle$ with $\pi^* \in "
        r"\Pi_{\text{off}}$ and $w^* \in C_t$; the event does not mention $\hat\pi$ or the stopping time.",
    ),
    Claim(
        label="companion G3'",
        name="share gained over a reference",
        topic="answers",
        verdict="true",
        statement=r"If for every candidate $\max_w\langle\phi(\pi) - \phi(\hat\pi) - \rho(\phi(\hat\pi) - "
        r"\phi(\pi_0)), w\rangle \le 0$ and $U(\pi^*) > U(\pi_0)$, then $U(\hat\pi) - U(\pi_0) \ge "
        r"\frac1{1+\rho}(U(\pi^*) - U(\pi_0))$.",
        because="One line of algebra at the true weights; the conclusion has no scale.",
        evidence=(
            theorem("certified_share_of_gain"),
            theorem("certified_share"),
            proved(
                "from $a \\le \\rho g$ and $a + g > 0$ to $g \\ge (a + g)/(1 + \\rho)$ (Z3)",
                dual.share_gained,
                mutant("twice the share", factor=2),
            ),
            text("share_gained", "confinement_margin"),
        ),
        links=(link("the algebra at the true weights", "certified_share_of_gain", "share_gained"),),
        proof=r"At $w^*$ and $\pi^*$: what is missing, $a$, is at most $\rho$ times what is gained, $g$.",
    ),
    Claim(
        label="companion G3'",
        part="without the ball",
        name="when the bound on the weights is not needed",
        topic="answers",
        verdict="true",
        statement=r"For $\hat w \in C_t$, that is $b = \ell_t(\hat w) - Q_t + \log(1/\delta) \ge 0$: if $b + "
        r"\lVert\nabla\ell_t\rVert r - \frac{r^2}2\lambda_{\min}(A_r) < 0$ for one $r$, then $C_t$ lies within $r$ of "
        r"$\hat w$.",
        because="The companion's text says 'for any $\\hat w$'; with $b < 0$ that is false, and the hypothesis is "
        "added here: a set elsewhere satisfies the condition as well.",
        links=(
            link("on the sphere of radius $r$ the log-likelihood is below the threshold", "curvature_inequality"),
            link("and beyond it too, along every ray", "confinement"),
            link("for all rays at once, with the least eigenvalue"),
        ),
        evidence=(
            proved_step(
                "a concave function that starts at or above 0 and is below 0 at $r$ stays below 0 beyond (Z3)",
                dual.confinement,
                mutant("a middle outside the set", inside=False),
            ),
            proved_step(
                r"the loss lies above its tangent by $\sigma'(z)\,2(e^{-r} + r - 1)/r^2\cdot y^2/2$ within $r$ (SymPy, "
                r"Z3)",
                quadratics.curvature_inequality,
                mutant("the curvature may not fall", power=1),
            ),
            exact(
                "the counterexample to the text: a hundred answers 1, middle 0, $r = 1/2$; the condition holds and the "
                "set begins beyond $r$ (balls)",
                dual.confinement_needs_its_middle,
                mutant("one answer", answers=1),
            ),
        ),
        proof=r"By G5's inequality $\ell_t(\hat w + y) \le \ell_t(\hat w) + \lVert\nabla\ell_t\rVert r - "
        r"\frac{r^2}2\lambda_{\min}(A_r)$ for $\lVert y\rVert = r$, which is below the threshold. Along a ray $\ell_t$ "
        r"is concave and at or above the threshold at $\hat w$, so it cannot rise above it again.",
    ),
)
