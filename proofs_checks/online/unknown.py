"""The regret theorem with unknown dynamics: the main result, its decomposition and its three terms."""

from __future__ import annotations

from proofs_checks.claim import Claim, Repair, link
from proofs_checks.evidence import agrees, exact, mutant, proved_step, refuted, unsettled
from proofs_checks.online.bonuses import R6
from proofs_checks.online.checks import bonus, companions, containment, offline_gain, transcription
from proofs_checks.online.checks.transcription_regret import REGRET
from proofs_checks.online.containment import PRINTED_ALGORITHM, PRINTED_ALGORITHM_LINKS, R4, RUNS_UNKNOWN
from proofs_checks.online.evidence import FAMILY, directions, refuted_order, text, unbounded
from proofs_checks.online.known import R3, R5
from proofs_checks.online.matrices import SUPERMARTINGALE
from proofs_checks.online.offline_gain import R8, R10

R7 = Repair(
    name="R7",
    title="a-priori regret, unknown dynamics",
    statement=r"With $m = 2(H-1)$, $N_{\max} = (n+2T)(H-1)$, $L_T = 2(|\mathcal S|\log2 + \log(|\mathcal S||\mathcal "
    r"A|N_{\max}"
    r"(N_{\max}+1)/\delta_P))$ and $\Gamma_T = \frac{e}{e-1}[4m|\mathcal S||\mathcal A| + "
    r"2\sqrt{2L_T}\sqrt{2|\mathcal S||\mathcal A|"
    r"T(H-1)} + 2m\log\frac1{\delta_M}]$: with probability at least $1 - \delta_{\text{off}} - \delta_w - \delta_P - "
    r"\delta_F - "
    r"\delta_M$, $$R_T \le \min\Bigl\{2BWT\Delta_n,\ 4\kappa\beta_T\sqrt{T\Psi_T} + \Bigl(\frac{4\kappa\beta_TB}"
    r"{\sqrt{\kappa\lambda}} + 2BWH\Bigr)\Gamma_T\Bigr\}.$$",
    assumptions=("exact arg-max pairs after an exact projection", "the events of R1, R2, R5 and R6"),
    links=(
        link("the regret from widths and bonuses of the pairs played", R4),
        link("the widths, as with known dynamics", R5),
        link("the bonuses bound what the estimate changes", R6),
        link("radii that are frozen within a round sum to the stated order", "batches"),
        link("sums of conditional means stay below their sums, for all times", "means_are_dominated"),
        link("the trivial bound of the offline set", R8),
        link("Cauchy-Schwarz over the pairs, and the sum of all parts"),
    ),
    evidence=(
        exact(
            r"radii frozen within a round sum to at most $4m1\{N_{\text{off}}<m\} + "
            r"2\sqrt{2L}(\sqrt{N_{\text{off}}+N} - "
            r"\sqrt{N_{\text{off}}})$",
            bonus.batches,
            mutant("nothing for the first visits", first=0),
            mutant("without the 2 under the root", square=1),
        ),
        *SUPERMARTINGALE,
        *RUNS_UNKNOWN,
    ),
    proof=r"Start from $B_{\text{width}}$ of R4. Features under the estimate differ from the true ones by at most "
    r"$2B\operatorname{TV}$, "
    r"whose norm is at most $2B\operatorname{TV}/\sqrt{\kappa\lambda}$, and $b_t \le "
    r"BWH\operatorname{E}_{P^*}\sum\epsilon$ by R6. The "
    r"summed expectations are at most $\Gamma_T$: the supermartingale of R5 with $Z = \sum\epsilon/(2m)$, then for "
    r"each pair: "
    r"visits while $N_t < m$ are fewer than $2m$ and cost at most 2 each, later ones have $N_t \ge k/2$ at the $k$-th "
    r"transition and integrate to the difference of roots; Cauchy-Schwarz over the pairs.",
    formulas=("radius_sum", "radius_sum_covered", "regret_unknown_repaired", "regret_unknown_covered"),
)

_CLASSICAL = unsettled("no proof and no counterexample for trajectories of the real environment")

_MAIN_RESULT = (
    r"With probability at least $1-\delta$: $R_T \le \tilde O(\sqrt T\sqrt{\log(1+T/n)} + "
    r"\sqrt T/\sqrt{n\gamma_{\min}})$."
)

