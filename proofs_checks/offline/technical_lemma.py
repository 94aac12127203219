"""Appendix: the technical lemma and its three steps."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.claim import Claim, link
from proofs_checks.evidence import exact, mutant, refuted, unsettled
from proofs_checks.offline.checks import full_support
from proofs_checks.offline.evidence import text
from proofs_checks.offline.repairs_trajectory import T1, T2, T3, T4
from proofs_checks.offline.search_transfer import MARKOV, WITH_MEMORY

_FULL_SUPPORT = (
    r"If the expert visits at every step every pair that $\pi$ visits, then $H^2(\hat P^\pi, P_*^\pi) \le "
    r"H\,C(\pi, \pi^*)\,H^2(\hat P^{\pi^*}, P_*^{\pi^*})$"
)

CLAIMS = (
    Claim(
        label="lemma:technical_result",
        name="transfer from the expert to any policy",
        topic="offline",
        verdict="false",
        statement=r"""For all policies $H^2(\hat P^\pi, P_*^\pi) \le H\,C(\pi, \pi^*)\,H^2(\hat P^{\pi^*},
            P_*^{\pi^*})$.""",
        because=r"""The right side does not see pairs that the expert never visits; the cloned policy deviates exactly
            where there is no data. With full support T2 and T4 give the factor $3(2H-1)C$.""",
        evidence=(refuted("offline-support-gap"), text("trajectory_error_stated")),
        repairs=(T1, T2, T3, T4),
    ),
    Claim(
        label="lemma:technical_result",
        part="deterministic",
        name="transfer with full support, deterministic experts",
        topic="offline",
        verdict="true",
        statement=_FULL_SUPPORT + r", for a deterministic expert $\pi^*$, which may change with the step.",
        because=r"""Trivial: at every step $\pi$ can only play the expert's action wherever it gets to, so that both
            errors are the same and $C = 1$.""",
        links=(
            link("the policy plays as the expert does on every history that is possible", "full_support_is_the_expert"),
            link("histories that the truth excludes add nothing to either overlap", "full_support_is_the_expert"),
        ),
        evidence=(
            exact(
                "generated kernels, deterministic experts and policies inside their support: the errors are equal",
                full_support.full_support_is_the_expert,
                mutant("half of the expert's error", share=Fraction(1, 2)),
            ),
        ),
        proof=r"""By induction over the steps: the histories that $\pi$ can see under $P_*$ are those of $\pi^*$, and in
            the state where one ends the expert has one action. The overlap of $\hat P^\pi$ and $P_*^\pi$ sums over
            these histories only.""",
    ),
    Claim(
        label="lemma:technical_result",
        part="history-dependent",
        name="transfer with full support, experts that remember",
        topic="offline",
        verdict="false",
        statement=_FULL_SUPPORT + ", for every expert, also one whose actions depend on the history.",
        because=r"""What the expert meets together, behind one rare step, a policy can meet one by one: with $H$
            transitions the left side may be $2(H-1)$ times $C$ times the expert's error, so that the order of
            $3(2H-1)C$ (T2 with T4) is right. With $H$ counting the transitions, as in the lemma's proof, two steps
            suffice; counting the states, as in the likelihood, the two-step instance (then $H = 3$) is none, and five
            states are.""",
        evidence=(
            refuted("offline-history-expert"),
            refuted("offline-history-family"),
            exact(
                r"along the family with $T \le 7$ transitions the ratio to $C$ times the expert's error is at least "
                r"$\frac{19}{10}(T-1)$",
                full_support.family_grows,
                mutant("more than $2(T-1)$", slope=Fraction(201, 100)),
            ),
        ),
        links=(link("an instance, in either way of counting $H$", "offline-history-expert", "offline-history-family"),),
        repairs=(T2, T4),
        search=WITH_MEMORY,
        proof=r"""In the family $s$ stays, or goes to $x$ with a small probability $p$, under $a$; $b$ leads from $s$
            to $x$ with probability $p$ (never, in the estimate). In $x$, $a$ is estimated wrongly. The expert plays $a$
            or $b$ first; after $b$ it keeps playing $a$ in $x$, which costs $p/4$ once and visits $(x, a)$ at every
            step with probability $p/2$; after $a$ it leaves $x$ safely. A policy that plays $a$ whenever it enters
            $x$ has an error of about $p$ a step.""",
    ),
    Claim(
        label="lemma:technical_result",
        part="markov",
        name="transfer with full support, Markov experts",
        topic="offline",
        verdict="open",
        statement=_FULL_SUPPORT + ", for a stochastic expert whose actions depend on the step and the state alone.",
        because=r"""Proved only with $3(2H-1)C$ (T2 with T4). Searches have found no violation with $HC$.""",
        evidence=(unsettled("no Markov expert with full support is known to violate the factor H C"),),
        repairs=(T2, T4),
        search=MARKOV,
    ),
    Claim(
        label="lemma:technical_result",
        part="step-1",
        name="trajectory error below the sum of row errors",
        topic="offline",
        verdict="false",
        statement=r"$H^2(\hat P^\pi, P_*^\pi) \le \sum_t\operatorname{E}_{d_t}[h_t]$, the occupancies under $P_*$.",
        because=r"""True with both occupancies averaged (T1) or with the constant 3 (T2); no constant below 2 serves
            all horizons.""",
        evidence=(refuted("offline-step-1"),),
        repairs=(T1, T2, T3),
    ),
    Claim(
        label="lemma:technical_result",
        part="product-formula",
        name="overlap as a product of expectations",
        topic="offline",
        verdict="false",
        statement=r"$H^2(\hat P^\pi, P_*^\pi) = 1 - \prod_t\operatorname{E}_{d_t}[\gamma_t]$.",
        because=r"""An expectation of a product is not a product of expectations; the correct factors are averages
            under the normalised overlap measures of T1.""",
        evidence=(refuted("offline-product-formula"),),
        repairs=(T1,),
    ),
    Claim(
        label="lemma:technical_result",
        part="step-2",
        name="change of occupancy",
        topic="offline",
        verdict="false",
        statement=r"$\operatorname{E}_{d_t^\pi}[h_t] \le C(\pi, \pi^*)\operatorname{E}_{d_t^{\pi^*}}[h_t]$.",
        because=r"True only where the expert visits every pair that $\pi$ visits; the proof divides by zero elsewhere.",
        evidence=(refuted("offline-step-2"),),
    ),
    Claim(
        label="lemma:technical_result",
        part="step-3",
        name="trajectory error above the mean row error",
        topic="offline",
        verdict="false",
        statement=r"""$H^2(\hat P^{\pi^*}, P_*^{\pi^*}) \ge \frac1H\sum_t\operatorname{E}_{d_t^{\pi^*}}[h_t]$, if the
            sum is at most $2(H-1)/H$.""",
        because=r"""For a single step it is true (T4), for the sum it is not; the algebra of the proof uses an
            inequality that never holds, $(1 - H/2)X \ge X/H$ for $X > 0$.""",
        evidence=(refuted("offline-step-3"),),
        repairs=(T4,),
    ),
)
