"""What a record says, read, checked against itself, and refused where it contradicts itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bridge_theory.errors import InputError
from proofs_checks.asking_checker.candidates import Candidates, candidates, cells, features_of, version_space
from proofs_checks.asking_checker.entries import part, same, table, text, truth, whole
from proofs_checks.asking_checker.log import Log, read_log
from proofs_checks.asking_checker.reference import reference
from proofs_checks.asking_checker.setting import Setting, setting
from proofs_checks.asking_checker.trajectories import demonstrated, trajectories
from proofs_checks.verify.enclosed import Enclosed
from proofs_checks.verify.features import IntArray


@dataclass(frozen=True, eq=False)
class Facts:
    """Args:
    setting: what was fixed beforehand.
    candidates: as the checker lists them.
    log: questions and answers.
    recommended: index of the recommended candidate.
    anchor: (d,) what contenders are compared with, enclosed.
    pool: (M, d) features of the items that questions show.
    """

    setting: Setting
    candidates: Candidates
    log: Log
    recommended: int
    anchor: Enclosed
    pool: IntArray


def facts(record: Mapping[str, Any]) -> Facts:
    """Read a record.

    Raises:
        InputError: for an entry that is malformed, or that other entries contradict.
    """
    fixed, configured = setting(record), part(record, "configuration")
    recorded = _demonstrations(record, configured, fixed)
    listed = _candidates(record, configured, fixed, recorded)
    pool = trajectories(record.get("pool"), "pool", fixed.mdp)
    if len(pool[0]) > whole(configured, "pool", 2):
        raise InputError(
            f"pool must hold at most the {configured['pool']} configured trajectories, got {len(pool[0])}."
        )
    items = fixed.table.of_trajectories(*pool)
    log = read_log(record.get("questions"), items, fixed.teacher is None)
    asked = len(log.answers) + log.skipped
    if asked > whole(configured, "max_questions"):
        raise InputError(f"{asked} questions were asked, more than max_questions allows.")
    policy = table([record.get("recommended")], "recommended", fixed.mdp.n_states, fixed.mdp.n_actions)
    index, own = _recommended(policy, listed, fixed)
    anchor = own
    if fixed.rho or not fixed.simulated:  # a session with a simulator has exact features of no reference
        named = reference(record, configured, fixed, listed, recorded)
    if fixed.rho:
        mid = (1 + fixed.rho) * own.mid - fixed.rho * named.mid
        anchor = Enclosed(mid, (1 + fixed.rho) * (own.rad + named.rad) + 1e-15 * (1 + fixed.rho) * own.size)
    return Facts(fixed, listed, log, index, anchor, items)


def _demonstrations(record: Mapping[str, Any], configured: dict[str, Any], fixed: Setting) -> IntArray:
    given = record.get("demonstrations")
    expected, n_states = whole(configured, "n_demonstrations"), fixed.mdp.n_states
    if configured.get("demonstrations") is None:
        found = len(given["states"]) if isinstance(given, dict) and isinstance(given.get("states"), list) else 0
        same("the number of demonstrations", found, expected)
    if given is None:
        return np.full(n_states, -1, dtype=np.int64)
    return demonstrated(*trajectories(given, "demonstrations", fixed.mdp), n_states)


def _candidates(
    record: Mapping[str, Any], configured: dict[str, Any], fixed: Setting, recorded: IntArray
) -> Candidates:
    complete, mdp = truth(record, "complete"), fixed.mdp
    limit = whole(configured, "limit", 1)
    listable = mdp.n_actions ** int((recorded < 0).sum()) <= limit
    same("complete", complete, listable or fixed.simulated)
    if complete:
        same("candidates", record.get("candidates"), None)
        return candidates(mdp, fixed.table, version_space(recorded, mdp.n_actions), complete)
    policies = table(record.get("candidates"), "candidates", mdp.n_states, mdp.n_actions)
    if len(policies) > limit or ((policies != recorded) & (recorded >= 0)).any():
        raise InputError("the sampled candidates are more than the limit, or contradict a demonstration.")
    return candidates(mdp, fixed.table, policies, complete)


def _recommended(policy: IntArray, listed: Candidates, fixed: Setting) -> tuple[int, Enclosed]:
    """The candidate that stands for the recommended policy, and that policy's own features."""
    own = features_of(fixed.mdp, fixed.table, policy)
    distances = np.abs(listed.features - own.mid).max(axis=1)
    index = int(distances.argmin())
    if distances[index] > listed.radii[index] + own.rad:
        raise InputError("the recommended policy is none of the candidates.")
    return index, Enclosed(own.mid[0], own.rad)


@dataclass(frozen=True)
class Claims:
    """What a session says about itself."""

    certified: bool
    contradicted: bool
    gap: float


def claims(record: Mapping[str, Any], given: Facts) -> Claims:
    """The session's claims, refused where they contradict the record or each other."""
    entries, outcome = part(record, "claims"), part(record, "outcome")
    certified, contradicted = truth(entries, "certified"), truth(entries, "contradicted")
    gap = entries.get("gap")
    if isinstance(gap, bool) or not isinstance(gap, int | float) or not 0 <= gap < 1e12:
        raise InputError(f"the claimed gap is {gap!r}, expected a number of at least 0.")
    same("claims.answers", whole(entries, "answers"), len(given.log.answers))
    rounded = np.unique(cells(given.candidates.features, 1e-10, 0.5)[1]).size
    counts = (len(given.candidates.features), rounded)
    if given.setting.simulated:  # it merges what its rollouts do not tell apart, and states that they seldom visit
        if whole(entries, "candidates", 1) > given.candidates.size:
            raise InputError(f"the session compared more candidates than the {given.candidates.size} policies.")
        whole(outcome, "episodes", 1)
    elif whole(entries, "candidates", 1) not in counts:
        raise InputError(
            f"the session compared {entries['candidates']} candidates; the demonstrations leave "
            f"{len(given.candidates.features)} with different features."
        )
    if certified:  # a session may also withhold what it could claim
        same("claims.certified", certified, not contradicted and gap <= given.setting.target)
    text(entries, "sentence")
    seed, asked = whole(record, "seed"), len(given.log.answers) + given.log.skipped
    expected = {"seed": seed, "questions": asked if certified else None, "candidates": entries["candidates"]}
    for name, value in expected.items():
        same(f"outcome.{name}", outcome.get(name), value)
    if not given.setting.rho:  # with a share the outcome tells nats, the claim what must be at most 0
        same("outcome.certified_gap", float(outcome.get("certified_gap", -1.0) or 0.0), float(gap))
    return Claims(certified, contradicted, float(gap))
