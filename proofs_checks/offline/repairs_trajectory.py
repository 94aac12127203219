"""T1 to T5: what replaces the steps of the paper's technical lemma and its concentrability bound."""

from __future__ import annotations

from fractions import Fraction

from bridge_theory import concentrability_deterministic, concentrability_stated
from proofs_checks.claim import Repair, link
from proofs_checks.evidence import exact, mutant, proved_step
from proofs_checks.kernel.evidence import theorem
from proofs_checks.offline.checks import (
    concentrability,
    distances,
    kl_budget,
    rare_chain,
    subadditivity,
    trajectory_error,
)
from proofs_checks.offline.evidence import coq

_COMMON = ("both laws share the policy and the law of the first state",)

TV = Repair(
    name="TV",
    title="total variation by Hellinger",
    statement=r"$H^2 \le \operatorname{TV} \le \sqrt{H^2(2 - H^2)}$ for all finite laws.",
    links=(
        link("the upper bound", "total_variation_by_hellinger", "total_variation_against_hellinger"),
        link("the lower bound", "hellinger_below_total_variation", "total_variation_against_hellinger"),
    ),
    evidence=(
        exact(
            "both inequalities on generated pairs of finite laws, in exact algebra",
            distances.total_variation_against_hellinger,
            mutant("ceiling 1 instead of 2, the paper's inequality", ceiling=1),
            mutant("twice the floor", floor=2),
        ),
        coq(
            "the upper bound for all finite laws",
            "total_variation",
            "total_variation_by_hellinger",
            "1 instead of 2, the paper's inequality",
            "squared_hellinger * (2 - squared_hellinger).",
            "squared_hellinger * (1 - squared_hellinger).",
        ),
        coq(
            "the lower bound for all finite laws",
            "total_variation",
            "hellinger_below_total_variation",
            "half of the total variation",
            "squared_hellinger <= total_variation.",
            "squared_hellinger <= / 2 * total_variation.",
        ),
    ),
    proof=r"""$\operatorname{TV} = \frac12\sum|\sqrt p - \sqrt q|(\sqrt p + \sqrt q)$, and by Cauchy-Schwarz
        $\operatorname{TV}^2 \le \frac14\sum(\sqrt p - \sqrt q)^2\sum(\sqrt p + \sqrt q)^2 = \frac14 (2H^2)(4 -
        2H^2)$. For the other side, $\sum\sqrt{pq} \ge \sum\min(p, q) = 1 - \operatorname{TV}$. Two reversed coins
        attain the upper bound.""",
)

T1 = Repair(
    name="T1",
    title="trajectory error as a sum of row errors",
    statement=r"""Let $g_t(s,a)$ be the sum of $\sqrt{\hat P P_*}$ over all prefixes that end in $(s_t, a_t) = (s,
        a)$, and $h(s,a) = H^2(\hat P(\cdot|s,a), P_*(\cdot|s,a))$. Then $$H^2(\hat P^\pi, P_*^\pi) = \sum_t\sum_{s,a}
        g_t(s,a)\,h(s,a) \le \frac12\sum_t\bigl(\operatorname{E}_{\hat d_t}[h] + \operatorname{E}_{d_t}[h]\bigr).$$""",
    assumptions=_COMMON,
    links=(
        link(r"the identity and $g_t \le \sqrt{\hat d_t d_t}$", "trajectory_error_identity", "identity"),
        link("the inequality, with the mean of both occupancies", "trajectory_error_symmetrised", "symmetrised_bound"),
    ),
    evidence=(
        theorem("trajectory_error_identity"),
        theorem("trajectory_error_symmetrised"),
        exact(
            r"the identity and $g_t \le \sqrt{\hat d_t d_t}$ on generated kernels and stochastic policies",
            trajectory_error.identity,
            mutant("nine tenths of every row error", weight=Fraction(9, 10)),
        ),
        exact(
            "the inequality, by the formula of bridge_theory",
            trajectory_error.symmetrised_bound,
            mutant("without the occupancy under the truth", share=Fraction(0)),
        ),
    ),
    proof=r"""Let $b_t$ be the total of $g_t$. Extending a prefix by one transition multiplies its weight by
        $\sqrt{\hat P P_*}$, whose sum over the next state is $1 - h$; so $b_{t+1} = b_t - \sum g_t h$. The sum
        telescopes from $b_1 = 1$ to the Bhattacharyya coefficient. Cauchy-Schwarz over prefixes gives $g_t \le
        \sqrt{\hat d_t d_t} \le (\hat d_t + d_t)/2$.""",
    formulas=("trajectory_error_symmetrised",),
)

