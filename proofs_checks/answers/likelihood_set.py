"""G1' and G1: the likelihood set of the preference weights."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.answers.checks import adaptive, evidence_bounds, likelihood_set, quadratics
from proofs_checks.answers.evidence import directions, text
from proofs_checks.claim import Claim, link
from proofs_checks.evidence import covered, exact, mutant, proved, proved_step
from proofs_checks.kernel.evidence import theorem

_ASSUMED = (
    "the answer to a question fixed before it is 1 with probability $\\sigma(\\langle x, w^*\\rangle)$, whatever "
    "happened before",
    "answers enter in an order fixed without looking at them, and skips do not depend on the answer skipped",
)

_MARTINGALE = exact(
    "the evidence of a finite prior over the true likelihood keeps its mean at every counts of answers, for every "
    "question and every truth (rationals)",
    likelihood_set.martingale,
    mutant("the best likelihood instead of the mixture", chosen_after=True),
)
_EVERY_ASKER = exact(
    "the true weights leave the set of a finite prior with probability at most $\\delta$, for the worst of all "
    "adaptive askers and stopping times (dynamic programming over counts, rationals)",
    likelihood_set.ever_outside,
    mutant("the best likelihood instead of the mixture", chosen_after=True),
)
_COVERED = covered(
    "$\\ell_t(w^*) \\ge Q_t - \\log(1/\\delta)$ at every $t \\le 50$, $\\delta = 1/10$, Gaussian $q$ fitted to the "
    "answers, a third of the askers adversaries that know the truth",
    adaptive.stays_inside,
    mutant("the best likelihood instead of the evidence", price=0.0),
)

CLAIMS = (
    Claim(
        label="companion G1'",
        name="likelihood set for densities chosen after the answers",
        topic="answers",
        verdict="true",
        statement=r"With a prior $\nu$ fixed before the answers, with probability at least $1-\delta$, for all $t$ and "
        r"all densities $q$ at once, $\ell_t(w^*) \ge Q_t(q) - \log(1/\delta)$ with $Q_t(q) = \operatorname{E}_q\ell_t "
        r"- \mathrm{KL}(q\|\nu)$. For $\nu = N(0, I/\lambda)$, $Q_t \ge \ell_t(m) - \frac\lambda2\lVert m\rVert^2 - "
        r"\frac12\log\det(I + X^\top X/(4\lambda))$ for every $m$, so that $\max_{\lVert m\rVert \le W}\ell_t(m) - "
        r"\ell_t(w^*) \le \frac\lambda2W^2 + \frac d2\log(1 + tB^2/(\lambda d)) + \log(1/\delta)$: no $\kappa$ enters.",
        because="The evidence over the true likelihood is a nonnegative martingale of mean 1, whatever is asked and "
        "whenever one stops; Gibbs' inequality bounds its logarithm from below for every density.",
        assumptions=_ASSUMED,
        links=(
            link("the evidence over the true likelihood is a martingale", "martingale"),
            link(
                "so the true weights leave with probability at most delta (Ville)",
                "prior_bounds_truth",
                "ever_outside",
                "stays_inside",
            ),
            link("Gibbs: the log of the evidence is at least $Q_t(q)$ for every $q$", "prior_bounds_truth", "gibbs"),
            link("the loss has curvature at most 1/4", "quarter_curvature"),
            link("one eigenvalue of $X^\\top X$ pays half a logarithm", "price_of_a_direction"),
            link("the log of the determinant is below that of the trace", "tangent_of_the_logarithm"),
            link("the Jaakkola-Jordan quadratic lies below $\\log\\sigma$", "jaakkola_jordan"),
            link("from finite priors to densities: the same two lines with integrals"),
        ),
        evidence=(
            theorem("prior_bounds_truth"),
            _MARTINGALE,
            _EVERY_ASKER,
            _COVERED,
            proved_step(
                r"$x\log x \ge x - 1$, hence $\mathrm{KL} \ge 0$ and Gibbs' inequality (SymPy, Z3)",
                likelihood_set.gibbs,
                mutant("the other sign", sign=-1),
            ),
            proved_step(
                r"$\sigma' \le 1/4$ everywhere, so that $\operatorname{E}_q\log\sigma(z) \ge "
                r"\log\sigma(\operatorname{E}z) - \operatorname{Var}z/8$",
                quadratics.quarter_curvature,
                mutant("at most 1/5", constant=5),
            ),
            proved_step(
                r"$\frac12as + \mathrm{KL}(N(m,s)\|N(0,1/\lambda)) = \frac\lambda2m^2 + \frac12\log(1 + a/\lambda)$ "
                r"for $s = 1/(a + \lambda)$ (SymPy)",
                quadratics.price_of_a_direction,
                mutant("a third of the logarithm", half="1/3"),
            ),
            proved_step(
                r"$\log x \le x - 1$, hence $\log\det M \le d\log(\operatorname{tr}M/d)$ (SymPy, Z3)",
                quadratics.tangent_of_the_logarithm,
                mutant("the other curvature", sign=-1),
            ),
            proved(
                r"$\log\sigma(z) \ge \log\sigma(\xi) + \frac12(z - \xi) - \frac{\tanh(\xi/2)}{4\xi}(z^2 - \xi^2)$ for "
                r"all real $z$ and $\xi > 0$: $-\log2\cosh(\sqrt u/2)$ is convex in $u = z^2$ (SymPy, Z3)",
                quadratics.jaakkola_jordan,
                mutant("5 instead of 4", constant=5),
            ),
            exact(
                "the Jaakkola-Jordan formula at 833 rational points, those where it touches included (balls)",
                quadratics.jaakkola_jordan_at_points,
                mutant("a millionth higher", shift=Fraction(1, 10**6)),
            ),
            exact(
                r"in one dimension: determinant bound $\le Q_t(q) \le$ log evidence, Jaakkola-Jordan $\le Q_t(q)$, all "
                "integrals enclosed",
                evidence_bounds.below_the_evidence,
                mutant("no divergence", price=Fraction(0)),
            ),
            exact(
                "the closed-form width is at least that of the determinant on generated questions",
                evidence_bounds.determinants,
                mutant("one dimension only", dimension=1),
            ),
            text("evidence_loss_logdet", "likelihood_threshold", "likelihood_width_logdet", "likelihood_width"),
            text("log_sigmoid_lower"),
            directions(),
        ),
        proof=r"$\int e^{\ell_t(w) - \ell_t(w^*)}d\nu(w)$ is a nonnegative martingale of mean 1, since each factor "
        r"$\sum_op_w(o) = 1$ and the question does not depend on its answer. Ville: it ever exceeds $1/\delta$ with "
        r"probability at most $\delta$. Its logarithm is at least $\operatorname{E}_q[\ell_t - \ell_t(w^*)] - "
        r"\mathrm{KL}(q\|\nu)$ for every $q$ at once (Gibbs), so that $q$ may be chosen after the answers."
        "\n\n"
        r"For the determinant take $q = N(m, S)$ with $S^{-1} = X^\top X/4 + \lambda I$. As the loss has curvature at "
        r"most $1/4$, $\operatorname{E}_q\ell_t \ge \ell_t(m) - \frac18\operatorname{tr}(XSX^\top)$; in the eigenbasis "
        r"of $X^\top X/4$ each direction then pays $\frac12\log(1 + a/\lambda)$. The arithmetic mean of the "
        r"eigenvalues of $I + X^\top X/(4\lambda)$ is at most $1 + tB^2/(\lambda d)$, as $\lVert x\rVert \le 2B$.",
    ),
    Claim(
        label="companion G1",
        name="likelihood set from forecasts",
        topic="answers",
        verdict="true",
        statement=r"Let $q_s(1), q_s(0) \ge 0$ with $q_s(0) + q_s(1) \le 1$ be made before $o_s$ is known and $Q_t = "
        r"\sum_s\log q_s(o_s)$. With probability at least $1-\delta$, $\ell_t(w^*) \ge Q_t - \log(1/\delta)$ for all "
        r"$t$. The same holds for finite mixtures $Q_t = \log\sum_k\nu_ke^{\ell_t(w_k)}$.",
        because="The ratio of the forecasts to the true likelihood is a nonnegative supermartingale; bold forecasts "
        "attain delta, so that nothing is left to gain in general.",
        assumptions=(*_ASSUMED, "a forecast is made before its answer; a checker computes it again and never reads it"),
        links=(
            link("the ratio is a martingale", "likelihood_set_covers", "martingale"),
            link("delta is attained by bold forecasts", "bold_forecasts"),
            link("no asker and no stopping rule does better", "likelihood_set_covers", "ever_outside"),
            link("any number of answers: Ville's inequality", "likelihood_set_covers", "forecast_bounds_truth"),
        ),
        evidence=(
            theorem("likelihood_set_covers"),
            theorem("forecast_bounds_truth"),
            exact(
                "all forecasts on a grid against a coin, four tosses: the worst fails with probability exactly "
                "$\\delta = 1/4$",
                likelihood_set.bold_forecasts,
                mutant("forecasts of total mass 2", mass=Fraction(2)),
            ),
            _MARTINGALE,
            _EVERY_ASKER,
        ),
        proof=r"$\operatorname{E}[q_s(o_s)/p_{w^*}(o_s)\mid\text{past}] = q_s(0) + q_s(1) \le 1$; Ville's inequality. "
        r"For finitely many answers both need finite sums only.",
    ),
)
