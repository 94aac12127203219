"""Appendix "Transition estimation and bonus terms"."""

from __future__ import annotations

from proofs_checks.claim import Claim, Repair, link
from proofs_checks.evidence import agrees, cited, covered, exact, mutant, proved, proved_step, refuted
from proofs_checks.online.checks import bonus, transcription
from proofs_checks.online.evidence import text

_UNDEFINED = proved(
    r"$\log(6\log N/\delta)$ has no real value at $N = 0$ and $N = 1$, and the package refuses both",
    bonus.undefined_counts,
    mutant("N = 2 as well", counts=(0, 1, 2)),
)

R6 = Repair(
    name="R6",
    title="L1 bonus",
    statement=r"With $\epsilon_0 = 2$ and $\epsilon_N = \min(2, \sqrt{2(|\mathcal S|\log2 + \log(|\mathcal "
    r"S||\mathcal A|N(N+1)/"
    r"\delta_P))/N})$: with probability at least $1-\delta_P$, for all pairs and all counts, $\lVert\hat P_N - "
    r"P^*\rVert_1 \le "
    r"\epsilon_N$. Then for all policies, all rounds and every function $f$, also random, with values in an interval "
    r"of "
    r"length $2\eta$: $\lvert\operatorname{E}_{P_*^\pi}f - \operatorname{E}_{\hat P_t^\pi}f\rvert \le b_t(\pi) = "
    r"\eta\min(2, "
    r"\operatorname{E}_{\hat P_t^\pi}\sum_{h<H}\epsilon_{N_t(s_h,a_h)})$, and $\operatorname{E}_{\hat "
    r"P^\pi}\sum_{h<H}\epsilon \le "
    r"H\operatorname{E}_{P_*^\pi}\sum_{h<H}\epsilon$.",
    assumptions=(
        "transitions come from the real, stationary environment",
        "given the past and the first trajectory of a round, the second still follows the real dynamics",
        "counts are of the transitions in steps 1 to H-1",
    ),
    links=(
        link("every estimated row stays within its radius, for all pairs and counts", "rows_are_covered"),
        link("the failure probabilities of all counts add up", "weights_sum_to_one"),
        link("total variation is at most the expected sum of row errors", "hybrid_argument"),
        link("the sum under the estimate is at most $H$ times the one under the truth", "estimated_sum"),
    ),
    evidence=(
        exact(
            r"$\operatorname{TV}(P^\pi, Q^\pi) \le \frac12\sum_{h<H}\operatorname{E}\lVert P - Q\rVert_1$ under "
            r"either kernel",
            bonus.hybrid_argument,
            mutant("a quarter instead of a half", share=0.25),
        ),
        exact(
            r"$\operatorname{E}_{\hat P^\pi}\sum\epsilon \le H\operatorname{E}_{P_*^\pi}\sum\epsilon$ on rational MDPs",
            bonus.estimated_sum,
            mutant("an eighth of it", factor=0.125),
        ),
        covered(
            r"all rows, all counts up to 300 at once, $\delta_P = 1/10$",
            bonus.rows_are_covered,
            mutant("a third of the radius", scale=0.35),
        ),
        proved_step(
            r"$\sum_N1/(N(N+1)) = 1$ telescopes",
            bonus.weights_sum_to_one,
            mutant("weights 1/(N(N+2))", shift=2),
        ),
    ),
    proof=r"Weissman's inequality for each pair and count, with failure probability $\delta_P/(|\mathcal S||\mathcal "
    r"A|N(N+1))$. "
    r"Replacing the kernel step by step, $\operatorname{TV}(P^\pi, Q^\pi) \le "
    r"\frac12\sum_{h<H}\operatorname{E}_{Q^\pi}\lVert P - "
    r"Q\rVert_1(s_h, a_h)$, in both orders. For the last part take $f = \sum\epsilon \in [0, 2(H-1)]$: "
    r"$\operatorname{E}_{\hat P}f \le \operatorname{E}_{P^*}f + 2(H-1)\operatorname{TV} \le (1 + "
    r"(H-1))\operatorname{E}_{P^*}f$.",
    formulas=("bonus_radius", "transition_bonus", "estimated_radius_sum"),
)

