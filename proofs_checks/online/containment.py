"""The policy sets Pi_t: containment of the best policy, and the regret that follows from containment alone."""

from __future__ import annotations

from proofs_checks.claim import Claim, Repair, link
from proofs_checks.evidence import Evidence, covered, mutant, proved_step, refuted, unsettled
from proofs_checks.online.bonuses import R6
from proofs_checks.online.checks import containment, environments
from proofs_checks.online.evidence import text
from proofs_checks.online.weights import R1

FAMILIES = ("garnet", "dense garnet", "chain", "starmdp", "gridworld", "frozenlake")


def _runs(known: bool, environment: str) -> Evidence:
    kind = "known" if known else "unknown"
    return covered(
        f"{environment}, {kind} dynamics: best policy in every round's set and all bounds above the realised "
        "pseudo-regret, failure probability 1/4",
        environments.good_runs,
        mutant("a thousandth of the multiplier and the bonuses", shrink=0.001),
        full_only=environment != "garnet",
        environment=environment,
        known=known,
    )


RUNS_KNOWN = tuple(_runs(True, environment) for environment in FAMILIES)
RUNS_UNKNOWN = tuple(_runs(False, environment) for environment in FAMILIES)

_IMPLICATION = proved_step(
    r"$\lvert\langle\phi^* - \phi', w_t - w^*\rangle\rvert \le \rho_t\lVert\phi^* - \phi'\rVert$ and errors within the "
    r"bonuses give a nonnegative optimistic advantage",
    containment.containment,
    mutant("no width and no bonuses", bonuses=0),
)

R2 = Repair(
    name="R2",
    title="containment of the best policy",
    statement=r"$\Pi_t = \{\pi \in \Pi_{\text{off}} : \forall \pi' \in \Pi_{\text{off}}: "
    r"\langle\phi(\pi) - \phi(\pi'), w_t\rangle + \rho_t\lVert\phi(\pi) - \phi(\pi')\rVert_{V_t^{-1}} \ge 0\}$ with "
    r"the "
    r"$\rho_t$ of R1 and any $w_t$ in the ball contains $\pi^*$ for all $t$ with probability at least "
    r"$1 - \delta_{\text{off}} - \delta_w$, and is never empty. With unknown dynamics: $\phi^{\hat P_t}$ for $\phi$, "
    r"$b_t(\pi) + b_t(\pi')$ added on the left, and $\delta_P$ spent too.",
    assumptions=("trajectories come from the real environment", "the offline set contains the best policy"),
    links=(
        link("the width covers the weights", R1),
        link("with unknown dynamics, the bonuses cover the features", R6),
        link("then no policy is better than the best one beyond width and bonuses", "containment"),
    ),
    evidence=(_IMPLICATION, *RUNS_KNOWN, *RUNS_UNKNOWN),
    proof=r"On the events of the offline set and of R1: $0 \le \langle\phi^* - \phi', w^*\rangle \le "
    r"\langle\phi^* - \phi', w_t\rangle + \lVert\phi^* - \phi'\rVert_{V_t^{-1}}\lVert w_t - w^*\rVert_{V_t}$. With "
    r"unknown "
    r"dynamics R6 changes each expected utility by at most its bonus. The set contains the maximiser of "
    r"$\langle\phi, w_t\rangle$. No expected data matrix, no net and no factor 4 is needed.",
    formulas=("confidence_radius_repaired", "transition_bonus"),
)

