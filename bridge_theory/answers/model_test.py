"""When answers contradict the model: the lead at which a forecaster from outside refutes it."""

from __future__ import annotations

from bridge_theory.core import Arithmetic, Value, bound, falls, rises, total


@bound(
    title="lead of an outside forecaster that refutes the model",
    symbol=r"\log(k/\delta_M)",
    source="companion G4",
    group="answers",
    status="sharp",
    spends=("delta",),
    words="no forecaster of the mixture is ever {value} nats ahead of the best weights unless the model is wrong",
    assumptions=("the forecasts are made before the answers, and the mixture weighs all forecasters equally",),
    monotone={"forecasters": rises("log k is added"), "delta": falls("log(1/delta) falls")},
)
def refutation_threshold(m: Arithmetic, *, forecasters: Value, delta: Value) -> Value:
    r"""Statement: for an equal mixture of ``k`` forecasters :math:`Q^i`, under the model with probability
    :math:`1-\delta_M`, for all ``t`` and ``i``, :math:`Q_t^i-\max_w\ell_t(w)<\log k+\log(1/\delta_M)`.

    Source: companion G4 (an e-process divided by the best of the model); half and half with the forecaster inside the
    model is ``k = 2``. Assumptions: forecasts are made before the answers. Arguments: ``forecasters`` = ``k`` a
    positive integer, ``delta`` in (0, 1). Returns nats: a lead of as much refutes the model. Errors: ``InputError``.

    >>> round(float(refutation_threshold.estimate(forecasters=2, delta=0.05)), 4)
    3.6889
    """
    return total(mixture=m.log(forecasters), confidence=-m.log(delta))
