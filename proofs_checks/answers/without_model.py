"""G10: preferences without a model of utility."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.answers.checks import betting
from proofs_checks.answers.evidence import text
from proofs_checks.claim import Claim, link
from proofs_checks.evidence import exact, mutant, proved_step

CLAIMS = (
    Claim(
        label="companion G10",
        name="bets on pairs, without a model of utility",
        topic="answers",
        verdict="true",
        statement=r"For fresh draws in random position with stationary $p(i, j)$, bets at $\delta/\text{pairs}$ give "
        r"intervals that hold for all pairs at all times with probability $1-\delta$ under any adaptive asking; mixed "
        r"uniformly they lie within $|\hat p_t - p| \le \sqrt{\log((t + 1)\text{pairs}/\delta)/(2t)}$. A winner need "
        r"not exist: under one utility, three candidates whose utilities lie far apart (here up to 80 nats) can each "
        r"be preferred to the next with more than .61.",
        because="A bet at the true chance is a fair game, its uniform mixture is a martingale in closed form, and the "
        "closed form has a simple bound.",
        assumptions=(
            "both trajectories are fresh draws, in random position",
            "preference between two candidates does not drift",
        ),
        links=(
            link("bets and their uniform mixture are martingales", "fair"),
            link("the worst asker of two pairs fails with probability at most delta", "ever_outside"),
            link("the mixture is at least $e^{t\\,kl}/(t + 1)$", "closed_form"),
            link("kl is at least twice the squared distance", "pinsker"),
            link("a circle under one utility", "cycle"),
            link("any number of pairs and answers: Ville and a union"),
        ),
        evidence=(
            exact(
                "single bets and the mixture keep their mean (rationals)",
                betting.fair,
                mutant("one factor more", extra=2),
            ),
            exact(
                "two pairs, the worst adaptive asker, at most 20 answers (rationals, balls)",
                betting.ever_outside,
                mutant("half the width", share=Fraction(1, 2)),
            ),
            exact("the closed form of the mixture (rationals)", betting.closed_form, mutant("t - 1", offset=-1)),
            proved_step(
                r"$\mathrm{kl}(q, p) \ge 2(q - p)^2$ (SymPy, Z3)",
                betting.pinsker,
                mutant("3 instead of 2", factor=3),
            ),
            exact(
                "three laws of utilities near the golden section, each preferred to the next by .61 (balls)",
                betting.cycle,
                mutant(".62", least=Fraction(62, 100)),
            ),
            text("preference_width"),
        ),
        proof=r"$1 + \beta(o - p)$ has mean 1 under $p$. The uniform mixture over stakes is "
        r"$s!(t-s)!/((t+1)!\,p^s(1-p)^{t-s})$, at least $e^{t\,\mathrm{kl}(\hat p, p)}/(t + 1)$ because a binomial "
        r"probability is at most 1. Ville at $\delta/\text{pairs}$, then Pinsker.",
    ),
)
