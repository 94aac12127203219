"""The offline confidence set's radius as the paper states it: the main theorem, and with known dynamics."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total

_SETTING = (
    "the expert is deterministic and stationary and is in the policy class",
    "the transition kernel is stationary and is in the model class",
    "the demonstrations are independent",
)


@bound(
    title="policy constant of the radius",
    symbol=r"\alpha",
    source="thm:tabular_confidence_set",
    group="offline",
    status="stated",
    words="alpha is {value}",
    monotone={
        "S": rises("it is under the root"),
        "A": rises("log rises"),
        "delta": falls("log(2A/delta) falls"),
    },
)
def alpha_offline(m: Arithmetic, *, S: Value, A: Value, delta: Value) -> Value:
    r"""Statement: :math:`\alpha=\sqrt{4|S|\log(2|A|/\delta)}`.

    Source: ``thm:tabular_confidence_set``. Assumptions: none, a definition. Arguments: ``S, A`` positive integers,
    ``delta`` in (0, 1). Returns a number without unit. Errors: ``InputError`` outside the domain.

    >>> round(float(alpha_offline.estimate(S=5, A=4, delta=0.05)), 4)
    10.0749
    """
    return m.sqrt(4 * S * m.log(2 * A / delta))


@bound(
    title="transition constant of the radius",
    symbol=r"\beta",
    source="thm:tabular_confidence_set",
    group="offline",
    status="stated",
    words="beta is {value}",
    monotone={
        "S": rises("it is under the root"),
        "A": rises("it is under the root"),
        "H": rises("log rises"),
        "n": rises("log rises"),
        "delta": falls("log(2nH/delta) falls"),
    },
)
def beta_offline(m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, delta: Value) -> Value:
    r"""Statement: :math:`\beta=\sqrt{4|S|^2|A|\log(2nH/\delta)}`.

    Source: ``thm:tabular_confidence_set``. Assumptions: none, a definition. Arguments: ``S, A, H, n`` positive
    integers, ``delta`` in (0, 1). Returns a number without unit. Errors: ``InputError`` outside the domain.

    >>> round(float(beta_offline.estimate(S=5, A=4, H=8, n=2, delta=0.05)), 3)
    50.839
    """
    return m.sqrt(4 * S**2 * A * m.log(2 * n * H / delta))


@bound(
    title="offline confidence-set radius",
    symbol=r"\mathrm{Radius}",
    source="thm:tabular_confidence_set",
    group="offline",
    status="stated",
    trivial=1,
    spends=("delta",),
    words="the expert lies within Hellinger distance {value} of the cloned policy under the estimated dynamics",
    assumptions=(
        *_SETTING,
        "every state-action pair the expert visits at a step has probability at least gamma_min there",
    ),
    monotone={
        "S": rises("alpha and beta rise"),
        "A": rises("alpha and beta rise"),
        "H": rises("beta rises, and so does the factor sqrt(H ...)"),
        "n": falls("log(cn)/n falls on the integers for every c > 2"),
        "delta": falls("alpha and beta fall"),
        "gamma_min": falls("it divides"),
    },
)
def offline_radius(m: Arithmetic, *, S: Value, A: Value, H: Value, n: Value, delta: Value, gamma_min: Value) -> Value:
    r"""Statement: with :math:`\alpha=\sqrt{4|S|\log(2|A|/\delta)}` and :math:`\beta=\sqrt{4|S|^2|A|\log(2nH/\delta)}`,

    .. math:: H(\hat P^{\pi^*},\hat P^{BC})\le\mathrm{Radius}=\frac{\alpha}{\sqrt n}+\frac{\beta}{\sqrt n}
       \Bigl(1+\sqrt{H\bigl(1+\tfrac{2\alpha}{\gamma_{\min}\sqrt n}\bigr)}\Bigr)\quad\text{w.p. }1-\delta.

    Source: ``thm:tabular_confidence_set``, repeated in the appendix's performance guarantees. Assumptions:
    deterministic stationary expert and stationary kernel, both realizable; minimum visitation ``gamma_min``.
    Arguments: ``S, A, H, n`` positive integers, ``delta`` in (0, 1), ``gamma_min`` in (0, 1]. Returns a Hellinger
    distance; vacuous from 1 on. Errors: ``InputError`` outside the domain.

    >>> round(float(offline_radius.estimate(S=5, A=4, H=8, n=2, delta=0.05, gamma_min=0.1)), 1)
    1261.0
    """
    alpha, beta, root = (
        alpha_offline(m, S=S, A=A, delta=delta),
        beta_offline(m, S=S, A=A, H=H, n=n, delta=delta),
        m.sqrt(n),
    )
    return total(
        policy=alpha / root,
        transition=beta / root,
        transfer=beta / root * m.sqrt(H * (1 + 2 * alpha / (gamma_min * root))),
    )
