"""T6 to T9: maximum likelihood, missing mass, radius zero, and the set from two errors."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.claim import Repair, link
from proofs_checks.evidence import cited, covered, exact, mutant, proved_step
from proofs_checks.kernel.evidence import theorem
from proofs_checks.offline.checks import confidence_set, coverage, maximum_likelihood, missing_mass, zero_radius
from proofs_checks.offline.evidence import coq

_DETERMINISTIC = "the expert is deterministic and stationary"
_INDEPENDENT = "the demonstrations are independent"

T6 = Repair(
    name="T6",
    title="maximum likelihood over a finite class",
    statement=r"""For a finite class that contains the truth and any tie-break, $\Pr(H^2(\hat g, g^*) \ge R) \le
        (|\mathcal G| - 1)(1 - R)^n$ for $R > 0$, so that with probability $1 - \delta$ $H^2 \le 1 -
        (\delta/(|\mathcal G|-1))^{1/n} \le \log((|\mathcal G|-1)/\delta)/n$.""",
    links=(
        link("the tail, with the number of laws at that distance", "finite_class"),
        link("the closed forms invert the tail and are in order", "finite_formulas"),
    ),
    assumptions=(_INDEPENDENT, "at least two elements"),
    evidence=(
        coq(
            r"for all finite spaces, truths, classes and $n$: the tail $|\mathcal G|\,b^n$ at overlaps of at most $b$",
            "maximum_likelihood",
            "finite_class",
            "one factor more",
            "INR (length class) * b ^ n.",
            "INR (length class) * b ^ (S n).",
        ),
        exact(
            "the tail at every attained distance, over all samples of generated classes, worst tie-break",
            maximum_likelihood.finite_class,
            mutant("|G| - 2 instead of |G| - 1", others=2),
        ),
        exact(
            "the formulas of bridge_theory invert the tail and are in order",
            maximum_likelihood.finite_formulas,
            mutant("|G| instead of |G| - 1", others=0),
        ),
    ),
    proof=r"""$\Pr(\prod g(x_i) \ge \prod g^*(x_i)) \le \operatorname{E}\prod\sqrt{g/g^*}(x_i) = (1 - H^2(g, g^*))^n$
        by Markov; a union over the elements at distance $R$ or more.""",
    formulas=("mle_finite_repaired", "mle_finite_sharp"),
)

T6_COVER = Repair(
    name="T6 (cover)",
    title="maximum likelihood over a cover, and outside the class",
    statement=r"""With a logarithmic cover $H^2(\hat g, g^*) \le 2\log(\mathcal N(\varepsilon)/\delta)/n +
        2\varepsilon$ with probability $1 - \delta$; if the truth may lie outside the class, $H^2 \le 3\log(2\mathcal
        N(\varepsilon)/\delta)/n + 2\varepsilon + \log(1 + \chi^2)$.""",
    links=(
        link("the probability of a larger error over a cover", "covered_class"),
        link("the probability of a larger error outside the class", "misspecified_class"),
    ),
    assumptions=(_INDEPENDENT,),
    evidence=(
        exact(
            "39 coins with a cover of 19: exact binomial failure probabilities for the worst maximiser",
            maximum_likelihood.covered_class,
            mutant("a hundredth of half the bound", shrink=Fraction(1, 200)),
        ),
        exact(
            "four coins without the truth: exact binomial failure probabilities",
            maximum_likelihood.misspecified_class,
            mutant("a twentieth of the bound", shrink=Fraction(1, 20)),
        ),
    ),
    proof=r"""Let $g'$ be the cover element of $\hat g$: $\sum\log(g'/g^*) \ge -n\varepsilon$, while with probability
        $1-\delta$, for all cover elements at once, $\frac12\sum\log(g'/g^*) \le n\log\mathrm{BC}(g', g^*) +
        \log(\mathcal N/\delta)$. So $H^2(g', g^*) \le \log(\mathcal N/\delta)/n + \varepsilon/2$, and $H^2(\hat g,
        g') \le \varepsilon/2$; the triangle inequality and $(a+b)^2 \le 2a^2 + 2b^2$.

        Outside the class, Markov gives $\sum\log(\hat g/g^*) \ge -n\log(1+\chi^2) - \log(2/\delta)$ instead of 0.""",
    formulas=("mle_covering_repaired", "mle_misspecified_repaired"),
)

T7 = Repair(
    name="T7",
    title="policy error as missing mass",
    statement=r"""For a deterministic expert the error of the clone is the probability $M$ that a fresh expert
        trajectory meets a state without data, at most: $\operatorname{E}M \le |S|\,n^n/(n+1)^{n+1} \le |S|/(en)$; $M
        \le 1 - (\delta/(2^{|S|}-1))^{1/n} \le (|S|\log2 + \log(1/\delta))/n$ with probability $1-\delta$; with $k$
        states unseen $M \le 1 - (\delta/(|S|\binom{|S|}{k}))^{1/n}$; and $M = 0$ with probability at least $1 -
        |S|(1-\gamma_{\min})^n$. The number of actions does not enter.""",
    links=(
        link(
            "the error is the probability of meeting a disagreement",
            "clone_error_is_missing_mass",
            "error_is_disagreement",
        ),
        link("the expectation", "expected_missing_mass", "expectation"),
        link("the tail, over the union of all sets of states", "missing_mass_tail", "tail"),
        link("the tail that depends on the number of unseen states", "observed_tail"),
        link("the probability of exact recovery", "exact_recovery"),
        link("the closed forms invert the tails", "formulas_invert_the_tail"),
        link("the closed form that needs no observation", "clone_error_bound"),
    ),
    assumptions=(_DETERMINISTIC, _INDEPENDENT),
    evidence=(
        theorem("clone_error_is_missing_mass"),
        theorem("expected_missing_mass"),
        theorem("missing_mass_tail"),
        theorem("exact_recovery"),
        theorem("clone_error_bound"),
        theorem("first_action_clones"),
        exact(
            r"$H^2 = \operatorname{TV} = \Pr(\text{meet a disagreement})$ on generated models",
            missing_mass.error_is_disagreement,
            mutant("half the probability", share=Fraction(1, 2)),
        ),
        exact(
            "the expectation, over the exact law of the visited states",
            missing_mass.expectation,
            mutant("n + 1 instead of n", dropped=1),
        ),
        exact(
            "a uniform first state over n + 1 states attains the expectation",
            missing_mass.expectation_is_attained,
            mutant("a millionth more", shift=Fraction(1, 10**6)),
        ),
        exact(
            "the tail at every attained value of M, exactly",
            missing_mass.tail,
            mutant("no union over subsets", base=1),
        ),
        exact(
            "the data-dependent tail at every attained value, exactly",
            missing_mass.observed_tail,
            mutant("a twentieth of the factor", scale=Fraction(1, 20)),
        ),
        exact(
            "the Good-Turing identity, over all samples",
            missing_mass.good_turing,
            mutant("M_n instead of M_{n-1}", left_out=0),
        ),
        exact(
            "exact recovery, with all S states",
            missing_mass.exact_recovery,
            mutant("S - 1 states, with a random first state", states_too_many=1),
        ),
        exact(
            "the formulas of bridge_theory invert the tails",
            missing_mass.formulas_invert_the_tail,
            mutant("one state fewer", states_too_many=1),
        ),
        covered(
            "both tails on random stars",
            coverage.observed_missing_mass,
            mutant("a thousandth of the bounds", shrink=0.001),
        ),
        covered(
            "the Good-Turing bound with its cited constant",
            coverage.good_turing_mass,
            mutant("a hundredth of the bound", shrink=0.01),
        ),
        cited("McAllester and Schapire 2000: the constant of the Good-Turing deviation, from memory"),
    ),
    proof=r"""Two deterministic policies under one kernel give equal laws on trajectories that avoid the disagreement
        and mutually singular ones on the rest; and the clone agrees with the expert wherever an action was recorded.

        Expectation: a union over states of (visited by the fresh trajectory, by none of the $n$), $\max_q q(1-q)^n$.
        Tail: a fixed set of probability $m$ is unvisited with probability $(1-m)^n$; a union over the nonempty
        subsets. With $k$ observed, give each size of the set an equal share of $\delta$.""",
    formulas=("missing_mass_expected", "missing_mass_observed", "policy_error_repaired", "policy_error_sharp"),
)

T8 = Repair(
    name="T8",
    title="radius zero",
    statement=r"""If the estimated kernel never leaves the states with a recorded action (counts of the transitions
        inside the trajectories, empirical first state, self-loops without data), then $H(\hat P^{\pi^*}, \hat
        P^{\hat\pi}) = 0$ surely, and the ball of radius 0 is the set of policies that agree with every demonstration.
        For any estimate $H^2(\hat P^{\pi^*}, \hat P^{\hat\pi}) \le \hat P^{\hat\pi}(\text{meet a state without
        data})$ surely.""",
    links=(
        link("under the closed estimate the expert is at distance 0", "expert_at_radius_zero", "closed_estimate"),
        link("so is every policy that agrees with the data", "closed_distance_zero", "closed_estimate"),
        link("every other policy is at a positive distance", "closed_estimate"),
        link(
            "the distance is at most the mass without data, for any estimate",
            "distance_by_unvisited_mass",
            "any_estimate",
        ),
    ),
    assumptions=(_DETERMINISTIC, "the clone maximises the likelihood over deterministic stationary policies"),
    evidence=(
        theorem("closed_distance_zero"),
        theorem("expert_at_radius_zero"),
        theorem("distance_by_unvisited_mass"),
        exact(
            "generated data: the ball of radius 0 is the version space, over all policies and ties",
            zero_radius.closed_estimate,
            mutant("uniform rows without data", default="uniform"),
        ),
        exact(
            "generated data and arbitrary estimates, all clones, by the formula of bridge_theory",
            zero_radius.any_estimate,
            mutant("one state forgotten", forgotten=1),
        ),
        exact("the formula is 0", zero_radius.closed_formula, mutant("1 instead of 0", claimed=Fraction(1))),
    ),
    proof=r"""The clone equals the expert wherever an action was recorded, and under a closed estimate the chain never
        leaves those states. With an empirical first state every recorded state is reached along its own recorded
        path, so a policy that contradicts the data has positive distance. In general the distance is the estimated
        probability of meeting a disagreement, and disagreements lie outside the data.""",
    formulas=("offline_radius_closed", "offline_radius_mass"),
)

T9 = Repair(
    name="T9",
    title="radius from the two errors alone",
    statement=r"""With $R_1 = H^2(P_*^{\hat\pi}, P_*^{\pi^*})$ and $R_2 = H^2(\hat P^{\pi^*}, P_*^{\pi^*})$, for all
        policies (stochastic, history-dependent) and kernels: $H(\hat P^{\pi^*}, \hat P^{\hat\pi}) \le \sqrt{R_1} +
        2\sqrt{R_2}$.""",
    links=(link("the inequality, for decision processes and all policies", "confidence_set", "any_policies"),),
    evidence=(
        theorem("confidence_set"),
        proved_step(
            "the two algebraic steps of the proof (Z3)",
            confidence_set.product_inequality,
            mutant("constant 1 instead of 2", constant=1),
        ),
        exact(
            "generated kernels and stochastic, history-dependent policies, exactly and by the formula",
            confidence_set.any_policies,
            mutant("factor 1 instead of 2", factor=Fraction(1)),
        ),
        exact(
            "larger errors give larger radii",
            confidence_set.monotone_in_errors,
            mutant("the reverse", sign=-1),
        ),
    ),
    proof=r"""On the support of the expert let $g(\tau) = \prod_t\sqrt{\hat\pi/\pi^*}(a_t|s_t)$, $\mu = P_*^{\pi^*}$
        and $\nu = \hat P^{\pi^*}$. Then $R_1 = 1 - \operatorname{E}_\mu g$, $K := H^2(\hat P^{\pi^*}, \hat
        P^{\hat\pi}) = 1 - \operatorname{E}_\nu g$ and both second moments of $g$ are at most 1. By Cauchy-Schwarz $$K
        - R_1 = \sum(1-g)(\sqrt\nu - \sqrt\mu)(\sqrt\nu + \sqrt\mu) \le \sqrt{2R_2}\,\bigl(\lVert(1-g)\sqrt\nu\rVert +
        \lVert(1-g)\sqrt\mu\rVert\bigr),$$ and $\lVert(1-g)\sqrt m\rVert^2 = 1 - 2\operatorname{E}g +
        \operatorname{E}g^2 \le 2(1 - \operatorname{E}_m g)$. So $K - R_1 \le 2\sqrt{R_2}(\sqrt K + \sqrt{R_1})$;
        divide.""",
    formulas=("confidence_set_radius_repaired",),
)

T9_DETERMINISTIC = Repair(
    name="T9 (deterministic)",
    title="radius from the two errors, deterministic policies",
    statement=r"""For deterministic policies $H(\hat P^{\pi^*}, \hat P^{\hat\pi}) \le \sqrt{R_1} + \sqrt{2R_2}$, and
        the root of 2 cannot be improved.""",
    links=(
        link("the inequality", "confidence_set_deterministic", "deterministic_policies"),
        link("instances whose ratio tends to the root of 2", "root_two_is_tight"),
    ),
    evidence=(
        theorem("confidence_set_deterministic"),
        exact(
            "generated deterministic policies: the root of 2 and the angle form",
            confidence_set.deterministic_policies,
            mutant("factor 1 instead of the root of 2", squared_factor=Fraction(1)),
        ),
        exact(
            r"$\sqrt2$ is approached where the estimate finds a detour of small probability",
            confidence_set.root_two_is_tight,
            mutant("199/100 under the root", squared_factor=Fraction(199, 100)),
        ),
    ),
    proof=r"""As T9 with $g \in \{0, 1\}$: the weighted norms of $1 - g$ are $1 - \operatorname{E}g$ instead of twice
        that.""",
    formulas=("confidence_set_radius_deterministic",),
)

T9_ANGLE = Repair(
    name="T9 (angle)",
    title="radius from the two errors, as an angle",
    statement=r"""For deterministic policies $H(\hat P^{\pi^*}, \hat P^{\hat\pi}) \le \sin\min(\pi/2,
        \arcsin\sqrt{R_1} + \arccos(1 - R_2))$, attained.""",
    links=(
        link("the inequality, by data processing", "angle_form"),
        link("it is attained", "angle_is_attained"),
    ),
    evidence=(
        exact(
            "two-point laws attain the angle form",
            confidence_set.angle_is_attained,
            mutant("a billionth more", shift=Fraction(1, 10**9)),
        ),
        exact(
            "generated kernels and deterministic policies, by the formula",
            confidence_set.angle_form,
            mutant("half of the transition error", share=Fraction(1, 2)),
        ),
    ),
    proof=r"""Data processing to the event that the policies disagree: its probabilities $R_1$ under the truth and $K$
        under the estimate are at an angle of at most $\arccos(1 - R_2)$.""",
    formulas=("confidence_set_radius_angle",),
)