C8 = Repair(
    name="C.8",
    title="the printed bonus, defined for every count",
    links=(
        link("it has no value at the counts that are defined anew", "undefined_counts"),
        link("the stitched bound for larger counts", "cited"),
    ),
    statement=r"$\xi := 2\eta$ for $N \le 1$, else as printed; for real transitions, a fixed policy and a fixed "
    r"function.",
    evidence=(
        proved_step(
            r"$\log(6\log N/\delta)$ has no real value at $N = 0$ and $N = 1$, the points defined anew",
            bonus.undefined_counts,
            mutant("N = 2 as well", counts=(0, 1, 2)),
        ),
        cited("Howard, Ramdas, McAuliffe, Sekhon (2021), stitched bound; quoted from memory"),
    ),
    proof=r"For $N \le 1$ the data say nothing and $\lvert f\rvert < \eta$ gives $2\eta$. For $N \ge 2$ the stitched "
    r"bound of "
    r"Howard et al. (cited) is smaller than the printed one.",
    formulas=("xi_repaired",),
)

_RELATION = proved_step(
    r"$\hat B \le \operatorname{E}f + B + \varepsilon$ and $\operatorname{E}f \le B$ give $\hat B \le 2B + "
    r"\varepsilon$; centring $f$ "
    r"gives the factor $1 + 1/H$",
    bonus.relation_of_bonuses,
    mutant("factor 1", factor=1),
)
_LINEAR = proved_step(
    r"$\xi(2\eta) = 2\xi(\eta)$",
    bonus.linear_in_eta,
    mutant("three times", factor=3),
)

_RELATION_LINKS = (
    link("the two inequalities give the stated one and the centred one", "relation_of_bonuses"),
    link("$\\xi$ is linear in $\\eta$", "linear_in_eta"),
    link("both inequalities hold for $f = \\sum\\xi$ on the uniform event"),
)
_RELATION_PROOF = (
    r"On the uniform event $\operatorname{E}_{\hat P}f \le \operatorname{E}_{P^*}f + B + \varepsilon$ for the random "
    r"function $f = \sum\xi$, whose values lie in $[0, 2H\eta]$; the left side is $\hat B$, "
    r"and $\operatorname{E}_{P^*}f \le B$ because $\xi$ grows with its failure probability and its scale."
)

