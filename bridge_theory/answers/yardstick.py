"""How few answers any method could do with."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, requires


@bound(
    title="answers that any method needs",
    symbol=r"\frac{\mathrm{kl}(1-\delta,\delta)}D",
    source="companion G9",
    group="answers",
    status="sharp",
    words="every method that errs with at most this probability needs at least {at_least} answers on average",
    assumptions=(
        "exactly one candidate is good enough, and the information is that of the best design over a named pool",
        "the transportation inequality is cited (Kaufmann, Cappe and Garivier 2016), not checked here",
    ),
    conditions=(requires(lambda delta: delta * 2 <= 1, "delta <= 1/2"),),
    monotone={
        "information": falls("it divides"),
        "delta": falls("kl(1 - delta, delta) falls up to delta = 1/2"),
    },
)
def fewest_answers(m: Arithmetic, *, information: Value, delta: Value) -> Value:
    r"""Statement: :math:`E[\tau]\ge\mathrm{kl}(1-\delta,\delta)/D` with
    :math:`\mathrm{kl}(1-\delta,\delta)=(1-2\delta)\log\frac{1-\delta}\delta`.

    Source: companion G9 (Kaufmann, Cappe and Garivier 2016, cited). ``D`` is the largest information per answer of any
    design over a named pool against the nearest alternative, so that the value is an estimate where ``D`` is.
    Assumptions: one good candidate. Arguments: ``information`` = ``D`` > 0 nats, ``delta`` in (0, 1/2]. Returns a
    number of answers. Errors: ``InputError`` for a larger ``delta``.

    >>> round(float(fewest_answers.estimate(information=0.15, delta=0.05)), 1)
    17.7
    """
    excess = 1 - 2 * delta
    return excess * m.log1p(excess / delta) / information