R4 = Repair(
    name="R4",
    title="data-dependent regret bounds",
    statement=r"Let $O_t(\pi, \pi') = \rho_t\lVert\hat\phi_t(\pi) - \hat\phi_t(\pi')\rVert_{V_t^{-1}} + b_t(\pi) + "
    r"b_t(\pi')$ "
    r"and let round $t$ play its arg-max pair in $\Pi_t$. On the events of R2, with no further failure probability: "
    r"$R_T \le B_{\text{ucb}} \le B_{\text{width}} = \sum_t2O_t(\pi_t^1, \pi_t^2)$, where $B_{\text{ucb}}$ sums the "
    r"largest "
    r"optimistic advantage over each policy played; and $R_T \le B_{\text{hind}}$, the largest optimistic regret in "
    r"hindsight over $\Pi_{\text{off}}$ with the weights and the matrix after round $T$. Always $R_T \le 2BWT$.",
    assumptions=("containment (R2)", "the width bound needs the exact arg-max pair; the other two do not"),
    links=(
        link("the best policy is in every set", R2),
        link("a round's regret is at most twice the width of the pair played", "regret_from_width"),
        link("the optimistic bound is below the width", "refined_width"),
        link("the sums over the rounds, and the bound in hindsight", "good_runs"),
    ),
    evidence=(
        proved_step(
            r"$r_t \le 2O_t(\pi_t^1, \pi_t^2)$ from $\pi^*, \pi_t^1, \pi_t^2 \in \Pi_t$ and the arg-max",
            containment.regret_from_width,
            mutant("factor 1", factor=1),
            mutant("the constraint of the best policy, as in the paper's proof", paper_sign=True),
        ),
        proved_step(
            r"$U_t(\pi, \pi_i) \le 2O_t(\pi, \pi_i)$, hence $B_{\text{ucb}} \le B_{\text{width}}$",
            containment.refined_width,
            mutant("factor 1", factor=1),
        ),
        *RUNS_KNOWN,
        *RUNS_UNKNOWN,
    ),
    proof=r"$\langle\phi^* - \phi_i, w^*\rangle \le \langle\hat\phi^* - \hat\phi_i, w_t\rangle + O_t(\pi^*, \pi_i)$, "
    r"and since "
    r"$\pi_i \in \Pi_t$ is compared with $\pi^*$, $\langle\hat\phi^* - \hat\phi_i, w_t\rangle \le O_t(\pi^*, \pi_i)$. "
    r"So "
    r"$\langle\phi^* - \phi_i, w^*\rangle \le 2O_t(\pi^*, \pi_i) \le 2O_t(\pi_t^1, \pi_t^2)$. For the bound in "
    r"hindsight: "
    r"$\pi^*$ and $w^*$ are one point each and $R_T = \langle m_{\pi^*}, w^*\rangle$ with the sum $m_\pi$ of "
    r"$\phi(\pi) - \frac12(\phi(\pi_t^1) + \phi(\pi_t^2))$ over the rounds.",
    formulas=("regret_trivial", "regret_diameter", "regret_optimism", "regret_width", "regret_hindsight"),
)

_IN_EVERY_SET = (
    r"With probability at least $1 - \delta^{\text{online}}$, $\pi^* \in \Pi_t \subseteq \Pi_{\text{off}}$ for all "
    r"$t \le T$."
)
PRINTED_ALGORITHM = (
    r"Take the instance of line 8: playing $a$ wins with probability $3/5$, which is worth more than $b$ in "
    r"expectation, "
    r"and one demonstration of $a$ was lost, with probability $2/5$. The estimate of that row is certain of "
    r"losing, and so "
    r"is every trajectory drawn from it: the row never changes, whatever is played. Its bonus falls with the counts, "
    r"below the error of the estimate. The answers compare losing with $b$ and teach that $b$ is better than losing, "
    r"which it is; the width of that comparison shrinks with the number of times it is made, up to logarithms, and "
    r"while both policies are in the set the pair of both is among those with the largest objective. So there is a "
    r"round after which the best policy is excluded, and every later round costs $\frac15BW$: the regret is linear in "
    r"$T$ with probability at least $2/5$, more than $\delta$."
)
PRINTED_ALGORITHM_LINKS = (
    link("the bonus is too small for good, with a probability above $\\delta$", "online-sampling-from-the-estimate"),
    link("then the best policy is excluded, and every later round costs the same"),
)

