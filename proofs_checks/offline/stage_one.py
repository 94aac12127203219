"""Section 4.1: the radius of the offline confidence set and what it is made of."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.claim import Claim, link
from proofs_checks.evidence import agrees, exact, mutant, proved_step, refuted
from proofs_checks.kernel.evidence import theorem
from proofs_checks.offline.checks import confidence_set, radius, transcription
from proofs_checks.offline.evidence import text
from proofs_checks.offline.policy_estimation import POLICY_CONSTANT
from proofs_checks.offline.repairs_counts import T10, T11, T12, T13, T14
from proofs_checks.offline.repairs_policy import T7, T8, T9, T9_ANGLE, T9_DETERMINISTIC
from proofs_checks.offline.repairs_trajectory import STATED_CONCENTRABILITY, STATED_CONCENTRABILITY_LINKS, T5
from proofs_checks.online.evidence import FAMILY, refuted_order, unbounded

_DETERMINISTIC = "the expert is deterministic and stationary, the kernel stationary"

_FACTOR_TWO = proved_step(
    "the paper's factor $1 + \\sqrt{HC}$ is at least 2, so that T9 implies the lemma (Z3)",
    confidence_set.stated_radius_is_larger,
    mutant("at least 21/10", floor=Fraction(21, 10)),
)
_ON_INSTANCES = exact(
    "the radius from the exact errors of generated instances contains the expert",
    confidence_set.stated_formula_covers,
    mutant("the first error alone", only_policy_error=True),
)
LINKS_OF_THE_LEMMA = (link("the inequality on the two events", "confidence_set_stated", "stated_formula_covers"),)
RADIUS_OF_THE_LEMMA = (
    theorem("confidence_set_stated"),
    _ON_INSTANCES,
)
RADIUS_OF_THE_THEOREM = (
    theorem("tabular_confidence_set"),
    theorem("offline_theorem"),
    theorem("offline_theorem_counts"),
    _FACTOR_TWO,
    _ON_INSTANCES,
    exact(
        "the radius of the theorem is that of the lemma at $R_1(\\delta/2)$ and $R_2(\\delta/2)$",
        radius.radius_is_the_lemma,
        mutant("$\\delta$ instead of $\\delta/2$", half=Fraction(1)),
    ),
    *POLICY_CONSTANT,
)
LINKS_OF_THE_THEOREM = (link("the theorem, from the decision process to the radius", "tabular_confidence_set"),)

CLAIMS = (
    Claim(
        label="thm:tabular_confidence_set",
        name="offline confidence set",
        topic="offline",
        verdict="true, proof wrong",
        statement=r"""With $\alpha = \sqrt{4|S|\log(2|A|/\delta)}$ and $\beta = \sqrt{4|S|^2|A|\log(2nH/\delta)}$ the
            set $\{\pi : H(\hat P^\pi, \hat P^{\hat\pi}) \le \mathrm{Radius}\}$, $$\mathrm{Radius} =
            \frac{\alpha}{\sqrt n} + \frac{\beta}{\sqrt n}\Bigl(1 + \sqrt{H\bigl(1 +
            \tfrac{2\alpha}{\gamma_{\min}\sqrt n}\bigr)}\Bigr),$$ contains $\pi^*$ with probability at least
            $1-\delta$.""",
        because=r"""T6, T7 and T11 bound the two errors by less than the theorem does, and T9 combines them into less.
            The paper's own proof fails in four places: total variation, the product formula, the support gap, the
            last step. At $(|S|, |A|, H, \delta) = (5, 4, 8, 0.05)$ the radius is below 1 only from 150158
            demonstrations on ($\gamma_{\min} = 0.1$), while radius 0 is valid at every sample size (T8).""",
        assumptions=(_DETERMINISTIC, "the law of the first state is common"),
        links=LINKS_OF_THE_THEOREM,
        evidence=(
            *RADIUS_OF_THE_THEOREM,
            exact(
                "wherever the stated radius is informative the proved radii are below it (balls)",
                radius.proved_below_stated,
                mutant("a hundredth of the stated radius", factor=Fraction(1, 100)),
            ),
            exact(
                "the constants $\\alpha$, $\\beta$, and the radius with the corollaries' constant 6",
                radius.constants_and_corollaries,
                mutant("6 instead of 4", four=6),
            ),
            exact(
                "smallest informative sample sizes, certified on both sides",
                radius.first_useful_n,
                mutant("a radius below 2", one=Fraction(2)),
            ),
            agrees(
                "the composed proved radii are T9 at T7 and T11",
                transcription.compositions,
                mutant("$\\delta$ instead of $\\delta/2$", half=1.0),
            ),
        ),
        repairs=(T8, T9, T9_DETERMINISTIC, T9_ANGLE, T7, T10, T11, T13, T14),
        proof=r"""With probability $1-\delta/2$ each, $R_1 \le (|S|\log2 + \log(2/\delta))/n$ (T7) and $R_2$ is below
            the theorem's bound (T6 with T11). By T9 the distance is at most $\sqrt{R_1} + \sqrt{2R_2}$, and $1 +
            \sqrt{H(1 + 2\sqrt{R_1}/\gamma_{\min})} \ge 2 \ge \sqrt2$.""",
    ),
    Claim(
        label="thm:tabular_confidence_set",
        part="rate",
        name="radius of order 1/sqrt n",
        topic="offline",
        verdict="false",
        statement=r"The radius scales as $O(1/\sqrt n)$.",
        because=r"$\log n$ stands inside $\beta$: the order is $\sqrt{\log(nH)/n}$.",
        links=refuted_order("offline-radius-rate"),
        proof=FAMILY["offline radius"],
        evidence=(
            refuted("offline-radius-rate"),
            unbounded("offline radius", r"as $n \to \infty$: $\sqrt n$ times the radius is at least $\beta$"),
            exact(
                r"$\sqrt n$ times the radius is 373, 405, 453 at $n = 10^6, 10^9, 10^{12}$ (balls)",
                radius.growing_scaled_radius,
                mutant("the cube root of n", exponent=Fraction(1, 3)),
            ),
        ),
    ),
    Claim(
        label="thm:tabular_confidence_set",
        part="computable",
        name="computable from the data",
        topic="offline",
        verdict="false",
        statement="The confidence set is computable: its radius uses only quantities computable from the offline data "
        "and the estimators.",
        because=r"$\gamma_{\min}$ belongs to the unknown expert and dynamics, and no data determine it; the repaired "
        "radii do without.",
        evidence=(refuted("offline-hidden-visitation"),),
        repairs=(T8, T9),
    ),
    Claim(
        label="local:realizability",
        name="realizability",
        topic="offline",
        verdict="definition",
        statement=r"$\pi^* \in \Pi$ and $P^* \in \mathcal P$.",
        because="An assumption; radius zero (T8) does without the second half.",
    ),
    Claim(
        label="eq:loglossbc_estimator",
        name="behavioural cloning",
        topic="offline",
        verdict="definition",
        statement=r"$\hat\pi = \arg\max_{\pi\in\Pi}\sum_i\sum_h\log\pi_h(a_h^i|s_h^i)$.",
        because=r"""A definition. Over deterministic policies the maximisers are all policies that agree with the
            data: the likelihood is 1 or 0, with ties wherever no action was recorded.""",
    ),
    Claim(
        label="eq:MLE_transition_estimator",
        name="transition estimator",
        topic="offline",
        verdict="undefined",
        statement=r"$\hat P = \arg\max_P\sum_i\sum_{h\in[H]}\log P(s_{h+1}^i|s_h^i, a_h^i)$.",
        because=r"""At $h = H$ the sum uses $s_{H+1}$, which is not part of a trajectory, and rows without data are
            free. The choice matters: with it the expert may leave the ball of radius 0.""",
        evidence=(refuted("offline-last-arrival"),),
        repairs=(T8,),
        proof="Sum over $h = 1, \\ldots, H - 1$ and let rows without data stay where they are: then T8 applies.",
    ),
    Claim(
        label="local:concentrability_definition_main",
        name="concentrability",
        topic="offline",
        verdict="definition",
        statement=r"$C(\hat\pi, \pi^*) = \sup_t\sup_{d_t^*(s,a) > 0} d_t^{\hat\pi}(s,a)/d_t^*(s,a)$.",
        because=r"A definition. It says nothing about pairs that only $\hat\pi$ visits; see the technical lemma.",
    ),
    Claim(
        label="assumption:min_visitation",
        name="minimum visitation",
        topic="offline",
        verdict="definition",
        statement=r"$d_t^*(s,a) \ge \gamma_{\min} > 0$ wherever it is positive.",
        because=r"""An assumption that some $\gamma_{\min}$ always satisfies in a finite problem, so that only its
            value matters. It already implies exact recovery of the expert: $n \ge \log(|S|/\delta)/\gamma_{\min}$
            demonstrations (T7).""",
        repairs=(T7,),
    ),
    Claim(
        label="assumption:min_visitation",
        part="interpretation",
        name="small gamma_min means specialised",
        topic="offline",
        verdict="false",
        statement=r"A smaller $\gamma_{\min}$ corresponds to a more specialised expert.",
        because="A deterministic expert with deterministic dynamics has the largest possible value, 1.",
        evidence=(refuted("offline-rarest-visit"),),
    ),
    Claim(
        label="local:concentrability_main",
        name="concentrability bound",
        topic="offline",
        verdict="true, proof wrong",
        statement=r"""If $H^2(P_*^{\hat\pi}, P_*^{\pi^*}) \le R$ then $C(\hat\pi, \pi^*) \le 1 + 2\sqrt
            R/\gamma_{\min}$.""",
        because="Implied by the sharp bound T5; in the paper's proof two errors cancel, see the appendix lemma.",
        links=STATED_CONCENTRABILITY_LINKS,
        evidence=(*STATED_CONCENTRABILITY, text("concentrability_stated")),
        repairs=(T5,),
    ),
    Claim(
        label="lemma:confidence_set_construction_main",
        name="set from two errors",
        topic="offline",
        verdict="true, proof wrong",
        statement=r"""If $R_1$ and $R_2$ bound the two squared errors with probability $1-\delta/2$ each, then $\pi^*$
            lies within $\sqrt{R_1} + \sqrt{R_2}\,(1 + \sqrt{H(1 + 2\sqrt{R_1}/\gamma_{\min})})$ of $\hat\pi$ with
            probability $1-\delta$.""",
        because=r"""The factor of $\sqrt{R_2}$ is at least 2, and T9 needs 2, for any policies and without
            $\gamma_{\min}$. The paper's proof uses the technical lemma, which is false.""",
        links=(*LINKS_OF_THE_LEMMA, link("both events at once, by a union")),
        proof=r"""By T9 the distance is at most $\sqrt{R_1} + 2\sqrt{R_2}$ where both errors are within their bounds,
            which fails with probability at most $\delta/2 + \delta/2$.""",
        evidence=(*RADIUS_OF_THE_LEMMA, text("confidence_set_radius")),
        repairs=(T9, T9_DETERMINISTIC),
    ),
    Claim(
        label="local:feature_difference_main",
        name="features within the set",
        topic="offline",
        verdict="false",
        statement=r"""$\lVert\phi^{\hat P}(\pi_1) - \phi^{\hat P}(\pi_2)\rVert_2 \le 4\sqrt2B/\sqrt n$ for all
            policies of the set.""",
        because=r"The radius is not $1/\sqrt n$: its constants and logarithm are missing.",
        evidence=(refuted("offline-feature-difference"), text("feature_difference_stated")),
        repairs=(T12, T8),
    ),
)