CLAIMS = (
    Claim(
        label="thm:main_simplified",
        name="main result",
        topic="regret",
        verdict="false",
        statement=_MAIN_RESULT,
        because="As printed, for the printed algorithm: line 8 samples trajectories from the estimate, which "
        "then never "
        r"learns better, and the regret is linear in $T$ with probability 2/5. What is left open is the theorem "
        r"for the "
        "algorithm with that line repaired, see the next entry.",
        links=PRINTED_ALGORITHM_LINKS,
        evidence=(refuted("online-sampling-from-the-estimate"),),
        repairs=(R7, R8),
        proof=PRINTED_ALGORITHM,
    ),
    Claim(
        label="thm:main_simplified",
        part="repaired algorithm",
        name="main result, trajectories of the real environment",
        topic="regret",
        verdict="open",
        statement=_MAIN_RESULT + " Here line 8 of the algorithm samples from the real environment.",
        because=r"Not proved by the paper. The order in $(T, n)$ holds as the minimum of R7 and of the trivial "
        r"bound R8, "
        "up to factors that depend on everything else.",
        evidence=(_CLASSICAL,),
        repairs=(R7, R8),
    ),
    Claim(
        label="thm:main_simplified",
        part="from the appendix",
        name="main result as a consequence of the appendix",
        topic="regret",
        verdict="false",
        statement=r"The appendix theorem implies it: Term 3's $\sqrt T\,n^{-1/4}$ is $\tilde O(\sqrt "
        r"T\sqrt{\log(1+T/n)} + "
        r"\sqrt T/\sqrt{n\gamma_{\min}})$.",
        because=r"The ratio grows like $n^{1/4}$.",
        links=refuted_order("online-simplified-rate"),
        proof=FAMILY["simplified rate"],
        evidence=(refuted("online-simplified-rate"), unbounded("simplified rate", r"as $n \to \infty$ with $T = 100$")),
        repairs=(R7,),
    ),
    Claim(
        label="thm:main_simplified",
        part="vanishing",
        name="regret vanishes as n grows",
        topic="regret",
        verdict="true, proof wrong",
        statement=r"For fixed $T$ the regret vanishes as $n \to \infty$.",
        because="True for any algorithm that stays in the offline set, by R8; the online stage plays no part in it.",
        links=(
            link("the trivial bound of the offline set, which vanishes with $n$", R8),
            link("for $n \\ge T$ the first term is of the same order", "growth_of_the_first_term"),
        ),
        evidence=(
            *R8.evidence[:3],
            proved_step(
                r"for $n \ge T$ the first term is between $0.83$ and $1$ times $T/\sqrt n$, the order of the trivial "
                r"bound",
                offline_gain.growth_of_the_first_term,
                mutant("nine tenths of T / sqrt n", constant="9/10"),
            ),
        ),
        repairs=(R8,),
    ),
    Claim(
        label="local:main_simplified_display",
        name="main result, display",
        topic="regret",
        verdict="false",
        statement=r"$R_T \le \tilde O(\sqrt T\sqrt{\log(1+T/n)} + \sqrt T/\sqrt{n\gamma_{\min}})$.",
        because="The display of the theorem above: false for the printed algorithm, open for the one with line "
        "8 repaired.",
        links=PRINTED_ALGORITHM_LINKS,
        evidence=(refuted("online-sampling-from-the-estimate"),),
        repairs=(R7, R8),
        proof=PRINTED_ALGORITHM,
    ),
    Claim(
        label="lemma:regret_analysis",
        name="regret in three terms",
        topic="regret",
        verdict="open",
        statement=r"On the five events: $R_T \le 2\gamma_T\sqrt{T\sum_t\lVert\delta\pi_t\rVert_{\overline V_t^{-1}}} + "
        r"\sum_i\sum_t\hat B_t(\pi_t^i, 4WB, \delta)$.",
        because="Without the square under the root the Cauchy-Schwarz step fails as soon as the norms average more "
        "than 1, "
        "and a sign of the decomposition is wrong; with the square the statement follows from R4's argument.",
        evidence=(
            unsettled("large norms need a small regulariser, for which no violation by the algorithm is known"),
            proved_step(
                r"$2r_t \le 4\gamma_t\lVert\delta\pi_t\rVert + 4(\hat B_1 + \hat B_2)$ at $\eta = 2WB$",
                containment.regret_with_bonuses,
                mutant("the paper's factors 1 and 8", norm_factor=1, bonus_factor=8),
            ),
            proved_step(
                r"$\hat B^2 \le 4B^2 + 48\varepsilon H^2WB$",
                containment.squared_bonus,
                mutant("without the second term", constant=0),
            ),
            proved_step(
                "Cauchy-Schwarz needs the squares",
                containment.cauchy_schwarz,
                mutant("without the squares", exponent=1),
            ),
        ),
        repairs=(R4,),
    ),
    Claim(
        label="lemma:regret_analysis",
        part="sign",
        name="decomposition of the regret of a round",
        topic="regret",
        verdict="false",
        statement=r"$2r_t = \langle\hat\phi^* - \hat\phi_1, w^*\rangle + \langle\hat\phi^* - \hat\phi_2, w^*\rangle + "
        r"2\langle\hat\phi^* - \phi^*, w^*\rangle + \langle\hat\phi_1 - \phi_1, w^*\rangle + \langle\hat\phi_2 - "
        r"\phi_2, w^*\rangle$.",
        because="The term of the best policy has the wrong sign; the next line of the proof uses the right one.",
        evidence=(refuted("online-decomposition-sign"),),
        repairs=(R4,),
    ),
    Claim(
        label="appdx:thm:bridge_regret",
        name="regret with unknown dynamics",
        topic="regret",
        verdict="open",
        statement=r"$R_T \le 2\gamma_T\sqrt{T\log(1 + \tilde O(\cdot)/d)} + \tilde O(\text{Term 3})$, explicitly in "
        r"$n$ and "
        r"$\gamma_{\min}$.",
        because="Each of its three terms rests on a false lemma below; the statement itself is neither proved nor "
        "refuted.",
        evidence=(_CLASSICAL,),
        repairs=(R7, R8),
    ),
    Claim(
        label="local:three_terms",
        name="the three terms",
        topic="regret",
        verdict="definition",
        statement=r"Term 1 $= \gamma_T$, Term 2 $= \sqrt{T\sum_t\lVert\delta\pi_t\rVert_{\overline V_t^{-1}}}$, Term 3 "
        r"$= \sum_i\sum_t\hat B_t(\pi_t^i, 4WB, \delta)$.",
        because="Names for the parts of the decomposition; the square is missing in Term 2.",
        evidence=(
            text(*REGRET),
            directions("regret"),
            agrees(
                "the formulas are defined up to the limits of their statements and not beyond",
                transcription.edges,
                mutant("limits in the other direction", shift=-1e-6),
            ),
            agrees(
                "trivial values and failure probabilities of the formulas agree with their text",
                companions.companions,
                mutant("a thousandth more", factor=1.001),
            ),
        ),
        repairs=(R4,),
    ),
    Claim(
        label="lemma:term_1_asymptotic_bound",
        name="order of Term 1",
        topic="regret",
        verdict="open",
        statement=r"$\gamma_T = \tilde O((\kappa+BW)\sqrt{d\log T} + H^2WB|\mathcal S|\sqrt{\min\{\log T, "
        r"T/(n\gamma_{\min})\}} + "
        r"\sqrt{T\varepsilon H^2WB})$.",
        because=r"It inherits the false lemma on squared bonuses and drops $\kappa\sqrt\lambda W$ and "
        r"$\log(1/\delta)$.",
        evidence=(_CLASSICAL,),
        repairs=(R7, R10),
    ),
    Claim(
        label="lemma:offline_bonus_bound",
        name="sum of squared bonuses",
        topic="regret",
        verdict="false",
        statement=r"With probability at least $1-2\delta'$: $\sum_t\sum_{h<H}\xi^2 \le "
        r"32\eta^2V|S_{\text{reach}}|\log(1 + "
        r"T/(n\gamma_{\min}))$.",
        because="Pairs that the expert never uses keep the largest bonus however large n is, and the algorithm is "
        "drawn to "
        "them while the offline set allows it.",
        evidence=(refuted("online-uncovered-bonuses"),),
        repairs=(R10, R7),
    ),
    Claim(
        label="lemma:offline_squared_bonus_bound",
        name="sum of squared true bonuses",
        topic="regret",
        verdict="open",
        statement=r"$\sum_i\sum_{l<t}B_l(\pi_l^i, \eta, \delta/l^3, \varepsilon)^2 \le 12\eta^2H^2(\cdot) + "
        r"64\eta^2H|S_{\text{reach}}|\log(1 + T/(n\gamma_{\min}))(\cdot)$ for all $t$, with probability at least "
        r"$1-2\delta'$.",
        because="The proof uses expectations under the estimate as martingale differences, drops a factor 2 and uses "
        "the false "
        "lemma above.",
        evidence=(unsettled("no counterexample with all its terms is stored"),),
        repairs=(R10, R7),
    ),
    Claim(
        label="lem:asymptotic_offline_squared_bonus",
        name="order of the squared bonuses",
        topic="regret",
        verdict="false",
        statement=r"$\sum_i\sum_{l<t}B_l(\pi_l^i)^2 \le \tilde O(\eta^2H^2|\mathcal S|^2\min\{\log T, "
        r"T/(n\gamma_{\min})\})$.",
        because="Actions without demonstrations cost a constant each; the first term of the lemma before does not "
        "fall with n "
        "either.",
        links=refuted_order("online-squared-bonus-rate"),
        proof=FAMILY["squared bonuses"],
        evidence=(
            refuted("online-squared-bonus-rate"),
            unbounded("squared bonuses", r"as $T \to \infty$ with $2T+1$ actions, where the left side is $4(T-1)$"),
        ),
        repairs=(R10,),
    ),
    Claim(
        label="lemma:term_2_asymptotic_bound",
        name="order of Term 2",
        topic="regret",
        verdict="false",
        statement=r"$\sqrt{T\sum_t\lVert\delta\pi_t\rVert_{\overline V_t^{-1}}} \le \sqrt{T\log(1 + \tilde "
        r"O(\cdot)/d)}$.",
        because=r"The potential bounds the sum of squares, not of norms, and the factor $2d$ is missing.",
        links=refuted_order("online-term-2"),
        proof=FAMILY["term 2"],
        evidence=(
            refuted("online-term-2"),
            unbounded(
                "term 2",
                r"as $T \to \infty$ with $W = 1/\sqrt T$, $B = 1/2$, where both actions are compared in every round",
            ),
        ),
        repairs=(R3,),
    ),
    Claim(
        label="lemma:term_2_asymptotic_bound",
        part="three squares",
        name="splitting the feature difference",
        topic="regret",
        verdict="false",
        statement=r"$\lVert\delta\pi_t\rVert^2 \le 2\lVert\hat\phi_t(\pi) - \hat\phi_0(\pi)\rVert^2 + "
        r"\lVert\hat\phi_0(\pi^1) - "
        r"\hat\phi_0(\pi^2)\rVert^2$.",
        because="Three vectors need the factor 3, and one term has the wrong sign.",
        evidence=(refuted("online-three-squares"),),
        repairs=(
            Repair(
                name="D.8",
                title="three squares",
                statement=r"$\lVert a + b + c\rVert^2 \le 3(\lVert a\rVert^2 + \lVert b\rVert^2 + \lVert c\rVert^2)$.",
                links=(link("one coordinate", "three_terms"), link("the sum over the coordinates")),
                evidence=(proved_step("coordinatewise", bonus.three_terms, mutant("factor 2", factor=2)),),
                proof="Cauchy-Schwarz with three ones.",
            ),
        ),
    ),
    Claim(
        label="lemma:term_2_asymptotic_bound",
        part="offline diameter",
        name="diameter of the offline set",
        topic="regret",
        verdict="false",
        statement=r"$\lVert\hat\phi_0(\pi^1) - \hat\phi_0(\pi^2)\rVert^2 \le 4RB^2$ with the radius $R$.",
        because="The radius must be squared: two policies of the ball may be at distance 2R.",
        evidence=(refuted("online-offline-diameter"),),
        repairs=(R8,),
    ),
    Claim(
        label="lemma:term_2_asymptotic_bound",
        part="drift sum",
        name="sum of the drifts",
        topic="regret",
        verdict="false",
        statement=r"$\sum_{t\le T}\frac{t}{n(n+t)} = O(\min\{T/n, \log T\})$.",
        because=r"The sum is $T/n - (H_{n+T} - H_n)$, of the order $T/n$ when $T$ is larger than $n$.",
        links=refuted_order("online-drift-sum"),
        proof=FAMILY["drift sum"],
        evidence=(
            refuted("online-drift-sum"),
            unbounded("drift sum", r"as $T \to \infty$ with $n = 1$, where the sum is at least $T/2$"),
        ),
    ),
    Claim(
        label="lemma:bound_on_feature_expectation_difference",
        name="drift of the estimated features",
        topic="regret",
        verdict="open",
        statement=r"$\lVert\phi^{\hat P_t}(\pi) - \phi^{\hat P_0}(\pi)\rVert^2 \le O(B^2H|\mathcal "
        r"S|^2\log(\cdot)C_T^2(\frac{t}{(n+t)^2} "
        r"+ \frac{t^2}{(n+t)^2n}))$.",
        because=r"$C_T$ has no value where the policy leaves the expert's support, and the proof needs visits online "
        r"that nothing "
        "guarantees; its algebra is right.",
        evidence=(
            unsettled("true under coverage of every pair the policy uses, offline and online"),
            proved_step(
                r"$\frac{t}{(n+t)^2} + \frac{t^2}{(n+t)^2n} = \frac{t}{n(n+t)}$ and its sum is $T/n - (H_{n+T} - H_n)$",
                bonus.drift_identity,
                mutant("t instead of t squared", power=1),
            ),
        ),
        repairs=(R6,),
    ),
    Claim(
        label="lemma:term_3_asymptotic_bound",
        name="order of Term 3",
        topic="regret",
        verdict="open",
        statement=r"$\sum_t4\hat B_t(\pi_t^1) + 4\hat B_t(\pi_t^2) \le \tilde O(H|\mathcal S|\sqrt{|\mathcal "
        r"A|TH/(n\gamma_{\min})} + "
        r"H^{5/2}WB\sqrt{T/(n\gamma_{\min})} + H^2WBT\sqrt{\log T}|\mathcal S|^{1/2}|\mathcal A|^{1/4}n^{-1/4})$.",
        because=r"It rests on false lemmas, and its last part has $T\sqrt{\log T}$ where the theorem has $\sqrt T$.",
        evidence=(_CLASSICAL,),
        repairs=(R7, R10),
    ),
    Claim(
        label="lemma:offline_bonus_sum",
        name="sum of the played bonuses",
        topic="regret",
        verdict="open",
        statement=r"$\sum_t8B_t(\pi_t^1) + 8B_t(\pi_t^2) \le 2048HWB\sqrt "
        r"V|S_{\text{reach}}|\sqrt{T/(n\gamma_{\min})} + "
        r"\tilde O(\cdot)$.",
        because="It rests on the false lemma on bonuses and on the unproved martingale lemma.",
        evidence=(_CLASSICAL,),
        repairs=(R7, R10),
    ),
    Claim(
        label="thm:offline_nonsquared_bound",
        name="sum of bonuses",
        topic="regret",
        verdict="false",
        statement=r"$\sum_t\sum_{h<H}\xi \le 64HWB\sqrt V|S_{\text{reach}}|\,2\sqrt{T/(n\gamma_{\min})}$.",
        because=r"$\sqrt{N_{\text{off}}}$ is dropped after $2\sqrt{N_{\text{off}}+N} \le "
        r"2\sqrt{N/N_{\text{off}}}\sqrt{N_{\text{off}}}$; "
        r"the sum is of the order $T/\sqrt n$, not $\sqrt{T/n}$.",
        evidence=(refuted("online-covered-bonuses"),),
        repairs=(R10, R7),
    ),
    Claim(
        label="lem:martingale_concentration_with_offline_data",
        name="martingale with offline data",
        topic="regret",
        verdict="open",
        statement=r"$\lvert\sum_tX_t\rvert \le \tilde O(H^{5/2}WB\sqrt{T/(n\gamma_{\min})} + H^2WB\sqrt T|\mathcal "
        r"S|^{1/2}"
        r"|\mathcal A|^{1/4}n^{-1/4})$.",
        because="The proof conditions on an event, which destroys the martingale property, and takes the probability "
        "of missing "
        "coverage from a bound on the transition estimate; inside the offline set the order can be saved by Freedman's "
        "inequality with R10.",
        evidence=(_CLASSICAL,),
        repairs=(R10,),
    ),
)