CLAIMS = (
    Claim(
        label="lemma:optimal_policy_containment",
        name="best policy in every set, known dynamics",
        topic="online",
        verdict="open",
        statement=r"On $E_{w^*} \cap E_{\overline V_T} \cap E_{\text{off}}$, $\pi^* \in \Pi_t$ for all $t \le T$.",
        because=r"The step $\lVert w^* - w_t\rVert_{\overline V_t} \le \gamma_t$ does not follow from an event about "
        r"the last "
        r"round only. With the event for all $t \le T$ (R9) the implication is right.",
        evidence=(unsettled("no run is known in which the step fails and the best policy is lost"), _IMPLICATION),
        repairs=(R2,),
    ),
    Claim(
        label="local:gamma_known",
        name="multiplier with known dynamics",
        topic="online",
        verdict="definition",
        statement=r"$\gamma_t = 4\kappa\beta_t(\delta) + \alpha_{d,T}(\delta)$.",
        evidence=(text("gamma_known", "containment_failure_known", "containment_failure_unknown"),),
        because="A definition; R2 needs only $\\rho_t = \\kappa(\\beta_t + e_t)$.",
        repairs=(R2,),
    ),
    Claim(
        label="lem:online_confidence_set",
        name="best policy in every set, unknown dynamics",
        topic="online",
        verdict="false",
        statement=_IN_EVERY_SET,
        because="As printed, for the printed algorithm: with trajectories from the estimate (line 8) the best "
        "policy is "
        "excluded with probability 2/5. What is left open is the lemma for trajectories of the real "
        "environment, see the "
        "next entry.",
        links=PRINTED_ALGORITHM_LINKS,
        evidence=(refuted("online-sampling-from-the-estimate"),),
        repairs=(R2,),
        proof=PRINTED_ALGORITHM,
    ),
    Claim(
        label="lem:online_confidence_set",
        part="repaired algorithm",
        name="best policy in every set, trajectories of the real environment",
        topic="online",
        verdict="open",
        statement=_IN_EVERY_SET + " Here line 8 of the algorithm samples from the real environment.",
        because="Its proof uses the norm relation of the last round in all rounds, an undefined norm relation, bonuses "
        "without a value at small counts, and a budget of five events where two of them cost "
        r"$\delta(1 + \log_2T)$.",
        evidence=(unsettled("no counterexample is known for trajectories of the real environment"),),
        repairs=(R2,),
    ),
    Claim(
        label="algo:main",
        part="line 8",
        name="trajectories sampled from the estimate",
        topic="online",
        verdict="false",
        statement=r"With trajectories $\tau_t^i$ sampled from $\hat P_t$ (line 8), the bonus stays valid: with "
        r"probability at "
        r"least $1-\delta$, $\operatorname{E}_{P^*}f - \operatorname{E}_{\hat P_t}f \le \hat B_t$ for all $t$.",
        because="Counts grow without information: an estimated row that is certain stays certain, and its bonus "
        "shrinks.",
        evidence=(refuted("online-sampling-from-the-estimate"),),
        repairs=(R2,),
        proof="Line 8 must sample from the real environment. Lines 3, 6 and 7 have smaller slips: the matrix starts as "
        r"$\lambda I$ instead of $\kappa\lambda I$, and the bonuses of the set and of the objective use different "
        "failure probabilities, so that the arg-max argument does not apply.",
    ),
    Claim(
        label="local:regret_known_dynamics",
        name="regret from the widths played",
        topic="regret",
        verdict="true, proof wrong",
        statement=r"Given containment: $R_T \le 2\gamma_T\sum_t\lVert\phi(\pi_t^1) - \phi(\pi_t^2)\rVert_{\overline "
        r"V_t^{-1}}$.",
        because="The proof turns a constraint of the best policy around; the constraints of the policies played are "
        "needed.",
        assumptions=("containment in every round", r"$\gamma_t$ does not decrease"),
        links=(
            link("a round's regret is at most twice the width of the pair played", "regret_from_width"),
            link("the sum over the rounds, with the last multiplier for all"),
        ),
        evidence=R4.evidence[:1],
        repairs=(R4,),
        proof=r"The paper reads $\langle\Delta^{*,i}, w\rangle + \gamma\lVert\Delta\rVert \ge 0$ as "
        r"$\langle\Delta^{*,i}, w\rangle \le \gamma\lVert\Delta\rVert$, which is false. Membership of $\pi_i$ gives "
        r"$\langle\Delta^{i,*}, w\rangle + \gamma\lVert\Delta\rVert \ge 0$, which is what is needed; see R4.",
    ),
)
