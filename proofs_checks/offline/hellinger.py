"""Appendix: the efficient calculation of the Hellinger distance."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.claim import Claim, Repair, link
from proofs_checks.evidence import agrees, exact, mutant, refuted
from proofs_checks.kernel.evidence import theorem
from proofs_checks.offline.checks import distances, recursion
from proofs_checks.offline.repairs_counts import T14

_RECURSION = exact(
    "at every step the recursion equals the sum over partial trajectories, for generated kernels and policies",
    recursion.recursion_equals_enumeration,
    mutant("without the transposition", transposed=False),
)

_PROVED_RECURSION = theorem("hellinger_recursion")

K5 = Repair(
    name="K5",
    title="the distance as a matrix product",
    statement=r"""$H^2 = 1 - d_0^\top M^H\mathbf 1$, the sum running over the $|S|$ states; for stochastic or
        time-dependent policies $\mathrm{BC} = d_0^\top M_1\cdots M_H\mathbf 1$ with $M_h(s,s') =
        \sum_a\sqrt{\pi^1_h\pi^2_h(a|s)}\sqrt{P^1P^2(s'|s,a)}$. $H$ products of a vector and a matrix cost
        $O(H|S|^2)$, less than powers of $M$ at most horizons.""",
    assumptions=("both laws share the law of the first state",),
    links=(
        link("the recursion, for stochastic policies", "hellinger_recursion", "recursion_equals_enumeration"),
        link("the product of a law, a power of a matrix and a vector", "hellinger_matrix", "stochastic_policies"),
    ),
    evidence=(
        _PROVED_RECURSION,
        theorem("hellinger_matrix"),
        _RECURSION,
        exact(
            "the product equals the sum over trajectories, for generated stochastic policies",
            recursion.stochastic_policies,
            mutant("nine tenths of every factor", factor=Fraction(9, 10)),
        ),
        agrees(
            "the code of bridge_algos computes the same number to rounding",
            recursion.stochastic_policies_in_code,
            mutant("nine tenths of it", factor=0.9),
        ),
    ),
    proof="Group the trajectories by their last state; each factor of the product depends on one step only.",
)

CLAIMS = (
    Claim(
        label="local:hellinger_recursion",
        name="recursion for the overlap",
        topic="hellinger",
        verdict="true",
        statement=r"""With $X_0 = d_0$: $X_{t+1}(s') = \sum_s X_t(s)\sqrt{P^1(s'|s,\pi^1(s))P^2(s'|s,\pi^2(s))}\,
            \mathbf 1\{\pi^1(s) = \pi^2(s)\}$, and $\sum_s X_H(s) = \mathrm{BC}$ for trajectories with $H$
            transitions.""",
        because="A trajectory's weight is a product over its steps, so that the sum can be taken step by step.",
        assumptions=(
            "deterministic policies with a common law of the first state (otherwise $X_0 = \\sqrt{d_1d_2}$)",
            "for trajectories that end with the last action use $H - 1$ transitions and a last agreement factor",
        ),
        links=(link("the recursion", "hellinger_recursion", "recursion_equals_enumeration"),),
        evidence=(_PROVED_RECURSION, _RECURSION),
        proof=r"""By induction: split the last transition off a partial trajectory; the bracket that remains is
            $X_t(s)$. The displays of the paper write $a_t, s_t$ for $a_j, s_j$ inside products over $j$.""",
    ),
    Claim(
        label="local:hellinger_recursion",
        part="one-kernel",
        name="agreement trajectories",
        topic="hellinger",
        verdict="true",
        statement=r"""With $P^1 = P^2 = \hat P$ and deterministic policies, $H^2 = 1 - \Pr(\text{agreement all
            along})$.""",
        because=r"""Then every factor is a probability. (The question that the paper quotes asks for 1 minus the
            distance.)""",
        links=(link("the distance is the probability of a disagreement", "disagreement_is_the_distance"),),
        evidence=(
            exact(
                "generated models and deterministic policies",
                recursion.disagreement_is_the_distance,
                mutant("the first state forgotten", first_state=1),
            ),
            agrees(
                "the code of bridge_algos computes the same number to rounding",
                recursion.disagreement_in_code,
                mutant("the first state forgotten", first_state=1),
            ),
            exact(
                r"$H^2 = \frac12\lVert\sqrt p - \sqrt q\rVert^2$, and $H$ is a metric",
                distances.root_densities,
                mutant("without the half", normalisation=1),
            ),
            exact("the triangle inequality", distances.triangle, mutant("nine tenths", slack=Fraction(9, 10))),
        ),
        repairs=(T14,),
    ),
    Claim(
        label="local:hellinger_matrix",
        name="matrix form of the recursion",
        topic="hellinger",
        verdict="false",
        statement=r"""With $M_{s,s'} = \sqrt{P^1(s'|s,\pi^1(s))P^2(s'|s,\pi^2(s))}\,\mathbf 1\{\pi^1(s) = \pi^2(s)\}$:
            $X_{t+1} = MX_t$ and $H^2 = 1 - \sum_i[M^Hd_0]_i$, in $O(|S|^{\log_27}\log H)$ operations.""",
        because=r"""The recursion sums over the first index: $M^\top$ is meant. (The printed sum also runs over $|S| +
            1$ indices.)""",
        evidence=(refuted("offline-matrix-transpose"),),
        repairs=(K5,),
    ),
)
