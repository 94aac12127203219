"""Appendix: the concentrability bound and the steps of its proof."""

from __future__ import annotations

from proofs_checks.claim import Claim
from proofs_checks.evidence import refuted
from proofs_checks.offline.evidence import text
from proofs_checks.offline.repairs_trajectory import STATED_CONCENTRABILITY, STATED_CONCENTRABILITY_LINKS, T5, TV

CLAIMS = (
    Claim(
        label="def: concentrability coefficient",
        name="concentrability (appendix)",
        topic="offline",
        verdict="definition",
        statement=r"$C(\hat\pi, \pi^*) = \sup_t\sup_{d_t^*(s,a) > 0} d_t^{\hat\pi}(s,a)/d_t^*(s,a)$.",
        because=r"A definition; the numerator is printed with $\pi$ for $\hat\pi$.",
    ),
    Claim(
        label="assumption:min_visitation_tabular",
        name="minimum visitation (appendix)",
        topic="offline",
        verdict="definition",
        statement=r"$d_t^*(s,a) \ge \gamma_{\min} > 0$ wherever it is positive.",
        because="An assumption; some value always satisfies it in a finite problem.",
    ),
    Claim(
        label="lem:concentrability_coefficient_bound",
        name="concentrability bound (appendix)",
        topic="offline",
        verdict="true, proof wrong",
        statement=r"""If $H^2(P_*^{\hat\pi}, P_*^{\pi^*}) \le R$ then $C(\hat\pi, \pi^*) \le 1 + 2\sqrt
            R/\gamma_{\min}$.""",
        because=r"""Two errors of the proof cancel: twice the total variation is too large by a factor of 2, and
            $\operatorname{TV} \le \sqrt{H^2}$ is too small by a factor of up to $\sqrt2$. It also cites the wrong
            assumption.""",
        links=STATED_CONCENTRABILITY_LINKS,
        evidence=(*STATED_CONCENTRABILITY, text("concentrability_stated", "concentrability_sharp")),
        repairs=(T5,),
    ),
    Claim(
        label="lem:concentrability_coefficient_bound",
        part="largest-gap",
        name="gap as twice the total variation",
        topic="offline",
        verdict="false",
        statement=r"$\sup_{s,a}|d_t - d_t^*| = 2\operatorname{TV}(d_t, d_t^*)$.",
        because=r"The largest gap at one point is at most the total variation.",
        evidence=(refuted("offline-largest-gap"),),
    ),
    Claim(
        label="lem:concentrability_coefficient_bound",
        part="tv-below-hellinger",
        name="total variation below Hellinger",
        topic="offline",
        verdict="false",
        statement=r"$\operatorname{TV}(P, Q) \le \sqrt{H^2(P, Q)}$.",
        because=r"The factor $2 - H^2$ under the root is missing.",
        evidence=(refuted("offline-tv-below-hellinger"),),
        repairs=(TV,),
    ),
)