T2 = Repair(
    name="T2",
    title="trajectory error from one occupancy",
    statement=r"""$H^2(\hat P^\pi, P_*^\pi) \le 2.97\sum_t\operatorname{E}_{d_t}[h_t]$ with the occupancies under
        either of the two kernels. The best constant lies between 2.9615 and 2.97.""",
    assumptions=_COMMON,
    links=(
        link("the displayed inequality for every pair of pieces, with constant 297/100", "induction_step"),
        link("the induction over the steps that turns it into the statement", "one_sided_bound"),
        link("no constant below 2 serves all horizons", "long_chains"),
    ),
    evidence=(
        proved_step(
            "the induction step with constant 2.97: polynomial inequalities, each unsatisfiable when negated (Z3)",
            subadditivity.induction_step,
            mutant("constant 2.96, with its own joined curve", constant=Fraction(296, 100)),
            mutant("constant 2", constant=Fraction(2)),
        ),
        proved_step(
            "the same with constant 4, with a simpler function",
            subadditivity.induction_step,
            mutant("constant 2", constant=Fraction(2)),
            constant=Fraction(4),
        ),
        exact(
            "the inequality under both occupancies, by the formula of bridge_theory",
            trajectory_error.one_sided_bound,
            mutant("a third of the occupancy", share=Fraction(1, 3)),
        ),
        exact(
            r"chains of $T$ steps with ratio exactly $2T/(T + 1)$",
            trajectory_error.long_chains,
            mutant("constant 9/5", constant=Fraction(9, 5)),
        ),
        exact(
            r"two-step chains whose ratio approaches $1 + 1/\sqrt2$",
            trajectory_error.two_step_ratio,
            mutant("constant 17/10", constant=Fraction(17, 10)),
        ),
        exact(
            "from below: a chain of 3002 steps after an event of probability 1e-6 has a ratio above 2.9615",
            rare_chain.rare_event_ratio,
            mutant("a ratio above 2.97, which is proved to be impossible", least=Fraction(297, 100)),
            mutant("laws that part after nine tenths of the overlap", kept=Fraction(9, 10)),
        ),
    ),
    proof=r"""Let $V_T(w)$ be the largest value of $-(w\,\mathrm{BC} + \Sigma)$ over pairs of $T$-step laws, $\Sigma$
        the sum. $V_0(w) = -w$, and with $t = \sqrt{q/p}$ of the first step $V_{T+1}(w) \le -1 +
        \max\{\operatorname{E}_p[t + V_T(wt)] : \operatorname{E}_p t^2 \le 1\}$.

        Suppose that $V \ge -w$, $wV' \ge -1$ and, for all $w > 0$ and $r \ge 0$, $$V(wr) \le V(w) +
        \frac{wV'(w)}{2}(r^2 - 1) + \frac{(r - 1)^2}{2}.$$ Then $\operatorname{E}[t + V(wt)] \le V(w) + \frac12 + (p +
        \frac12)\operatorname{E}t^2 - p \le V(w) + 1$ with $p = wV'(w)/2$, so that $V_T \le V$ for all $T$ by
        induction. If also $V(1/c) = -1/c$, then $\mathrm{BC}/c + \Sigma \ge 1/c$, that is, $H^2 \le c\,\Sigma$.

        For $c = 297/100$ take $V = -w$ up to $1/c$, $-\frac12 + \frac{42}{125}v^3 + \frac3{20}v^4 + a_6v^6 + a_9v^9$
        with $v = 1 - w$ up to 1, where $V(1/c) = -1/c$ and $V'(1/c) = -1$ give $a_6 =
        \frac{8337988777706181}{29225864154564500}$ and $a_9 =
        \frac{53548284568310021115153}{111721316354487627529250}$, and $-\frac12$ beyond; for $c = 4$ the middle piece
        is $-\frac12 + \frac{16}{27}v^3$ from $1/4$ on. The displayed inequality is then polynomial on each pair of
        pieces. With both arguments in the middle piece the two sides differ by $(wr - w)^2$ times a polynomial that
        rises in $wr$, because every coefficient is positive; so $wr = 1/c$ is the worst case.

        From below: the induction is nearly tight along a chain entered by a rare event and left slowly.""",
    formulas=("trajectory_error_one_sided",),
)

