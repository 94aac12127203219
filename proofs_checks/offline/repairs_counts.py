"""T10 to T14: what counts certify, covers, moments, stochastic experts, and exact computation."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.claim import Repair, link
from proofs_checks.evidence import agrees, covered, exact, mutant, proved_step
from proofs_checks.offline.checks import coverage, covering, kl_budget, moments, zero_radius
from proofs_checks.offline.repairs_policy import T6_COVER
from proofs_checks.offline.repairs_trajectory import T3

T10 = Repair(
    name="T10",
    title="transition error from the counts",
    statement=r"""With probability $1-\delta$, at all times and for adaptively chosen pairs at once,
        $\sum_{s,a}N_{sa}\mathrm{KL}(\hat P_{sa}\|P^*_{sa}) \le \mathcal B = \sum_{s,a}\log\binom{N_{sa}+|S|-1}{|S|-1}
        + \log(1/\delta)$. Hence $\mathrm{KL}(\hat P^\pi\|P_*^\pi) \le \mathcal B\max\hat m/N$ for policies that stay
        on pairs with data, and for step-wise counts with a deterministic expert $H^2(\hat P^{\pi^*}, P_*^{\pi^*}) \le
        1 - e^{-\mathcal B/(2n)}$, the first state being one more cell.""",
    assumptions=("each row of the kernel is stationary", "$N$ counts the transitions used"),
    links=(
        link("the mixture is a law and dominates the maximised likelihood", "laplace_mixture"),
        link("one row stays within the budget for ever, by Ville", "crossing_probability"),
        link("all rows at once, for pairs chosen adaptively", "transition_budget"),
        link("visits under the step-wise estimate are the counts", "visits_equal_counts"),
        link("the maximum over policies that stay on pairs with data, by duality", "trajectory_divergence"),
        link("from the divergence to the Hellinger error", T3),
    ),
    evidence=(
        exact(
            "the mixture is a law and dominates the maximised likelihood over the binomial, on generated counts",
            kl_budget.laplace_mixture,
            mutant("a smaller binomial", states=1),
        ),
        exact(
            "the probability of ever crossing, by a dynamic programme over exact counts of a coin",
            kl_budget.crossing_probability,
            mutant("a tenth of the budget", shrink=Fraction(1, 10)),
        ),
        exact(
            "expected visits under the step-wise estimate are the counts over n",
            kl_budget.visits_equal_counts,
            mutant("one count more", offset=1),
        ),
        covered(
            "the budget at every time, with pairs chosen adaptively",
            coverage.transition_budget,
            mutant("a hundredth of the budget", shrink=0.01),
        ),
        covered(
            "the Hellinger error of step-wise counts",
            coverage.step_wise_transition_error,
            mutant("a hundredth of the bound", shrink=0.01),
        ),
        covered(
            "the trajectory divergence of a stationary count estimate",
            coverage.trajectory_divergence,
            mutant("a thousandth of the bound", shrink=0.001),
        ),
    ),
    proof=r"""The Laplace mixture $Q(x^N) = \prod_i n_i!\,(|S|-1)!/(N+|S|-1)!$ over the true likelihood is a
        nonnegative supermartingale of mean at most 1 for each row, and so is the product over rows; Ville's
        inequality. As a multinomial coefficient is at most $e^{N\,\mathrm{entropy}}$, $Q/P^* \ge
        e^{N\mathrm{KL}}/\binom{N+|S|-1}{|S|-1}$. Then T3, and linear programming duality for the maximum.""",
    formulas=("transition_kl_budget", "trajectory_kl", "transition_error_counts"),
)

T11 = Repair(
    name="T11",
    title="covers of transition kernels",
    statement=r"""With $m = \lceil(|S|-1)/(e^\varepsilon-1)\rceil$, $\log\mathcal N_{trans}(\varepsilon) \le
        |S||A|\log\binom{m+2|S|-2}{|S|-1} \le |S||A|(|S|-1)\log\bigl(e(1/(e^\varepsilon-1)+3)\bigr)$; one row of two
        states needs exactly $\lceil 1/(e^\varepsilon-1)\rceil$ elements. With T6 and $D = |S||A|(|S|-1)$, $H^2(\hat
        P^{\pi^*}, P_*^{\pi^*}) \le \frac{2D}{n}[\log(nH/D+3)+2] + \frac{2\log(1/\delta)}{n}$, which is at most
        $4|S|^2|A|\log(nH/\delta)/n$ whenever that is below 1 and $nH \ge 2$ or $\delta \le 1/2$.""",
    links=(
        link("the lattice covers every row", "lattice_covers"),
        link("the number of its points", "lattice_count"),
        link(r"$(m+2|S|-2)/(|S|-1) \le 1/(e^\varepsilon-1)+3$", "stirling_step"),
        link(r"$\binom ab \le (ea/b)^b$, and with it the closed form"),
        link("two states need exactly as many elements as stated", "two_states"),
        link("the error of maximum likelihood over a cover", T6_COVER),
        link("the corollary's bound says nothing below 68 demonstrations", "corollary_start"),
        link("the corollary's bound is the larger one from 68 on", "corollary_tail"),
        link(r"$D \le |S|^2|A|$", "dimension_is_below"),
    ),
    evidence=(
        exact(
            "the lattice covers generated rows",
            covering.lattice_covers,
            mutant("one numerator less", extra=-1),
        ),
        exact(
            "the number of lattice points, enumerated, against both formulas",
            covering.lattice_count,
            mutant("denominator plus 1", offset=1),
        ),
        exact(
            "two states: the cover, its minimality, and the paper's lemma, at rational scales",
            covering.two_states,
            mutant("one element fewer", fewer=1),
        ),
        exact(
            "three states: a lower bound by points no two of which share an element",
            covering.packing_bound,
            mutant("elements twice as wide", stretch=Fraction(2)),
        ),
        proved_step(
            r"$(m+2|S|-2)/(|S|-1) \le 1/(e^\varepsilon-1)+3$ (Z3)",
            covering.stirling_step,
            mutant("2 instead of 3", base=Fraction(2)),
        ),
        proved_step(
            r"$2\log x \ge \log(x/2+3)+2$ for all $x \ge 68$: balls at 68, Z3 for the slope beyond",
            covering.corollary_tail,
            mutant("from 2 on", at=2),
        ),
        proved_step(
            "the stated bound is vacuous for every n up to 67 (balls, each n)",
            covering.corollary_start,
            mutant("up to 79", least=80),
        ),
        proved_step(r"$D \le |S|^2|A|$ (Z3)", covering.dimension_is_below, mutant("at most S A", power=1)),
        exact(
            "the proved bounds are below the stated one on a grid where it is informative",
            covering.closed_form_below_stated,
            mutant("a quarter of the stated bound", factor=Fraction(1, 4)),
        ),
        agrees(
            "the minimum over the lattice equals brute force",
            covering.covering_number_grid,
            mutant("no number is its own minimum", slack=-1.0),
        ),
    ),
    proof=r"""Take integers $c_i \ge \lceil mp_i\rceil$ with sum $M = m + |S| - 1$ and $q_i = c_i/M$: then $p_i/q_i
        \le M/m \le e^\varepsilon$. There are $\binom{m+2|S|-2}{|S|-1}$ such vectors, and $\binom ab \le (ea/b)^b$.

        For the corollary take $\varepsilon = D/n$ in T6. With $|S| \ge 2$ the stated bound is at least $16\log n/n$,
        so being below 1 needs $n \ge 68$; then $nH/D \le nH/2$ and $2\log(nH) \ge \log(nH/2+3)+2$.""",
    formulas=(
        "transition_log_covering_repaired",
        "transition_log_covering_closed_form",
        "transition_error_repaired",
        "transition_error_closed_form",
    ),
)

T12 = Repair(
    name="T12",
    title="moments in a Hellinger ball",
    statement=r"""For $\lVert f\rVert_2 \le b$ and $H^2(P,Q) \le R$: $\lVert\operatorname{E}_Pf -
        \operatorname{E}_Qf\rVert_2 \le 2b\sqrt{R(2-R)}$ and $\lVert\operatorname{Cov}_P -
        \operatorname{Cov}_Q\rVert_{op} \le b^2\varphi(\sqrt{R(2-R)})$ with $\varphi(t) = 4t(1-t)$ up to $1/2$ and 1
        beyond. Two policies within $r$ of the clone have features at most $2B\sin\min(\pi/2, 2\arccos(1-r^2)) \le
        4\sqrt2Br$ apart, deterministic ones at most $2B\min(1, 2r^2)$.""",
    links=(
        link("the bound on means", "means"),
        link("the scalar maximisation behind the covariance", "covariance_maximum"),
        link("the reduction of the covariance to a scalar, along one direction", "covariances"),
        link("the features of two policies in a ball", "two_policies"),
    ),
    evidence=(
        proved_step(
            "the scalar maximisation behind the covariance (Z3)",
            moments.covariance_maximum,
            mutant("3 instead of 4", peak=3),
        ),
        exact(
            "means of generated laws and features, by both formulas",
            moments.means,
            mutant("half the total variation", share=Fraction(1, 2)),
        ),
        exact(
            "variances of generated laws and features, by both formulas",
            moments.covariances,
            mutant("half the total variation", share=Fraction(1, 2)),
        ),
        exact(
            "two points attain the mean bound and the covariance bound",
            moments.tightness,
            mutant("a millionth more", shift=Fraction(1, 10**6)),
        ),
        exact(
            "two deterministic policies in a ball: the worst feature, by both formulas",
            moments.two_policies,
            mutant("a quarter of the squared radius", share=Fraction(1, 4)),
        ),
        exact(
            "two deterministic policies attain the deterministic form, stochastic laws the general one",
            moments.pairs_attain,
            mutant("a millionth more", shift=Fraction(1, 10**6)),
        ),
    ),
    proof=r"""$\lVert\sum f(p-q)\rVert \le 2b\operatorname{TV}$, and total variation by Hellinger. For the covariance
        reduce to a scalar and write $P = (1-t)\nu + t\alpha$, $Q = (1-t)\nu + t\beta$: with $a = |\mu_\alpha| \le 1$
        the gain in variance is at most $t(1-a^2) + t(1-t)(1+a)^2$; maximise over $a$. Two laws within $r$ of a third
        are at an angle of at most $2\arccos(1-r^2)$; for deterministic policies $\operatorname{TV} = H^2$ and
        disagreements add.""",
    formulas=("mean_difference_sharp", "covariance_difference_sharp", "feature_difference_repaired"),
)

T13 = Repair(
    name="T13",
    title="radius for a stochastic expert",
    statement=r"""With step-wise count estimates of policy and kernel and empirical first state, $H^2(\hat P^{\pi^*},
        \hat P^{\hat\pi}) \le 1 - e^{-\mathcal B_\pi/(2n)}$ with probability $1-\delta$, where $\mathcal B_\pi =
        \sum_{h,s:N>0}\log\binom{N_h(s)+|A|-1}{|A|-1} + \log(1/\delta)$: the transition error does not enter.""",
    assumptions=("the expert is Markov", "the demonstrations are independent"),
    links=(
        link("the divergence of the expert from the step-wise clone", "policy_divergence"),
        link("the budget covers it, by T10 for the counts of actions", "stochastic_expert"),
        link("from the divergence to the Hellinger distance", T3),
    ),
    evidence=(
        exact(
            r"""$\mathrm{KL}(\hat P^{\hat\pi}\|\hat P^\pi) = \frac1n\sum N_h(s)\mathrm{KL}(\hat\pi_h\|\pi_h)$ on
                generated data""",
            kl_budget.policy_divergence,
            mutant("without 1/n", share=Fraction(2)),
        ),
        exact(
            "the budget formula, cell by cell",
            kl_budget.policy_budget_formula,
            mutant("one action more", actions=1),
        ),
        covered(
            "the expert lies in the ball",
            coverage.stochastic_expert,
            mutant("a hundredth of the radius", shrink=0.01),
        ),
    ),
    proof=r"""Under the step-wise estimate the expected visits are $N_h(s)/n$ exactly, so the chain rule gives the
        divergence; T10 for the action counts bounds it; T3.""",
    formulas=("policy_kl_budget", "offline_radius_stochastic"),
)

T14 = Repair(
    name="T14",
    title="counting and listing the set",
    statement=r"""$F(D) = \hat P^{\hat\pi}(\text{meet }D)$ is monotone and submodular, and $|\{\pi : H^2 \le r^2\}| =
        \sum_{D : F(D) \le r^2}(|A|-1)^{|D|}$: $2^{|S|}$ evaluations instead of $|A|^{|S|}$.""",
    links=(
        link("the count", "counting"),
        link("$F$ is monotone and submodular", "hitting_is_a_capacity"),
    ),
    evidence=(
        exact(
            "generated balls: enumeration of all policies, the sum, and the count of bridge_algos agree",
            zero_radius.counting,
            mutant("A instead of A - 1", alternatives=0),
        ),
        exact(
            "monotone and submodular on generated models",
            zero_radius.hitting_is_a_capacity,
            mutant("the reverse sign", sign=-1),
        ),
    ),
    proof=r"""A trajectory meets $D \cup E$ if it meets one of them and meets $D \cap E$ only if it meets both. The
        distance depends on a policy only through the set where it disagrees with the clone, and each such state
        allows $|A|-1$ other actions.""",
)
