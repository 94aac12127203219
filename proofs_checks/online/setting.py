"""Section 3: the preference model, its curvature, the regret."""

from __future__ import annotations

from proofs_checks.claim import Claim, Repair, link
from proofs_checks.evidence import mutant, proved, proved_step, refuted
from proofs_checks.online.checks import link as curvature
from proofs_checks.online.evidence import directions, text

_CLOSED_FORM = proved(
    r"$1/\sigma'(x) = 2 + 2\cosh x$, and the formulas of the package are its values at $BW$ and $2BW$",
    curvature.inverse_slope,
    mutant("constant 3 instead of 2", constant=3),
    mutant("half the radius", radius=2),
)

NONNEGATIVE = proved_step(
    r"$(a - b)^2 \le a^2 + b^2$ for $a, b \ge 0$, so $\lVert a - b\rVert^2 \le 2B^2$ for features without negative "
    r"coordinates, attained; the formula of the package is $2 + 2\cosh(\sqrt2BW)$",
    curvature.nonnegative_difference,
    mutant("without the first square", share=0),
)

KAPPA_DIFFERENCES = Repair(
    name="P3",
    title="curvature over feature differences",
    links=(
        link("the closed form", "inverse_slope"),
        link(r"$\kappa_2 \le \kappa^2$", "square_dominates"),
        link("a difference of two features has norm at most $2B$, by the triangle inequality"),
        link(r"without negative coordinates it has norm at most $\sqrt2B$", "nonnegative_difference"),
    ),
    statement=r"On $\lVert x\rVert \le 2B$, $\lVert w\rVert \le W$: $1/\sigma'(\langle w, x\rangle) \le \kappa_2 = "
    r"2 + 2\cosh(2BW)$, and $\kappa \le \kappa_2 \le \kappa^2$. If no feature is negative, $\lVert x\rVert \le "
    r"\sqrt2B$, so that $2 + 2\cosh(\sqrt2BW)$ serves; neither radius can be smaller.",
    evidence=(
        _CLOSED_FORM,
        NONNEGATIVE,
        proved(r"$\kappa^2 - \kappa_2 = 4 + 8\cosh(BW)$", curvature.square_dominates, mutant("constant 5", constant=5)),
    ),
    proof=r"The two features of a comparison have norm at most $B$ each, so their difference has norm at most $2B$. "
    r"Since $\cosh 2x = 2\cosh^2 x - 1$, $\kappa_2 = 4\cosh^2(BW)$.",
    formulas=("kappa_differences", "kappa_nonnegative"),
)

CLAIMS = (
    Claim(
        label="ass:bounded_conditions",
        name="bounded features and weights",
        topic="setting",
        verdict="definition",
        statement=r"$\lVert\phi(\tau)\rVert_2 \le B$ for all $\tau$ and $\lVert w^*\rVert_2 \le W$.",
        because="An assumption; every bound on differences follows with $2B$ by the triangle inequality.",
        evidence=(directions("offline"), text("kappa", "kappa_differences", "kappa_nonnegative")),
    ),
    Claim(
        label="local:kappa",
        name="kappa in closed form",
        topic="setting",
        verdict="true",
        statement=r"$\kappa := \sup_{\lVert x\rVert\le B,\lVert w\rVert\le W} 1/\sigma'(\langle w, x\rangle) "
        r"= 2 + 2\cosh(BW)$.",
        because=r"$1/\sigma'(x) = 2 + 2\cosh x$ rises with $|x|$, and $|\langle w, x\rangle| \le BW$ is attained.",
        links=(
            link("the closed form", "inverse_slope"),
            link("it rises with $|x|$", "largest_at_the_end"),
            link(r"$|\langle w, x\rangle|$ takes the values up to $BW$ and no others, by Cauchy-Schwarz"),
        ),
        evidence=(
            _CLOSED_FORM,
            proved(
                r"$\cosh a - \cosh c = 2\sinh\frac{a+c}2\sinh\frac{a-c}2 > 0$ for $a > c \ge 0$",
                curvature.largest_at_the_end,
                mutant("the other sign", sign=-1),
            ),
        ),
        proof=r"$\sigma' = \sigma(1-\sigma)$ and $1/(\sigma(x)(1-\sigma(x))) = (1+e^{-x})(1+e^{x}) = 2 + 2\cosh x$.",
    ),
    Claim(
        label="local:kappa",
        part="differences",
        name="kappa bounds the curvature where it is used",
        topic="setting",
        verdict="false",
        statement=r"In $V_t$, $g_t$ and the step $G_t \succeq \kappa^{-1} V_t$ the same $\kappa$ bounds "
        r"$1/\sigma'(\langle\phi(\tau^1) - \phi(\tau^2), w\rangle)$.",
        because="Differences of two features have norm up to $2B$, not $B$.",
        evidence=(refuted("online-curvature-of-differences"),),
        repairs=(KAPPA_DIFFERENCES,),
    ),
    Claim(
        label="local:bradley_terry",
        name="Bradley-Terry model of trajectories",
        topic="setting",
        verdict="definition",
        statement=r"$\operatorname{P}(\tau^1 \succ \tau^2) = \sigma(\langle\phi(\tau^1) - \phi(\tau^2), w^*\rangle)$.",
        because="The model of the answers; all of the theory uses this trajectory-level form.",
    ),
    Claim(
        label="local:bradley_terry",
        part="average",
        name="preference of policies as an average preference",
        topic="setting",
        verdict="false",
        statement=r"$\sigma(\langle\phi(\pi^1) - \phi(\pi^2), w^*\rangle)$ is the average preference "
        r"$\operatorname{E}\sigma(\langle\phi(\tau^1) - \phi(\tau^2), w^*\rangle)$ between the policies' trajectories.",
        because="The sigmoid is not linear: the average of the preferences is not the preference of the averages.",
        evidence=(refuted("online-average-preference"),),
        proof="Nothing in the theory uses the policy-level form; it can be dropped.",
    ),
    Claim(
        label="local:pseudo_regret",
        name="pseudo-regret in two forms",
        topic="setting",
        verdict="true",
        statement=r"$R_T = \max_\pi\sum_t\frac12\langle 2\phi(\pi) - \phi(\pi_t^1) - \phi(\pi_t^2), w^*\rangle "
        r"= \sum_t\frac12(2s(\pi^*) - s(\pi_t^1) - s(\pi_t^2))$ with $s(\pi) = \langle\phi(\pi), w^*\rangle$.",
        because="The same linear functional is maximised in every round, so one maximiser serves all rounds.",
        links=(
            link("each round's term is the same in both forms", "regret_is_linear"),
            link("the sum over the rounds, and one maximiser for all of them"),
        ),
        proof="Add the identity over the rounds; what depends on the policy is $T$ times one functional of it.",
        assumptions=(
            "the class of policies is finite, so that the maximum is attained",
            "the expert who demonstrates is a maximiser, otherwise containment of the expert says nothing about it",
        ),
        evidence=(
            proved(
                "each round's term is the same in both forms", curvature.regret_is_linear, mutant("weight 1", weight=1)
            ),
        ),
    ),
)
