"""G6: containment and regret with the likelihood set."""

from __future__ import annotations

from proofs_checks.answers.checks import asking
from proofs_checks.claim import Claim, link
from proofs_checks.evidence import covered, mutant, proved_step

CLAIMS = (
    Claim(
        label="companion G6",
        name="containment and regret with the likelihood set",
        topic="answers",
        verdict="true",
        statement=r"R2 and R4 hold with $C_t$ in place of R1's ellipsoid: $\Pi_t = \{\pi : \forall\pi' \max_{w \in "
        r"C_t}\langle\phi(\pi) - \phi(\pi'), w\rangle \ge 0\}$ keeps $\pi^*$, a round that plays the widest pair of "
        r"$\Pi_t$ costs at most $\max - \min$ of $\langle\phi(\pi^1) - \phi(\pi^2), \cdot\rangle$ over $C_t$, and $R_T "
        r"\le \max_{\pi}\max_{w \in C}\langle m_\pi, w\rangle$ with $C$ after all answers and $m_\pi = "
        r"\sum_t(\phi(\pi) - \frac12(\phi(\pi_t^1) + \phi(\pi_t^2)))$.",
        because="The true weights and the best policy are among those maximised over.",
        assumptions=("policies are executed; with questions from a pool no regret is defined", "known dynamics"),
        links=(
            link("containment", "containment"),
            link("the regret of a round", "played_width"),
            link("the regret in hindsight is below its bound", "regret"),
            link("R_T is the value of one of the directions at the true weights"),
        ),
        evidence=(
            proved_step(
                "a nonnegative true advantage keeps the largest one nonnegative (Z3)",
                asking.containment,
                mutant("the other sign", sign=-1),
            ),
            proved_step(
                "the regret of a round is at most the width of the widest pair (Z3)",
                asking.played_width,
                mutant("twice the regret", factor=2),
            ),
            covered(
                "the realised regret of 60 rounds is below the dual certificate's bound, which is below R4's bound in "
                "hindsight on the same logs in most runs",
                asking.regret,
                mutant("a fiftieth of the bound", share=0.02),
            ),
        ),
        proof=r"$0 \le \langle\phi(\pi^*) - \phi(\pi'), w^*\rangle \le \max_{C_t}$. For $\pi_i \in \Pi_t$ membership "
        r"against $\pi^*$ says $\min_{C_t}\langle\phi(\pi^*) - \phi(\pi_i), \cdot\rangle \le 0$, so that the advantage "
        r"of $\pi^*$ is at most $\max - \min$, and the pair played is the widest. In hindsight $R_T = \langle "
        r"m_{\pi^*}, w^*\rangle$.",
    ),
)
