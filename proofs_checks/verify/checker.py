r"""The checker: from a log to a certificate, trusting nothing that can be recomputed.

Two things are done side by side. The *certificate* comes from the trajectories, the answers, the candidates and the
weights alone: data matrix, solver error and radius of audit R1 (for any weights in the ball, however they were found),
bonuses of R6, the sets they give, and the regret bounds of R4; and, from questions and answers alone, the likelihood
set of companion G1' and the regret bound of G6. The *claims* of the run are recomputed by the run's own
rule; a log that contradicts itself is not certified, whatever its bounds. Hence a hand-set or unproved multiplier costs
a run nothing here but its own sets: the bounds use the certified radius, which holds for whatever was played.

No code is shared with the algorithms: this package imports formulas and balls from ``bridge_theory``, the file reader
and the definitions of the built-in environments, and nothing else.
"""

from __future__ import annotations

import numpy as np
from threadpoolctl import threadpool_limits

from bridge_algos.run.log_file import RunLog
from bridge_theory.arithmetic.flint_balls import working_precision
from bridge_theory.errors import ComputationError
from proofs_checks.verify.certificate import BOUNDS, Certificate
from proofs_checks.verify.comparator import comparator
from proofs_checks.verify.conditions import assumptions, events, likelihood_withheld, notes, theory_withheld
from proofs_checks.verify.consistency import contradictions
from proofs_checks.verify.facts import Facts, facts
from proofs_checks.verify.header import check_header, unshown
from proofs_checks.verify.walk import Walk

BITS = 96


def verify(log: RunLog) -> tuple[Certificate, ...]:
    """Check every algorithm of a log.

    Raises:
        InputError: when the log is malformed or too large to check.
    """
    check_header(log)
    with threadpool_limits(1):  # small products: threads cost more than they do
        return tuple(check(log, facts(log, algorithm)) for algorithm in log.algorithms)


def check(log: RunLog, given: Facts) -> Certificate:
    """The certificate of one algorithm of a log."""
    with working_precision(BITS):
        reasons = contradictions(given)
        if reasons:
            return _certificate(log, given, reasons, None)
        walk = Walk(given)
        try:
            walk.run()
        except ComputationError as error:
            return _certificate(log, given, [str(error)], None)
        return _certificate(log, given, walk.replay.faults, walk)


def _certificate(log: RunLog, given: Facts, reasons: list[str], walk: Walk | None) -> Certificate:
    rounds, certified = given.rounds, walk is not None and not reasons
    nothing = {name: np.full(rounds, np.inf) for name in BOUNDS}
    spent: dict[str, float] = {}
    if certified and not theory_withheld(given):
        spent = {name: float(failure) for name, failure in events(given).items()}
    return Certificate(
        algorithm=given.algorithm,
        seed=given.seed,
        rounds=rounds,
        certified=certified,
        reasons=tuple(reasons),
        comparator=comparator(given),
        notes=notes(given) if certified else (),
        assumptions=assumptions(given) if certified else (),
        unshown=unshown(log, given) if certified else {},
        spent=spent,
        alone={"likelihood": float(given.delta)} if certified and not likelihood_withheld(given) else {},
        bounds=walk.bounds() if walk is not None and certified else nothing,
        radius=np.full(rounds + 1, np.inf) if walk is None else walk.radius,
        solver_error=np.full(rounds + 1, np.inf) if walk is None else walk.errors,
        set_size=np.full(rounds, np.nan) if walk is None else walk.set_size,
    )
