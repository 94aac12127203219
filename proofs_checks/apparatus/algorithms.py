"""The two algorithms of the paper."""

from __future__ import annotations

from proofs_checks.claim import Claim

CLAIMS = (
    Claim(
        label="algo:main",
        name="BRIDGE",
        topic="online",
        verdict="definition",
        statement=r"""In each round $t$, BRIDGE fits $w_t^{\text{proj}}$, keeps the policies $\Pi_t$ that could still be
        best, plays the pair that maximises
        $$\gamma_t \lVert \phi^{\hat P_t}(\pi^1) - \phi^{\hat P_t}(\pi^2) \rVert_{V_t^{-1}}
        + \hat B_t(\pi^1, 2WB, \delta) + \hat B_t(\pi^2, 2WB, \delta),$$
        and updates $V_t$ and $\hat P_t$ with the answer.""",
        because=r"""An algorithm claims nothing by itself; the regret statements do. As printed it draws trajectories
        from the estimated kernel $\hat P_t$ and starts from $V_1 = \lambda I$, while its analysis needs trajectories of
        the true kernel and $V_1 = \kappa\lambda I$.""",
    ),
    Claim(
        label="algo:main_known",
        name="BRIDGE, known dynamics",
        topic="online",
        verdict="definition",
        statement=r"""The same loop with the true kernel: the pair maximises
        $\lVert \phi(\pi^1) - \phi(\pi^2) \rVert_{\bar V_t^{-1}}$ over $\Pi_t$, with $\bar V_1 = \kappa\lambda I$.""",
        because="An algorithm claims nothing by itself; the regret statements do.",
    ),
    Claim(
        label="proof:lemma_hellinger_to_moment",
        name="proof of the moment lemma",
        topic="hellinger",
        verdict="definition",
        statement="The paper's proof of the lemma on moments over a Hellinger ball.",
        because="A proof is judged with its lemma, which has its own entry.",
    ),
)
