"""Evidence that several claims of this half share."""

from __future__ import annotations

from collections.abc import Mapping

from proofs_checks.claim import Link, link
from proofs_checks.evidence import Evidence, agrees, mutant, proved_step
from proofs_checks.online.checks import directions as checks
from proofs_checks.online.checks import orders, transcription


def text(*names: str) -> Evidence:
    """That bridge_theory evaluates the printed formulas: a second transcription agrees."""
    words = "the formulas of bridge_theory agree with a second transcription of the text"
    return agrees(words, transcription.formulas, mutant("a thousandth more", factor=1.001), names=names)


def unbounded(family: str, words: str) -> Evidence:
    """That no hidden constant helps: the ratio of both sides tends to infinity along a family of instances."""
    return proved_step(
        f"the ratio of both sides tends to infinity {words}",
        orders.unbounded,
        mutant("divided by the variable of the family", divided=1),
        family=family,
    )


_BOTH_STAY = (
    r"One state, two actions, $n = 22$, $B = \frac12$, $\delta = \frac1{20}$, $\lambda = \frac18$ and $W = 1/\sqrt "
    r"T$, so "
    r"that $4 \le \kappa \le 5$. Both actions stay in every set, as $\gamma_t \ge 4\kappa\sqrt{\log 20} > 27$ and "
    r"$2W\sqrt{\kappa\lambda + T} < 3$; the pair of both is played in every round. "
)
FAMILY: Mapping[str, str] = {
    "known rate": _BOTH_STAY + r"The regret is $WT/2$.",
    "large horizon": _BOTH_STAY + r"The regret is $WT/2$.",
    "term 2": _BOTH_STAY + r"The norms sum to at least $2(\sqrt T - 1)$, while the drifts sum to at most "
    r"$(\log T + T)/4$; even a hidden factor of $10^6$ inside the logarithm does not help.",
    "simplified rate": r"Both sides are formulas in $n$ at $T = 100$ and $\gamma_{\min} = 1$; their ratio is taken.",
    "drift sum": r"At $n = 1$ every term $t/(1+t)$ is at least $\frac12$, and $\min\{T, \log T\} = \log T$.",
    "offline radius": r"$\sqrt n$ times the radius is at least $\beta$, which grows like $\sqrt{\log n}$.",
    "vanishing scale": r"$\Gamma$ is a multiple of $\log(TB/(\kappa\delta))$, which vanishes as $TB/(\kappa\delta)$ "
    r"falls to 1, while the first round compares both actions and costs $BW$.",
    "squared bonuses": r"Of $2T+1$ actions one is demonstrated; each round plays two others for the first time, whose "
    r"bonus is $2\eta$ with $\eta = 1$ in rounds up to $T - 1$: the left side is at least $4(T-1)$.",
}
"""Why the ratio of both sides is at least the one whose limit ``unbounded`` takes."""


def refuted_order(counterexample: str) -> tuple[Link, ...]:
    """What refutes a statement of order: an instance, and a family on which no hidden constant helps."""
    return (
        link("an instance exceeds the bound with a generous constant", counterexample),
        link("the ratio that is printed for a family is unbounded, so that no constant serves", "unbounded"),
        link("the ratio of both sides is at least that, for every member of the family"),
    )


def directions(group: str) -> Evidence:
    """That the formulas of a group move as declared, which ``solve_for`` relies on."""
    words = (
        f"every {group} formula moves in its declared directions: the derivative's sign over whole intervals of "
        "one parameter, the others at a reference setting"
    )
    return proved_step(words, checks.directions, mutant("the opposite directions", flipped=True), group=group)
