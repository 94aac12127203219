"""The checker of asking sessions: from questions and answers alone to a certified gap, trusting nothing recomputable.

The record's claims are compared with what is found; no number in it is part of a bound, except W, delta and the prior,
which must be the documented ones, and the environment and demonstrations, from which candidates and features are made.
No code is shared with the session's algorithms.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from bridge_theory.arithmetic.flint_balls import working_precision
from bridge_theory.errors import InputError
from proofs_checks.asking_checker.barrier import Region
from proofs_checks.asking_checker.candidates import features_of
from proofs_checks.asking_checker.earlier import Earlier
from proofs_checks.asking_checker.evidence import level
from proofs_checks.asking_checker.facts import Claims, Facts, claims, facts
from proofs_checks.asking_checker.gap import Gap
from proofs_checks.asking_checker.model_test import REFUTED, evidence_against
from proofs_checks.asking_checker.region import is_empty, is_inside, proved_log_likelihood, region_at
from proofs_checks.asking_checker.slopes import tangents
from proofs_checks.asking_checker.vacuous import best_somewhere
from proofs_checks.asking_checker.verdict import Verdict
from proofs_checks.verify.enclosed import Enclosed, FloatArray
from proofs_checks.verify.features import IntArray

BITS = 64

AGREES = 1e-6
"""By how much of the goal a claimed gap may lie below the checker's."""

ALLOWED = 1e-9
"""Nats that stand for none: features are known to a rounding only, so that a gap of exactly 0 cannot be shown."""

REFUTATION = (
    "Forecasts from outside of the model explain these answers at least 100 times better than any weights within W; "
    "nothing is certified."
)
UNCONFIRMED = "The session says so, which is not confirmed here; nothing is certified."


def check(record: Mapping[str, Any]) -> Verdict:
    """The verdict on the record of a session."""
    seed = record.get("seed")
    seed = seed if type(seed) is int else -1
    claiming = isinstance(record.get("claims"), dict) and record["claims"].get("certified") is True
    with threadpool_limits(1), working_precision(BITS):
        try:
            given = facts(record)
            claimed = claims(record, given)
            return _verdict(seed, given, claimed)
        except InputError as error:
            return Verdict(seed, "refused", claiming, (str(error),))


def _verdict(seed: int, given: Facts, claimed: Claims) -> Verdict:
    fixed, log = given.setting, given.log
    least = level(log, fixed.precisions, fixed.delta)
    region = region_at(log, least, fixed.weight_bound)
    shared: dict[str, Any] = {
        "seed": seed,
        "claims": claimed.certified,
        "target": fixed.target,
        "goal": _goal(given),
        "claimed_gap": claimed.gap,
        "failure": fixed.delta,
        "margin": proved_log_likelihood(log, region.inside) - least,
        "covered": None if fixed.teacher is None else proved_log_likelihood(log, fixed.teacher) >= least,
        "answers": len(log.answers),
        "skipped": log.skipped,
        "candidates": len(given.candidates.features),
        "policies": given.candidates.size,
        "assumptions": _assumptions(given),
    }
    if is_empty(log, region):
        empty = "No weights agree with these answers; nothing is certified."
        return Verdict(verdict="contradicted", reasons=(empty,), **shared)
    if evidence_against(log, given.pool, region, fixed.delta) >= REFUTED:
        return Verdict(verdict="contradicted", reasons=(REFUTATION,), **shared)
    if claimed.contradicted:
        return Verdict(verdict="contradicted", reasons=(UNCONFIRMED,), **shared)
    if not is_inside(log, region.inside, least, fixed.weight_bound):
        return Verdict(verdict="not certified", reasons=("The likelihood set may be empty.",), **shared)
    found = certified_gap(given, region, claimed)
    reasons = _failures(found.value, fixed.target, claimed)
    if not reasons:
        inside = partial(is_inside, log, level=least, weight_bound=fixed.weight_bound)
        somebody = best_somewhere(given.candidates, found.deviations, region, found.tangents, inside)
        if somebody is False:
            nobody = "No candidate is best under weights that agree with these answers; nothing is certified."
            return Verdict(verdict="contradicted", reasons=(nobody,), **shared)
        reasons = () if somebody else ("Whether a candidate can be best at all is not known.",)
    if not reasons and not claimed.certified:
        reasons = ("The goal is found to be reached, but the session itself claims no certificate.",)
    return Verdict(verdict="not certified" if reasons else "certified", reasons=reasons, gap=found.value, **shared)


def certified_gap(given: Facts, region: Region, claimed: Claims) -> Gap:
    """Bounds for every candidate; where a certificate is claimed, with what earlier sets say too."""
    log, fixed = given.log, given.setting
    target = max(ALLOWED, min(fixed.target, claimed.gap) if claimed.certified else fixed.target)

    def known(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        g, h = tangents(log, points)
        return g[:, None], np.nextafter(h - region.level, np.inf)[:, None]

    rivals = partial(deviations, given) if given.candidates.complete else None
    earlier = Earlier(log, fixed.precisions, fixed.delta, region).cuts if claimed.certified else None
    gap = Gap(given.candidates, given.anchor, given.recommended, region, known, rivals, target, earlier)
    gap.tighten(1e-3 * fixed.target or 1e-6)
    return gap


def deviations(given: Facts, policies: IntArray) -> Enclosed:
    """(B, S (A - 1), d) features of the policies that differ from each of B policies in one state."""
    mdp = given.setting.mdp
    changes = [(s, k) for s in range(mdp.n_states) for k in range(1, mdp.n_actions)]
    others = np.repeat(policies[:, None], len(changes), axis=1)
    for place, (state, more) in enumerate(changes):
        others[:, place, state] = (policies[:, state] + more) % mdp.n_actions
    found = features_of(mdp, given.setting.table, others.reshape(-1, mdp.n_states))
    return Enclosed(found.mid.reshape(len(policies), len(changes), -1), found.rad)


def _failures(gap: float, target: float, claimed: Claims) -> tuple[str, ...]:
    if gap > max(target, ALLOWED):
        return (f"The gap that is found is {gap:.6g} nats.",)
    if claimed.certified and gap > claimed.gap + max(ALLOWED, AGREES * target):
        return (f"The session claims a gap of {claimed.gap:.6g} nats; {gap:.6g} nats are found.",)
    return ()


def _goal(given: Facts) -> str:
    if given.setting.rho:
        share = 100 / (1 + given.setting.rho)
        return f"at least {share:.4g} % of what there is to gain over the reference is gained, up to 1e-9 nats"
    return f"the recommended candidate is within {given.setting.target:.4g} nats of the best"


def _assumptions(given: Facts) -> tuple[str, ...]:
    fixed = given.setting
    who = (
        "the demonstrator is deterministic and, among deterministic stationary policies, best for the teacher's utility"
        if given.candidates.complete
        else f"the best of these {len(given.candidates.features)} candidates is meant, which are a sample"
    )
    model = f"answers follow P(first is better) = sigma(<x, w>) with ||w|| <= W = {fixed.weight_bound:.6g}"
    how = "the session had only a simulator; this check computes features from the dynamics and uses no rollout of it"
    return (model, who, how) if fixed.simulated else (model, who)
