"""Appendix: maximum likelihood for density estimation, and the likelihood of trajectories."""

from __future__ import annotations

from fractions import Fraction

from proofs_checks.claim import Claim, link
from proofs_checks.evidence import cited, exact, mutant, refuted
from proofs_checks.offline.checks import maximum_likelihood
from proofs_checks.offline.evidence import text
from proofs_checks.offline.repairs_policy import T6, T6_COVER

CLAIMS = (
    Claim(
        label="def:log_covering",
        name="logarithmic cover",
        topic="offline",
        verdict="definition",
        statement=r"""$\mathcal G'$ is an $\varepsilon$-cover if every $g$ has a $g'$ with $\log(g(x)/g'(x)) \le
            \varepsilon$ for all $x$; $\mathcal N_{\log}$ is the smallest size.""",
        because=r"A definition, one-sided on purpose. $\mathcal G' \subset \Delta(\mathcal X)$ is meant.",
    ),
    Claim(
        label="eq: mle-estimator",
        name="maximum likelihood",
        topic="offline",
        verdict="definition",
        statement=r"$\hat g = \arg\max_{g\in\mathcal G}\sum_i\log g(x_i)$.",
        because="A definition; ties are broken arbitrarily, and the bounds here hold for the worst tie-break.",
    ),
    Claim(
        label="lemma:fostermle",
        name="Hellinger error of maximum likelihood",
        topic="offline",
        verdict="false",
        statement=r"""With probability $1-\delta$, $H^2(\hat g, g^*) \le \inf_\varepsilon\{6\log(2\mathcal
            N_{\log}(\varepsilon)/\delta^{-1})/n + 4\varepsilon\} + 2\inf_g\log(1 + \chi^2(g^*\|g))$.""",
        because=r"""As typeset, $2\mathcal N/\delta^{-1} = 2\mathcal N\delta$, and the bound can be negative. With
            $\delta$ in place of $\delta^{-1}$ it is true, and T6 has the constants 3, 2, 1.""",
        evidence=(refuted("offline-as-typeset"), text("mle_covering_stated", "mle_finite_stated")),
        repairs=(T6, T6_COVER),
    ),
    Claim(
        label="lemma:fostermle",
        part="tools",
        name="Renyi divergence and exponential inequality",
        topic="offline",
        verdict="true",
        statement=r"""$-n\log\operatorname{E}_{g^*}e^{\frac12\log(g/g^*)} = \frac n2D_{1/2}(g\|g^*)$, and
            $\sum_t-\log\operatorname{E}_{t-1}e^{-X_t} \le \sum_tX_t + \log(1/\delta)$ for all horizons with
            probability $1-\delta$.""",
        because=r"""The first is the definition of the divergence, the second Ville's inequality for an exponential
            martingale.""",
        links=(
            link("the identity", "renyi_identity"),
            link("the exponential martingale has mean 1", "exponential_inequality"),
            link("a nonnegative martingale of mean 1 exceeds $1/\\delta$ with probability at most $\\delta$", "cited"),
        ),
        evidence=(
            exact(
                "the first identity on generated laws, in exact algebra",
                maximum_likelihood.renyi_identity,
                mutant("order 1 instead of 1/2", order=1),
            ),
            exact(
                "the exponential martingale has mean exactly 1, over all samples of generated laws",
                maximum_likelihood.exponential_inequality,
                mutant("half the compensator", factor=Fraction(1, 2)),
            ),
            cited(
                r"""Ville 1939: a nonnegative martingale of mean 1 ever exceeds $1/\delta$ with probability at most
                    $\delta$"""
            ),
        ),
        proof=r"""$\exp(-\sum X_t)/\prod\operatorname{E}_{t-1}e^{-X_t}$ is a nonnegative martingale of mean 1; where
            it stays below $1/\delta$, take logarithms.""",
    ),
    Claim(
        label="eq: mle density class",
        name="likelihood of trajectories",
        topic="offline",
        verdict="definition",
        statement=r"""$\arg\max_{\pi, P}\sum_i\sum_j\log\pi(a_j^i|s_j^i) + \sum_i\sum_j\log P(s_{j+1}^i|s_j^i,
            a_j^i)$.""",
        because=r"""A definition: policy and kernel separate. The display writes $\pi_i$ for $\pi_j$, starts at $j =
            0$, where nothing is defined, and calls trajectories continuous, where the counting measure is meant.""",
    ),
)
