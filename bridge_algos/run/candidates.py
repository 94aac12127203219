"""Which policies an algorithm of a run searches, how they were found, and both in words."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from bridge_algos.mdp import IntArray
from bridge_algos.offline.ball_chain import BURN_IN, CHAINS
from bridge_algos.offline.policy_set import PolicySet
from bridge_algos.policies import all_policies, random_policies
from bridge_algos.run.config import RunConfig

ENOUGH = 100
"""Policies accepted by rejection sampling below which the clone joins them: they no longer stand for the set."""

WAYS = {
    "all": "all policies",
    "set": "every policy of the offline set",
    "sample": "a uniform sample of the offline set, and the clone",
    "chain": "members of the offline set that a Gibbs chain found, and the clone; the set is too large to be listed",
    "rejection": "those of the random policies proposed that lie in the offline set",
    "few": "the clone, and the few of the random policies proposed that lie in the offline set",
    "clone": "the clone alone: none of the random policies proposed lies in the offline set",
    "bc": "the clone",
    "lent": "candidates lent from the offline set, at most half, and random policies",
}
"""How the policies searched were found; only the first two leave none of theirs out."""

EXHAUSTIVE = ("all", "set")
DEGENERATE = ("few", "clone")
REMEDY = "use --set candidates=exact, which samples the set by a chain where it cannot be listed"


@dataclass(frozen=True, eq=False)
class Candidates:
    """The policies that an algorithm searches.

    Args:
        policies: (N, S), all different, in random order, so that their order breaks no tie.
        way: one of ``WAYS``.
        accepted: how many proposals rejection sampling accepted; NaN where it was not used.
        sweeps: sweeps of the Gibbs chain after its burn-in; NaN where none was run.
    """

    policies: IntArray
    way: str
    accepted: float = np.nan
    sweeps: float = np.nan


def offline_candidates(config: RunConfig, ball: PolicySet, rng: np.random.Generator) -> Candidates:
    """Candidates from the offline set, as configured; the clone is one, unless rejection sampling accepts enough."""
    if config.candidates == "rejection":
        found = ball.rejection_sample(config.proposals, rng)
        if len(found) >= ENOUGH:
            return Candidates(rng.permutation(found), "rejection", len(found))
        way = "few" if len(found) else "clone"
        return Candidates(rng.permutation(_distinct(ball.center[None], found)), way, len(found))
    if not ball.is_listed:
        chain = ball.chain_sample(config.candidate_limit, rng)
        return Candidates(rng.permutation(chain.policies), "chain", sweeps=chain.sweeps)
    if ball.count() <= config.candidate_limit:
        return Candidates(rng.permutation(ball.enumerate(config.candidate_limit)), "set")
    drawn = _distinct(ball.center[None], ball.sample(config.candidate_limit, rng))
    return Candidates(rng.permutation(drawn[: config.candidate_limit]), "sample")


def search_space(
    config: RunConfig, ball: PolicySet, rng: np.random.Generator, candidates_rng: np.random.Generator
) -> Candidates:
    """PbRL's search space: all policies, or ``search_size`` of which at most half come from the offline set.

    The paper lends PbRL the offline candidates where it cannot search everything; half is the most it gets here, so
    that it never becomes BRIDGE.
    """
    n_states, n_actions = ball.dynamics.n_states, ball.dynamics.n_actions
    if n_actions**n_states <= config.candidate_limit:
        return Candidates(rng.permutation(all_policies(n_states, n_actions)), "all")
    found = offline_candidates(config, ball, candidates_rng)
    lent = found.policies[: config.search_size // 2]
    others = random_policies(config.search_size - len(lent), n_states, n_actions, rng)
    return Candidates(rng.permutation(_distinct(lent, others)), "lent", found.accepted, found.sweeps)


def _distinct(*parts: IntArray) -> IntArray:
    """The rows of some batches, each once, where it stands first."""
    together = np.concatenate(parts)
    return np.asarray(together[np.sort(np.unique(together, axis=0, return_index=True)[1])])


def recorded(search: dict[str, Candidates]) -> dict[str, Any]:
    """What a result keeps of the searches of its algorithms: variables along ``algorithm``, with units."""
    kept = list(search.values())
    return {
        "searched": ("algorithm", [len(found.policies) for found in kept], {"units": "policies"}),
        "search_way": ("algorithm", [found.way for found in kept], {"units": "name", "meanings": json.dumps(WAYS)}),
        "accepted": ("algorithm", [float(found.accepted) for found in kept], {"units": "proposals"}),
        "chain_sweeps": ("algorithm", [float(found.sweeps) for found in kept], {"units": "sweeps"}),
    }


def sentence(found: Candidates) -> str:
    """What is searched in one seed.

    >>> sentence(Candidates(np.array([[0, 1]]), "clone", 0))
    'about 1 candidate: the clone alone: none of the random policies proposed lies in the offline set (0 accepted)'
    """
    n = len(found.policies)
    return f"about {_number(n, n)}: {WAYS[found.way]}{_details(found.accepted, found.sweeps)}"


def search_lines(results: xr.Dataset) -> list[str]:
    """What each algorithm of a run searched, one sentence each and way; a degenerate search says what to do."""
    lines, seeds = [], results.sizes["seed"]
    for name in (str(n) for n in results.algorithm.values if n != "bc"):
        own = results[["searched", "search_way", "accepted", "chain_sweeps"]].sel(algorithm=name)
        for way in dict.fromkeys(own.search_way.values.tolist()):
            part = own.isel(seed=np.flatnonzero(own.search_way.values == way))
            n, accepted, sweeps = (part[key].values for key in ("searched", "accepted", "chain_sweeps"))
            where = "" if len(n) == seeds else f" in {len(n)} of {seeds} seeds"
            details = _details(float(np.median(accepted)), float(np.median(sweeps)))
            what = "searches" if way in EXHAUSTIVE else "is only about"
            remedy = f"; {REMEDY}" if way in DEGENERATE else ""
            lines.append(f"{name} {what} {_number(int(n.min()), int(n.max()))}{where}: {WAYS[way]}{details}{remedy}")
    return lines


def _number(least: int, most: int) -> str:
    if least < most:
        return f"{least:,} to {most:,} candidates"
    return f"{most:,} candidate{'s' if most != 1 else ''}"


def _details(accepted: float, sweeps: float) -> str:
    told = [f"{accepted:,.0f} accepted"] * bool(np.isfinite(accepted))
    told += [f"{CHAINS} chains, {BURN_IN} sweeps before the first, then {sweeps:.0f}"] * bool(np.isfinite(sweeps))
    return f" ({', '.join(told)})" if told else ""


def label(results: xr.Dataset, name: str) -> str:
    """What a figure's legend adds to an algorithm's name: nothing where no policy of its set was left out."""
    if name == "bc" or "search_way" not in results:
        return ""
    own = results.sel(algorithm=name)
    ways, n = own.search_way.values, own.searched.values
    alone = int((ways == "clone").sum())
    if alone:
        return ", the clone alone" + ("" if alone == len(ways) else f" in {alone} of {len(ways)} seeds")
    partly = n[~np.isin(ways, EXHAUSTIVE)]
    return f", about {_number(int(partly.min()), int(partly.max()))}" if len(partly) else ""
