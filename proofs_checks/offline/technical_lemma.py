"""Appendix: the technical lemma and its three steps."""

from __future__ import annotations

from proofs_checks.claim import Claim
from proofs_checks.evidence import refuted, unsettled
from proofs_checks.offline.evidence import text
from proofs_checks.offline.repairs_trajectory import T1, T2, T3, T4
from proofs_checks.offline.search import TRANSFER

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
        part="full-support",
        name="transfer with full support",
        topic="offline",
        verdict="open",
        statement=r"""If the expert visits at every step every pair that $\pi$ visits, then $H^2(\hat P^\pi, P_*^\pi)
            \le H\,C(\pi, \pi^*)\,H^2(\hat P^{\pi^*}, P_*^{\pi^*})$.""",
        because=r"""Proved only with $3(2H-1)C$ (T2 with T4). Searches have found no violation with $HC$.""",
        evidence=(unsettled("no instance with full support is known to violate the factor H C"),),
        repairs=(T2, T4),
        search=TRANSFER,
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
