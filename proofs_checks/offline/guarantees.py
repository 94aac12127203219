"""Appendix: the confidence set from the two errors, and the performance guarantees."""

from __future__ import annotations

from proofs_checks.claim import Claim, link
from proofs_checks.evidence import refuted
from proofs_checks.offline.evidence import text
from proofs_checks.offline.policy_estimation import POLICY_ERROR
from proofs_checks.offline.repairs_counts import T11
from proofs_checks.offline.repairs_policy import T7, T8, T9
from proofs_checks.offline.search import ROOT_TWO
from proofs_checks.offline.stage_one import (
    LINKS_OF_THE_LEMMA,
    LINKS_OF_THE_THEOREM,
    RADIUS_OF_THE_LEMMA,
    RADIUS_OF_THE_THEOREM,
)
from proofs_checks.offline.transition_estimation import STATED_ERROR

CLAIMS = (
    Claim(
        label="lemma:confidence_set_construction",
        name="set from two errors (appendix)",
        topic="offline",
        verdict="true, proof wrong",
        statement=r"""On the events $H^2(P_*^{\hat\pi}, P_*^{\pi^*}) \le R_1$ and $H^2(\hat P^{\pi^*}, P_*^{\pi^*})
            \le R_2$: $H(\hat P^{\pi^*}, \hat P^{\hat\pi}) \le \sqrt{R_1} + \sqrt{R_2}\,(1 + \sqrt{H(1 +
            2\sqrt{R_1}/\gamma_{\min})})$.""",
        because=r"""T9 implies it for all policies; the third term of the paper's triangle inequality is not bounded
            as claimed.""",
        links=LINKS_OF_THE_LEMMA,
        evidence=RADIUS_OF_THE_LEMMA,
        repairs=(T9,),
    ),
    Claim(
        label="lemma:confidence_set_construction",
        part="third-term",
        name="third term of the triangle inequality",
        topic="offline",
        verdict="false",
        statement=r"$H^2(\hat P^{\hat\pi}, P_*^{\hat\pi}) \le H\,C(\hat\pi, \pi^*)\,R_2$.",
        because="The technical lemma at the cloned policy, where it fails.",
        evidence=(refuted("offline-third-term"),),
        repairs=(T9,),
    ),
    Claim(
        label="lemma:confidence_set_construction",
        part="root-two",
        name="root of 2 for stochastic policies",
        topic="offline",
        verdict="false",
        statement=r"For stochastic policies too, $H(\hat P^{\pi^*}, \hat P^{\hat\pi}) \le \sqrt{R_1} + \sqrt{2R_2}$.",
        because=r"""Found by the search: three states, horizon 4, where the transition term has to be at least
            $1.016\sqrt{2R_2}$. T9 proves $2\sqrt{R_2}$; the best constant lies between.""",
        evidence=(refuted("offline-root-two"),),
        repairs=(T9,),
        search=ROOT_TWO,
    ),
    Claim(
        label="local:policy_and_transition_error",
        name="the two errors",
        topic="offline",
        verdict="true, proof wrong",
        statement=r"""$R_1 = 4|S|\log(|A|/\delta_1)/n$ and $R_2 = 4|S|^2|A|\log(nH/\delta_2)/n$ bound the two squared
            errors with probability $1-\delta_1$ and $1-\delta_2$.""",
        because=r"""The corollaries that are cited have 6, not 4; T7 and T11 prove 4. The second needs $nH \ge 2$ or
            $\delta_2 \le 1/2$.""",
        assumptions=("$nH \\ge 2$ or $\\delta_2 \\le 1/2$", "$|A| \\ge 2$, else there is nothing to clone"),
        links=(
            link("the sharp bound on the policy error", T7),
            link("the stated one is larger", "constants_by_logarithms"),
            link("the transition error", T11),
        ),
        evidence=(*POLICY_ERROR, *STATED_ERROR, text("policy_error_stated", "transition_error_stated")),
        repairs=(T7, T11),
    ),
    Claim(
        label="local:policy_and_transition_error",
        part="one-transition",
        name="the transition error of one transition",
        topic="offline",
        verdict="false",
        statement=r"The bound $R_2$ holds for all $n$, $H$ and $\delta_2$.",
        because=r"At $nH = 1$ and $\delta_2$ near 1 the logarithm vanishes, but one transition cannot estimate a coin.",
        evidence=(refuted("offline-one-draw"),),
        repairs=(T11,),
    ),
    Claim(
        label="local:offline_radius_appendix",
        name="offline confidence set (appendix)",
        topic="offline",
        verdict="true, proof wrong",
        statement=r"""$\pi^*$ lies with probability $1-\delta$ in the set whose radius is that of the main theorem.""",
        because="As for the main theorem, which it repeats.",
        links=LINKS_OF_THE_THEOREM,
        evidence=RADIUS_OF_THE_THEOREM,
        repairs=(T8, T9),
        proof="As for the main theorem.",
    ),
)