T3 = Repair(
    name="T3",
    title="trajectory error from KL divergences",
    statement=r"""$\mathrm{KL}(\hat P^\pi\|P_*^\pi) = \sum_t\operatorname{E}_{\hat d_t}[\mathrm{KL}(\hat
        P\|P_*)(s_t,a_t)]$ and $H^2 \le 1 - \exp(-\mathrm{KL}/2)$. If the estimate uses pairs without data with
        probability $p < 1$ and $K$ is the expected sum before that, then $H^2 \le 1 - (1-p)\exp\bigl(-\frac{K +
        p\log(1/p)}{2(1-p)}\bigr)$.""",
    assumptions=_COMMON,
    links=(
        link("the chain rule, and the inequality without exits", "chain_rule"),
        link("the inequality with exits", "exits"),
    ),
    evidence=(
        exact(
            "the chain rule to 360 digits, and the inequality, on generated kernels",
            kl_budget.chain_rule,
            mutant("half of every row", weight=Fraction(1, 2)),
        ),
        exact(
            r"the formula is attained: $P = Q$ given an event",
            kl_budget.half_is_needed,
            mutant("exponent KL instead of KL/2", half=Fraction(1)),
        ),
        exact(
            "the form with exits, beyond which the truth may be anything",
            kl_budget.exits,
            mutant("no exit mass", forgotten=Fraction(1)),
        ),
    ),
    proof=r"""The chain rule of the logarithm. $\mathrm{BC} = \operatorname{E}_{\hat P}\sqrt{P_*/\hat P} \ge
        \exp(-\mathrm{KL}/2)$ by Jensen. With exits restrict the expectation to trajectories without one, apply Jensen
        there, and bound the part of the KL divergence that lies on the others by the log-sum inequality: it is at
        least $p\log p$.""",
    formulas=("hellinger_from_kl", "hellinger_from_kl_with_exits"),
)

T4 = Repair(
    name="T4",
    title="row errors from the trajectory error",
    statement=r"""With $u = H^2(\hat P^{\pi^*}, P_*^{\pi^*})$ and $T$ transitions: $\operatorname{E}_{d_t^*}[h_t] \le
        u(2 - u)$ at every step and $\sum_t\operatorname{E}_{d_t^*}[h_t] \le u(1 + (T-1)(2 - u))$; both are attained
        for every $u$.""",
    assumptions=_COMMON,
    links=(
        link("the bound at one step", "row_error_at_step"),
        link("the sum over the steps", "row_error_summed", "row_errors_from_trajectories"),
        link("both bounds are attained", "row_errors_are_attained"),
    ),
    evidence=(
        theorem("row_error_at_step"),
        theorem("row_error_summed"),
        exact(
            "both inequalities on generated kernels and policies, in exact algebra",
            trajectory_error.row_errors_from_trajectories,
            mutant("u (1 - u) instead of u (2 - u)", ceiling=1),
        ),
        exact(
            "both are equalities on a two-branch chain, by the formulas of bridge_theory",
            trajectory_error.row_errors_are_attained,
            mutant("one step more", extra_steps=1),
        ),
    ),
    proof=r"""For a pair $(X, Y)$: $\mathrm{BC} = \sum\sqrt{pq}\,(1 - h_x) \le \sqrt{\operatorname{E}_p(1-h)^2} \le
        \sqrt{1 - \operatorname{E}_p h}$, since $(1-h)^2 \le 1 - h$. So $\operatorname{E}_p h \le 1 - (1 - H^2)^2 =
        u(2-u)$; data processing to (prefix, next state) gives the step bound. At the first step the law of the prefix
        is common, so $\operatorname{E}h_1 \le u$.""",
    formulas=("row_error_at_step", "row_error_summed"),
)

