"""What offline demonstrations buy before anything is learned online: repairs shared by the regret claims."""

from __future__ import annotations

from proofs_checks.claim import Claim, Repair, link
from proofs_checks.evidence import agrees, exact, mutant, proved_step
from proofs_checks.online.checks import environments, offline_gain

R8 = Repair(
    name="R8",
    title="what offline data give every algorithm",
    links=(
        link("(a)", "deterministic_laws"),
        link("(b)", "transfer_between_kernels"),
        link("(c) the probability that the version space is wide", "version_space"),
        link("(c) the regret inside the set is at most $2BW$ times the total variation, a round"),
    ),
    statement=r"(a) For deterministic policies $\operatorname{TV}(P^\pi, P^{\pi'}) = H^2 = P^{\pi'}(\text{visit } s : "
    r"\pi(s) \ne "
    r"\pi'(s))$. (b) For all policies and kernels $\lvert\operatorname{TV}(P^\pi, P^{\pi'}) - \operatorname{TV}(Q^\pi, "
    r"Q^{\pi'})\rvert \le \min\{\operatorname{TV}(P^{\pi'}, Q^{\pi'}), \operatorname{TV}(P^\pi, Q^\pi)\}$. (c) "
    r"Whatever is played "
    r"inside $\Pi_{\text{off}}$: $R_T \le 2BWT\Delta_n$ with $\Delta_n = "
    r"\max_{\pi\in\Pi_{\text{off}}}\operatorname{TV}(P_*^\pi, "
    r"P_*^{\pi^*})$; for the version space of a deterministic expert $\Delta_n \le (|\mathcal S|\log|\mathcal A| + "
    r"\log\frac1\delta)/n$ with probability $1-\delta$, and $\Delta_n = 0$ with probability at least "
    r"$1 - |S_{\text{reach}}|(1-\gamma_{\min})^n$.",
    evidence=(
        exact(
            "(a) on rational MDPs, whole laws enumerated",
            offline_gain.deterministic_laws,
            mutant("the square of the probability", power=2),
        ),
        exact(
            "(b) on rational MDPs, stochastic and history-dependent policies",
            offline_gain.transfer_between_kernels,
            mutant("nothing on the right-hand side", factor=0),
        ),
        exact(
            "(c) exact failure probabilities with one hidden state",
            offline_gain.version_space,
            mutant("half of each bound", share=0.5),
        ),
        agrees(
            "StarMDP: the expert is at radius zero, features differ by at most $4Br^2$",
            environments.offline_geometry,
            mutant("a fifth of the diameter", factor=0.2),
            environment="starmdp",
        ),
        *(
            agrees(
                f"{name}: the expert is at radius zero, features differ by at most $4Br^2$",
                environments.offline_geometry,
                mutant("a fifth of the diameter", factor=0.2),
                environment=name,
                full_only=True,
            )
            for name in ("garnet", "chain", "gridworld", "frozenlake")
        ),
    ),
    proof=r"(a) The laws agree on trajectories that avoid the states where the policies differ and are singular on "
    r"the rest. "
    r"(b) $\operatorname{TV}(P^\pi, P^{\pi'}) = \operatorname{E}_{P^{\pi'}}(1 - \prod_h\pi/\pi')_+$ is the mean of "
    r"one function of "
    r"the trajectory with values in $[0,1]$ under $P^{\pi'}$; the same function appears for $Q$. (c) "
    r"$\langle\phi(\pi^*) - "
    r"\phi(\pi), w^*\rangle \le 2BW\operatorname{TV}$. A policy of the class at distance $\theta$ agrees with $n$ "
    r"demonstrations "
    r"with probability at most $(1-\theta)^n$; take the union over $|\mathcal A|^{|\mathcal S|}$ policies.",
    formulas=(
        "regret_offline", "delta_n_known", "delta_n_known_deterministic", "delta_n_unknown",
        "delta_n_unknown_deterministic", "delta_n_version_space", "delta_n_version_space_sharp",
        "exact_recovery_failure", "regret_known_deterministic",
    ),
)  # fmt: skip

R10 = Repair(
    name="R10",
    title="coverage of the expert's pairs",
    links=(
        link("the Chernoff bound for one pair", "chernoff"),
        link("what a covered pair costs", "covered_bonus"),
        link("the union over the pairs, and the policies that leave them"),
    ),
    statement=r"With probability at least $1 - |S_{\text{reach}}|e^{-n\gamma_{\min}/8}$ every pair of the expert has "
    r"at least "
    r"$n\gamma_{\min}/2$ recorded transitions. Then for every policy $\operatorname{E}_{P_*^\pi}\sum_{h<H}\xi_t \le "
    r"(H-1)4\eta\sqrt{2U/(n\gamma_{\min})} + 2\eta(H-1)\operatorname{TV}(P_*^\pi, P_*^{\pi^*})$.",
    evidence=(
        exact(
            r"$P(\operatorname{Bin}(n,\gamma) < n\gamma/2) \le e^{-n\gamma/8}$ by exact sums",
            offline_gain.chernoff,
            mutant("exponent divided by 2 instead of 8", rate=2),
        ),
        proved_step(
            r"a covered pair costs at most $4\eta\sqrt{2U/(n\gamma_{\min})}$",
            offline_gain.covered_bonus,
            mutant("3 instead of 4", offset=1),
        ),
    ),
    proof=r"The number of demonstrations that visit a pair is binomial with success probability at least "
    r"$\gamma_{\min}$; use the "
    r"multiplicative Chernoff bound and a union. Off the expert's pairs $\xi \le 2\eta$, and the expert never leaves "
    r"them, so a "
    r"policy does so with probability at most its total variation from the expert.",
    formulas=("reach_size", "coverage_failure", "covered_bonus"),
)

CLAIMS: tuple[Claim, ...] = ()
