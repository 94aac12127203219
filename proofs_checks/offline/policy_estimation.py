"""Appendix: the error of behavioural cloning; and the set under known dynamics."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.claim import Claim, link
from proofs_checks.evidence import exact, mutant, proved_step, refuted
from proofs_checks.kernel.evidence import theorem
from proofs_checks.offline.checks import maximum_likelihood, radius
from proofs_checks.offline.evidence import text
from proofs_checks.offline.repairs_counts import T12
from proofs_checks.offline.repairs_policy import T6, T6_COVER, T7, T8

POLICY_CONSTANT = (
    proved_step(
        r"$|S|\log2 + \log(1/\delta) \le 4|S|\log(|A|/\delta)$ for $|A| \ge 2$ (Z3 in the logarithms)",
        maximum_likelihood.constants_by_logarithms,
        mutant("constant 0 instead of 4", constant=0),
    ),
)
POLICY_ERROR_LINKS = (
    link("the sharp bound on the policy error", T7),
    link("the stated one is larger", "constants_by_logarithms"),
)
POLICY_ERROR = (
    *POLICY_CONSTANT,
    exact(
        "the formulas of bridge_theory with 4 and with 6 are above the sharp one",
        maximum_likelihood.paper_constants_are_safe,
        mutant("a twelfth of them", sixth=Fraction(1, 12)),
    ),
)

CLAIMS = (
    Claim(
        label="eq: loglossbc estimator",
        name="behavioural cloning (appendix)",
        topic="offline",
        verdict="definition",
        statement=r"$\hat\pi = \arg\max_{\pi\in\Pi}\sum_i\sum_h\log\pi_h(a_h^i|s_h^i)$.",
        because="A definition, the same as in the main text.",
    ),
    Claim(
        label="def:policy_covering",
        name="policy cover",
        topic="offline",
        verdict="definition",
        statement=r"$\log(\pi_h(a|s)/\pi'_h(a|s)) \le \varepsilon$ for all $(s, a, h)$.",
        because="A definition.",
    ),
    Claim(
        label="thm:generalization_bound_logloss_BC_general",
        name="error of log-loss cloning, cover",
        topic="offline",
        verdict="false",
        statement=r"""With probability $1-\delta$, $H^2(P_*^{\hat\pi}, P_*^{\pi^*}) \le
            \inf_\varepsilon\{6\log(2\mathcal N_{pol}(\varepsilon/H)/\delta)/n + \varepsilon\}$.""",
        because=r"""The cited source has $4\varepsilon$. With $\varepsilon$ alone a class with many ties violates it
            surely, for every sample.""",
        evidence=(refuted("offline-log-loss-ties"), text("policy_error_covering")),
        repairs=(T6_COVER,),
        proof=r"""$H = |S| = 1$, actions $1, \ldots, L$, policies uniform on $M$ of them. Every policy whose set
            contains the data is a maximiser, and one of them shares only the $n$ drawn actions with the expert: $H^2
            = 1 - n/M$. The uniform policy on all $L$ covers the class at $\varepsilon = \log(L/M)$. The instance is
            the smallest in $M$ of this family.""",
    ),
    Claim(
        label="thm:generalization_bound_logloss_BC_general",
        part="finite",
        name="error of log-loss cloning, finite class",
        topic="offline",
        verdict="true",
        statement=r"$H^2(P_*^{\hat\pi}, P_*^{\pi^*}) \le 6\log(2|\Pi|/\delta)/n$ with probability $1-\delta$.",
        because=r"T6 has $\log((|\Pi|-1)/\delta)/n$.",
        links=(
            link("the tail of maximum likelihood over a finite class", T6),
            link(r"$\log((|\Pi|-1)/\delta) \le 6\log(2|\Pi|/\delta)$", "finite_class_constants"),
        ),
        evidence=(
            proved_step(
                r"$\log((|\Pi|-1)/\delta) \le 6\log(2|\Pi|/\delta)$ (Z3 in the logarithms)",
                maximum_likelihood.finite_class_constants,
                mutant("constant 0 instead of 6", constant=0),
            ),
            exact(
                "the tail behind it, over all samples of generated classes; the formulas in order",
                maximum_likelihood.finite_formulas,
                mutant("|G| instead of |G| - 1", others=0),
            ),
            text("policy_error_finite"),
        ),
        repairs=(T6,),
    ),
    Claim(
        label="corr:generalization_bound_logloss_BC_deterministic_stationary_tabular_policies",
        name="error of deterministic tabular cloning",
        topic="offline",
        verdict="true, proof wrong",
        statement=r"""$H^2(P_*^{\hat\pi}, P_*^{\pi^*}) \le 6|S|\log(|A|/\delta)/n$ with probability $1-\delta$.""",
        because=r"""True with room: T7 has $(|S|\log2 + \log(1/\delta))/n$, without $|A|$. The step in the paper's
            proof holds only for $\delta \le 2^{-1/(|S|-1)}$.""",
        assumptions=("for $|A| = 1$ there is one policy and nothing to estimate",),
        links=POLICY_ERROR_LINKS,
        evidence=(*POLICY_ERROR, text("policy_error_corollary")),
        repairs=(T7,),
    ),
    Claim(
        label="corr:generalization_bound_logloss_BC_deterministic_stationary_tabular_policies",
        part="union-step",
        name="step of the proof",
        topic="offline",
        verdict="false",
        statement=r"$\log(2|A|^{|S|}/\delta) \le |S|\log(|A|/\delta)$.",
        because=r"Equivalent to $2\delta^{|S|-1} \le 1$.",
        evidence=(
            refuted("offline-union-step"),
            exact(
                "the equivalence, in integers",
                maximum_likelihood.union_step,
                mutant("at most 2", limit=Fraction(2)),
            ),
        ),
    ),
    Claim(
        label="lem:offline_CI_under_known_dyn",
        name="set under known dynamics",
        topic="offline",
        verdict="true",
        statement=r"""$H(P_*^{\pi^*}, P_*^{\hat\pi}) \le \sqrt{6|S|\log(|A|/\delta)/n}$ with probability $1-\delta$.""",
        because=r"""Follows from T7, not from the theorem, whose constant is 4. As $P^*$ is known, the root of
            $P_*^{\hat\pi}(\text{meet a state without data})$ is a sure and computable radius (T8).""",
        links=(link("the theorem, from the demonstrations to the radius", "known_dynamics_as_stated"),),
        evidence=(
            theorem("known_dynamics_as_stated"),
            *POLICY_ERROR,
            exact(
                "the formula is the root of the corollary's, and the squared feature difference is 32 times it",
                radius.known_dynamics,
                mutant("4 instead of 6", six=4),
                mutant("96 instead of 192", diameter=96),
            ),
            text("offline_radius_known", "feature_difference_squared_stated"),
        ),
        repairs=(T7, T8, T12),
    ),
)