T5 = Repair(
    name="T5",
    title="sharp concentrability",
    statement=r"""If $H^2(P_*^\pi, P_*^{\pi^*}) \le R \le 1$ and $d^* \ge \gamma$ wherever it is positive, then $d/d^*
        \le \bigl(1 - R + \sqrt{R(2-R)(1-\gamma)/\gamma}\bigr)^2$ for $\gamma \le (1-R)^2$, and $d/d^* \le 1/\gamma$
        beyond. It is attained for $\gamma \le 1/2$, and is at most $1 + \sqrt{2R}/\gamma \le 1 + 2\sqrt R/\gamma$.
        For deterministic policies $d/d^* \le 1 + R/\gamma$.""",
    links=(
        link("data processing to the event that the pair occurs, for all policies", "holds_for_all_policies"),
        link("the two-point inequality behind the sharp form", "two_point_inequality"),
        link("the two weaker forms, for every $R$ and $\\gamma$ in $(0, 1]$", "weaker_forms"),
        link("the form for deterministic policies", "holds_for_deterministic_policies"),
        link(r"the sharp form is attained for $\gamma \le 1/2$", "attained_by_two_actions"),
    ),
    evidence=(
        proved_step(
            "the two-point inequality behind it, without angles (Z3)",
            concentrability.two_point_inequality,
            mutant("a smaller sine", slack=1),
        ),
        proved_step(
            r"it is below $1 + \sqrt{2R}/\gamma$ and $1 + 2\sqrt R/\gamma$ (Z3)",
            concentrability.weaker_forms,
            mutant("factor 1 instead of 2", factor=Fraction(1)),
        ),
        exact(
            "generated stochastic and history-dependent policies, by the formula of bridge_theory",
            concentrability.holds_for_all_policies,
            mutant("a third of the distance", share=Fraction(1, 3)),
            mutant("the deterministic form for all policies", formula=concentrability_deterministic),
        ),
        exact(
            r"one-step pairs with rational roots attain it, for example $225/49$ at $R = 8/125$",
            concentrability.attained_by_two_actions,
            mutant("a millionth more", shift=Fraction(1, 10**6)),
        ),
        exact(
            r"$C \le 1 + R/\gamma$ for generated deterministic policies",
            concentrability.holds_for_deterministic_policies,
            mutant("without the distance", share=Fraction(0)),
        ),
        exact(
            r"$C = 1 + R/\gamma$ is attained on a two-step model",
            concentrability.deterministic_is_attained,
            mutant("distance 1/5 instead of 1/4", moved=Fraction(1, 5)),
        ),
    ),
    proof=r"""Data processing to the event that the pair occurs at the step: $\sqrt{dd^*} + \sqrt{(1-d)(1-d^*)} \ge 1
        - R$, so the angles with $\sin^2\theta = d$ differ by at most $\omega = \arccos(1-R)$. Hence $d/d^* \le
        (\cos\omega + \cot\theta^*\sin\omega)^2$, which falls with $\theta^*$; where $\theta^* + \omega$ exceeds a
        right angle use $d \le 1$.

        Deterministic policies have equal laws until they first disagree, so that $|d - d^*| \le R$.""",
    formulas=("concentrability_sharp", "concentrability_deterministic"),
)

STATED_CONCENTRABILITY_LINKS = (
    link("the sharp bound T5 on the coefficient", T5),
    link(r"the sharp bound is below the stated one for every $R$ and $\gamma$ in $(0, 1]$", "weaker_forms"),
)
STATED_CONCENTRABILITY = (
    proved_step(
        r"the sharp bound is below $1 + 2\sqrt R/\gamma$ for every $R$ and $\gamma$ in $(0, 1]$ (Z3)",
        concentrability.weaker_forms,
        mutant("factor 1 instead of 2", factor=Fraction(1)),
    ),
    proved_step(
        r"the formulas of bridge_theory in this order on a box of $(R, \gamma)$ (balls)",
        concentrability.sharp_below_stated,
        mutant("half of the stated bound", factor=Fraction(1, 2)),
        full_only=True,
    ),
    exact(
        "generated policies, by the stated formula",
        concentrability.holds_for_all_policies,
        mutant("distance 0", share=Fraction(0)),
        formula=concentrability_stated,
    ),
)
