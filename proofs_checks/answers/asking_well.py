"""G8 and G9: what a question is worth, and how few any method needs."""

from __future__ import annotations

from proofs_checks.answers.checks import asking, likelihood_set
from proofs_checks.answers.evidence import text
from proofs_checks.claim import Claim, link
from proofs_checks.evidence import cited, exact, mutant, proved_step

CLAIMS = (
    Claim(
        label="companion G8",
        name="any choice of questions is valid",
        topic="answers",
        verdict="true",
        statement=r"However questions are chosen from the past, the certificate holds. With $A$ the Hessian and $p$ "
        r"the prediction, a question $x$ lowers $v^\top A^{-1}v$ by $p(1-p)(x^\top A^{-1}v)^2/(1 + p(1-p)x^\top "
        r"A^{-1}x)$.",
        because="The martingale asks only that a question is fixed before its answer; the gain is the Sherman-Morrison "
        "identity.",
        assumptions=("a question does not depend on its own answer",),
        links=(
            link(
                "the worst asker leaves the set and is certified falsely with probability at most delta",
                "false_certificates",
            ),
            link("the gain of a question", "gain"),
        ),
        evidence=(
            exact(
                "false certificates of the worst asker, stopping time and recommendation (rationals)",
                likelihood_set.false_certificates,
                mutant("the best likelihood instead of the mixture", chosen_after=True),
            ),
            proved_step(
                "Sherman and Morrison in two dimensions (SymPy)", asking.gain, mutant("the other sign", sign=-1)
            ),
        ),
        proof=r"In any dimension $x$ and $v$ span a plane, after whitening by $A^{-1/2}$.",
    ),
    Claim(
        label="companion G9",
        name="how few answers any method needs",
        topic="answers",
        verdict="cited",
        statement=r"With one good candidate and $D$ the information of the best design against the nearest "
        r"alternative, every method that errs with probability at most $\delta$ has $\operatorname{E}[\tau] \ge "
        r"\mathrm{kl}(1-\delta, \delta)/D$; $\liminf\operatorname{E}[\tau]/\log(1/\delta) \ge 1/D$ in general.",
        because="The transportation inequality of pure exploration; reported as an estimate, since $D$ is computed "
        "over a named pool.",
        evidence=(
            cited(
                "Kaufmann, Cappe and Garivier 2016, Lemma 1; Degenne and Koolen 2019 for several answers (quoted from "
                "memory)"
            ),
            text("fewest_answers"),
        ),
    ),
)
