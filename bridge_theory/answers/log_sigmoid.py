"""A quadratic below the log-likelihood of one answer: what turns expectations of it into closed forms."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound


@bound(
    title="quadratic below the log-likelihood of an answer",
    symbol=r"\log\sigma(z)",
    source="companion G1'",
    group="answers",
    status="sharp",
    words="the log-likelihood of the answer is at least {at_least} nats",
)
def log_sigmoid_lower(m: Arithmetic, *, margin: Value, tangent: Value) -> Value:
    r"""Statement (Jaakkola and Jordan): for all real ``z`` and :math:`\xi\ge0`,

    .. math:: \log\sigma(z)\ge\log\sigma(\xi)+\tfrac12(z-\xi)-\tfrac{\tanh(\xi/2)}{4\xi}(z^2-\xi^2),

    with equality at :math:`z=\pm\xi`; the factor is 1/8 at :math:`\xi=0`. It is computed around :math:`\xi`, as
    :math:`\log\sigma(\xi)+\sigma(-\xi)(z-\xi)-\frac{\tanh(\xi/2)}{4\xi}(z-\xi)^2`, which does not cancel. Source:
    companion G1' (Jaakkola and Jordan 2000). Assumptions: none. Arguments: ``margin`` = ``z``, the log-odds of the
    answer given, ``tangent`` = :math:`\xi` >= 0, any. Returns nats, a lower bound. Errors: ``InputError``.

    >>> round(float(log_sigmoid_lower.estimate(margin=0, tangent=0)), 4)  # log(1/2), where it touches
    -0.6931
    >>> round(float(log_sigmoid_lower.estimate(margin=-2, tangent=1)), 4)  # log sigma(-2) is -2.1269
    -2.1598
    """
    decay = m.exp(-tangent)
    factor = m.if_at_most(
        tangent,
        0,
        lambda: m.number(1) / 8,
        lambda: -m.expm1(-tangent) / (4 * tangent * (1 + decay)),
    )
    step = margin - tangent
    return step * decay / (1 + decay) - m.log1p(decay) - factor * step**2