CLAIMS = (
    Claim(
        label="local:pooled_transition_estimate_main",
        name="pooled counts, main text",
        topic="online",
        verdict="definition",
        statement=r"$\hat P_t(s'|s,a) = (N_{\text{off}}(s',s,a) + N_t(s',s,a))/(N_{\text{off}}(s,a) + N_t(s,a))$.",
        because="A definition; 0/0 for pairs without data, where any row will do (R6 has radius 2 there).",
        repairs=(R6,),
    ),
    Claim(
        label="local:count_estimator",
        name="count estimator",
        topic="online",
        verdict="definition",
        statement=r"$N(s,a)$ and $N(s'|s,a)$ count uses and transitions over $h \in [H]$; $\hat P = N(s'|s,a)/N(s,a)$.",
        because="A definition; both sums belong over $h \\le H-1$, see the next entry.",
    ),
    Claim(
        label="local:count_estimator",
        part="row sum",
        name="estimated rows are probability vectors",
        topic="online",
        verdict="false",
        statement=r"With both sums over $h \in [H]$, $\sum_{s'}\hat P(s'|s,a) = 1$ for every pair that was used.",
        because=r"A trajectory ends with $(s_H, a_H)$: the last use has no recorded successor.",
        evidence=(refuted("online-count-row"),),
        repairs=(R6,),
    ),
    Claim(
        label="eq:trans_count_est",
        name="pooled count estimator",
        topic="online",
        verdict="definition",
        statement=r"$\hat P_t(s'|s,a) = (N_{\text{off}}(s'|s,a) + N_t(s'|s,a))/(N_{\text{off}}(s,a) + N_t(s,a))$.",
        because="A definition, with the same conventions.",
        evidence=(
            text(
                "xi",
                "xi_repaired",
                "xi_bar",
                "bonus_radius",
                "estimated_radius_sum",
                "empirical_from_true_bonus",
                "empirical_from_true_bonus_sharp",
                "reach_size",
                "coverage_failure",
                "covered_bonus",
            ),
            agrees(
                "the bonuses of a policy are sums over occupancies and counts",
                transcription.tables,
                mutant("a thousandth more", factor=1.001),
            ),
        ),
    ),
    Claim(
        label="local:empirical_bonus_main",
        name="bonus of the main text",
        topic="online",
        verdict="undefined",
        statement=r"$\hat B_t(\pi,\eta,\delta) = \operatorname{E}_{\hat P_t^\pi}\sum_h\min(2\eta, "
        r"4\eta\sqrt{U_h/(N_{\text{off}} + "
        r"N_t)})$.",
        because=r"$U_h$ is not defined in the main text; the lemma it points to has no value at small counts and "
        r"contains the "
        "covering term of the true bonus.",
        evidence=(_UNDEFINED,),
        repairs=(R6, C8),
    ),
    Claim(
        label="lemma:moment_transition_difference_error",
        name="bonus for a fixed policy",
        topic="online",
        verdict="undefined",
        statement=r"With probability at least $1-\delta$, for all $t$: $\operatorname{E}_{P_*^\pi}f - "
        r"\operatorname{E}_{\hat P_t^\pi}f "
        r"\le \hat B_t(\pi,\eta,\delta)$ with $\xi = \min(2\eta, 4\eta\sqrt{(H\log(|\mathcal S||\mathcal A|) + "
        r"\log(6\log N/\delta))/N})$.",
        because=r"At $N = 0$ it divides by zero and at $N = 1$ it takes the logarithm of zero; the minimum does not "
        r"save it.",
        assumptions=("one fixed policy, one fixed function, transitions of the real stationary environment",),
        evidence=(_UNDEFINED,),
        repairs=(R6, C8),
    ),
    Claim(
        label="lemma:moment_transition_difference_error_uniform",
        name="bonus for all policies",
        topic="online",
        verdict="undefined",
        statement=r"The same for all policies, with $|\mathcal S|\log\lceil4\eta H/\varepsilon\rceil$ added under the "
        r"root and "
        r"$\varepsilon$ outside.",
        because="The same counts have no value. The cover is of value functions, not of policies, and so it also "
        "serves "
        "random functions, which the next lemma needs.",
        evidence=(_UNDEFINED,),
        repairs=(R6, C8),
    ),
    Claim(
        label="lemma:emp_bonus_to_true_bonus",
        name="empirical bonus by the true one",
        topic="online",
        verdict="true, proof wrong",
        statement=r"$\hat B_t(\pi,\eta,\delta) \le 2B_t(\pi,2H\eta,\delta,\varepsilon) + \varepsilon$ for all "
        r"policies and rounds.",
        because=r"The proof reads $-x \le c$ as $x \le c$ and uses the fixed-policy lemma in the wrong direction; the "
        r"second "
        "proof, in the last appendix, is right.",
        assumptions=(
            r"the uniform bonus lemma for the random function $f = \sum\xi$, with $\xi = 2\eta$ at $N \le 1$",
        ),
        links=_RELATION_LINKS,
        proof=_RELATION_PROOF,
        evidence=(_RELATION, _LINEAR),
        repairs=(R6,),
    ),
    Claim(
        label="lemma:bonus_relation",
        name="empirical bonus by the true one, again",
        topic="online",
        verdict="true",
        statement=r"$\hat B_t(\pi,\eta,\delta) \le 2B_t(\pi,2H\eta,\delta,\varepsilon) + \varepsilon$ for all "
        r"policies and rounds.",
        because=r"Uniformity for $f = \sum\xi$ and monotonicity of $\xi$; centring $f$ improves it to "
        r"$(1+\frac1H)B_t(\pi,H\eta,\delta,\varepsilon) + \varepsilon$.",
        assumptions=(
            r"the uniform bonus lemma for the random function $f = \sum\xi$, with $\xi = 2\eta$ at $N \le 1$",
        ),
        links=_RELATION_LINKS,
        proof=_RELATION_PROOF,
        evidence=(_RELATION, _LINEAR),
        repairs=(R6,),
    ),
    Claim(
        label="local:gamma_unknown",
        name="multiplier with unknown dynamics",
        topic="online",
        verdict="definition",
        statement=r"$\gamma_t = \sqrt2(4\kappa\beta_t + \alpha_{d,T}) + 2\sqrt{\sum_i\sum_{l<t}\hat B_l(\pi_l^i, 2WB, "
        r"\delta'/(8l^3|\mathcal A|^{|\mathcal S|}))^2} + 1/t$.",
        evidence=(
            text(
                "gamma_unknown",
                "gamma_unknown_repaired",
                "online_bonus_delta",
                "net_scale",
                "net_delta",
                "step_bonus_delta",
            ),
        ),
        because=r"A definition; $\delta'$ stands for two different numbers on the same page, and R2 needs none of it.",
    ),
    Claim(
        label="local:offline_bonus_xi",
        name="offline-enhanced bonus",
        topic="regret",
        verdict="undefined",
        statement=r"$\xi^{(t)} = \min(2\eta, 4\eta\sqrt{U/(N_{\text{off}} + N_t)})$, $U = H\log(|\mathcal S||\mathcal "
        r"A|H) + "
        r"|\mathcal S|\log(4\eta H/\varepsilon) + \log(6\log t/\delta)$.",
        because="In round 1 it takes the logarithm of zero.",
        evidence=(
            proved(
                r"$\log(6\log t/\delta)$ has no real value at $t = 1$",
                bonus.undefined_first_round,
                mutant("round 2", first=2),
            ),
        ),
        repairs=(R6,),
    ),
)
