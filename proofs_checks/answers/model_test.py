"""G4: the model itself is tested."""

from __future__ import annotations

from proofs_checks.answers.checks import cycles, likelihood_set
from proofs_checks.answers.evidence import text
from proofs_checks.claim import Claim, link
from proofs_checks.evidence import covered, exact, mutant
from proofs_checks.kernel.evidence import theorem

CLAIMS = (
    Claim(
        label="companion G4",
        name="test of the model by an outside forecaster",
        topic="answers",
        verdict="true",
        statement=r"For a mixture $Q_t$ of forecasters, one of them outside the model, $e^{Q_t}/\max_we^{\ell_t(w)}$ "
        r"exceeds $1/\delta_M$ at some time with probability at most $\delta_M$ under the model. Preferences that go "
        r"round in a circle at .9 are refuted within 50 answers in at least 9 of 10 sessions.",
        because="The best weights are at least as likely as the true ones, so that the ratio is at most a "
        "supermartingale.",
        assumptions=("forecasts are made before their answers",),
        links=(
            link("a true model is refuted with probability at most delta, by the worst asker", "refutations"),
            link("a circle of preferences is refuted soon", "circle_is_refuted"),
            link(
                "a true model is refuted with probability at most delta, for any forecasters",
                "true_model_is_not_refuted",
            ),
        ),
        evidence=(
            theorem("true_model_is_not_refuted"),
            theorem("empty_set_certificate"),
            exact(
                "tables and model mixed half and half against the best weights: the worst asker refutes a true model "
                "with probability at most $\\delta$ (rationals)",
                likelihood_set.refutations,
                mutant("against one fixed weight vector", against=0),
            ),
            covered(
                "three items in a circle at .9 are refuted within 50 answers in at least 9 of 10 sessions",
                cycles.circle_is_refuted,
                mutant("hardly a circle, at .6", chance=0.6),
            ),
            text("refutation_threshold"),
        ),
        proof=r"$e^{Q_t}/\max_we^{\ell_t(w)} \le e^{Q_t - \ell_t(w^*)}$, a nonnegative supermartingale of mean at most "
        r"1; Ville. A forecaster of the mixture gets its share $1/k$, hence the lead $\log(k/\delta_M)$. Without one "
        r"outside the model the test is empty: $Q_t(q) = \operatorname{E}_q\ell_t - \mathrm{KL} \le \max_w\ell_t(w)$, "
        r"so that $C_t$ without the ball is never empty.",
    ),
)
