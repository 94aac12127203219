"""Ways to tamper with the record of an asking session, and a slow, plain judge of what a record implies.

The judge shares nothing with the checker but the hint q: it lists policies with itertools, computes features by a
recursion in plain floats, evidence by a fine Gauss-Hermite rule, and each gap with cvxpy.
"""

import contextlib
import copy
import itertools
import warnings
from functools import cache
from typing import Any

import cvxpy as cp
import numpy as np

from bridge_algos.envs.registry import make_mdp
from bridge_algos.mdp import TabularMDP
from proofs_checks.asking_checker.fit import fitted_normal

Record = dict[str, Any]
NODES, MASSES = np.polynomial.hermite_e.hermegauss(120)
MASSES = MASSES / MASSES.sum()


def tampered(record: Record, rng: np.random.Generator) -> tuple[str, Record]:
    """A random change, with bookkeeping repaired as a forger would, who claims a certificate."""
    forged = copy.deepcopy(record)
    kind = str(rng.choice(sorted(KINDS)))
    KINDS[kind](forged, rng)
    if isinstance(forged["questions"], list):
        answers = sum(isinstance(row, list) and len(row) == 3 and row[2] is not None for row in forged["questions"])
        if kind != "claims":
            forged["claims"]["answers"] = answers
        if rng.random() < 0.7 and kind != "claims":
            forged["claims"] |= {"certified": True, "contradicted": False}
            if isinstance(forged["goal_nats"], float):
                forged["claims"]["gap"] = min(forged["claims"]["gap"], forged["goal_nats"])
        forged["outcome"]["questions"] = len(forged["questions"]) if forged["claims"]["certified"] else None
        forged["outcome"]["certified_gap"] = forged["claims"]["gap"]
    return kind, forged


def _answers(r: Record, rng: np.random.Generator) -> None:
    questions = r["questions"]
    way = rng.integers(8)
    if not questions:
        r["questions"] = [[0, 1, 1]]
    elif way < 3:
        for i in rng.choice(len(questions), size=min(len(questions), 1 + 4**way), replace=False):
            questions[i][2] = 1 - questions[i][2]
    elif way == 3:
        del questions[rng.integers(len(questions)) :]
    elif way == 4:
        questions[rng.integers(len(questions))][2] = rng.choice([None, True, 2, 0.5, "1"])
    elif way == 5:
        r["questions"] = questions * 3
    elif way == 6:
        rng.shuffle(questions)
    else:
        for row in questions:
            row[2] = int(rng.integers(2))


def _questions(r: Record, rng: np.random.Generator) -> None:
    size = len(r["pool"]["states"])
    row = [int(rng.integers(size)), int(rng.integers(size)), int(rng.integers(2))]
    changes = [
        row,
        [row[0], row[0], 1],
        [row[0], size, 1],
        [-1, row[1], 1],
        [True, row[1], 1],
        [0.0, 1, 1],
        [1, 2],
        None,
    ]
    place = int(rng.integers(len(r["questions"]) + 1))
    r["questions"][place : place + 1] = [changes[rng.integers(len(changes))]]


def _trajectories(name: str) -> Any:
    def change(r: Record, rng: np.random.Generator) -> None:
        states, actions = r[name]["states"], r[name]["actions"]
        i, h = int(rng.integers(len(states))), int(rng.integers(len(states[0])))
        way = rng.integers(6)
        if way == 0:
            states[i][h] = int(rng.integers(-1, 7))
        elif way == 1:
            actions[i][h] = int(rng.integers(-1, 6))
        elif way == 2:
            del states[i], actions[i]
            r["configuration"]["n_demonstrations" if name == "demonstrations" else "pool"] -= int(rng.integers(2))
        elif way == 3:
            states[i], actions[i] = states[i - 1], actions[i - 1]
        elif way == 4:
            states[i] = states[i][:-1]
        else:
            state = states[i][h]
            for path, taken in zip(states, actions, strict=True):
                taken[:] = [(a + 1) % 4 if s == state else a for s, a in zip(path, taken, strict=True)]

    return change


def _weight_bound(r: Record, rng: np.random.Generator) -> None:
    factor = float(rng.choice([0.5, 0.8, 0.99, 1.3, 2.0]))
    r["weight_bound"] *= factor
    if rng.random() < 0.7:
        r["prior_precisions"] = [k / factor**2 for k in r["prior_precisions"]]
    if rng.random() < 0.5:
        r["teacher"]["weights"] = [w * factor for w in r["teacher"]["weights"]]
    if rng.random() < 0.3:
        r["teacher"] = None


def _header(r: Record, rng: np.random.Generator) -> None:
    name = str(
        rng.choice(["prior_precisions", "delta", "until", "goal_nats", "rho", "utility_range", "reference", "complete"])
    )
    value = r[name]
    if name == "until":
        value = str(rng.choice(["20%", "90%", "1nats", "share=50%", "100nats", "never"]))
        r["configuration"]["until"] = value
        if rng.random() < 0.5:
            r["goal_nats"] = {"20%": 1.0, "90%": 4.5, "1nats": 1.0, "share=50%": 0.0, "100nats": 100.0}.get(value, 9.0)
            r["rho"] = 1.0 if value == "share=50%" else 0.0
    elif isinstance(value, list):
        value[int(rng.integers(len(value)))] *= float(rng.choice([0.25, 0.9999, 1.5, -1.0]))
    elif isinstance(value, bool):
        value, r["candidates"] = not value, [r["recommended"]]
        r["configuration"]["limit"] = int(rng.choice([1, 2**21]))
        r["claims"]["candidates"] = r["outcome"]["candidates"] = 1
    elif value is None:
        value = [[0.0] * 20, [0.1] * 3, "random", 0][rng.integers(4)]
    else:
        value = type(value)(value * float(rng.choice([0.1, 0.5, 2.0, 10.0, -1.0])) + float(rng.choice([0.0, 0.3])))
        if rng.random() < 0.5:
            r["configuration"][name] = value
    r[name] = value


def _recommended(r: Record, rng: np.random.Generator) -> None:
    policy = r["recommended"]
    policy[int(rng.integers(len(policy)))] = int(rng.integers(-1, 5))


def _claims(r: Record, rng: np.random.Generator) -> None:
    name = str(rng.choice(["gap", "certified", "contradicted", "answers", "candidates"]))
    value = r["claims"][name]
    r["claims"][name] = not value if isinstance(value, bool) else type(value)(value * 0.5 + (name != "gap"))
    if rng.random() < 0.5 and name == "candidates":
        r["outcome"]["candidates"] = r["claims"]["candidates"]


def _environment(r: Record, rng: np.random.Generator) -> None:
    names = ["starmdp-text", "gridworld", "frozenlake", "nowhere", "missing.npz", 3]
    r["configuration"]["environment"] = names[rng.integers(len(names))]
    if rng.random() < 0.3:
        r["configuration"]["environment"] = "starmdp"
        r["configuration"]["embedding"] = str(rng.choice(["state_counts", "identity_short", "final_state", "x"]))


def _missing(r: Record, rng: np.random.Generator) -> None:
    names = sorted(set(r) - {"questions", "claims", "outcome", "goal_nats"})
    r[names[rng.integers(len(names))]] = [None, "x", -1, [], {}, float("nan")][rng.integers(6)]


KINDS: dict[str, Any] = {
    "answers": _answers,
    "questions": _questions,
    "pool": _trajectories("pool"),
    "demonstrations": _trajectories("demonstrations"),
    "weight bound": _weight_bound,
    "header": _header,
    "recommended": _recommended,
    "claims": _claims,
    "environment": _environment,
    "missing": _missing,
}


def implied(r: Record) -> bool:
    """Whether the claim of a record of StarMDP follows from its content: plain, slow, independent."""
    mdp = make_mdp("starmdp")
    c, n_states, n_actions = r["configuration"], mdp.n_states, mdp.n_actions
    d = n_states * n_actions
    sound = c["environment"] == "starmdp" and c["embedding"] == "state_action_counts"
    sound &= r["delta"] == c["delta"] and 0 < r["delta"] < 1
    sound &= bool(np.allclose(r["prior_precisions"], [k * d / r["weight_bound"] ** 2 for k in (1, 4, 16)], rtol=1e-8))
    if r["teacher"] is not None:
        w = np.array(r["teacher"]["weights"])
        sound &= bool(np.isclose(2 * np.linalg.norm(w), r["weight_bound"], rtol=1e-8))
        sound &= bool(np.isclose(_range(mdp, w.reshape(n_states, n_actions)), r["utility_range"], rtol=1e-6))
    demos = r["demonstrations"]
    paths = [] if demos is None else zip(demos["states"], demos["actions"], strict=True)
    pairs = [pair for states, actions in paths for pair in zip(states, actions, strict=True)]
    taken = dict(pairs)
    for part in (r["pool"], *([] if demos is None else [demos])):
        sound &= all(_possible(mdp, s, a) for s, a in zip(part["states"], part["actions"], strict=True))
    sound &= all(taken[s] == a for s, a in pairs)
    choices = [[taken[s]] if s in taken else range(n_actions) for s in range(n_states)]
    policies = np.array(list(itertools.product(*choices)) if r["complete"] else r["candidates"])
    sound &= r["recommended"] in policies.tolist()
    return bool(sound) and _oracle_gap(r, mdp, policies) <= max(r["claims"]["gap"] * (1 + 1e-5), 1e-6)


def _possible(mdp: TabularMDP, states: list[int], actions: list[int]) -> bool:
    steps = zip(states, actions, states[1:], strict=False)
    return mdp.initial[states[0]] > 0 and all(mdp.transitions[s, a, t] > 0 for s, a, t in steps)


def _range(mdp: TabularMDP, reward: np.ndarray) -> float:
    best = worst = np.zeros(mdp.n_states)
    for _ in range(mdp.horizon):
        best, worst = (reward + mdp.transitions @ best).max(1), (reward + mdp.transitions @ worst).min(1)
    return float(mdp.initial @ (best - worst))


def features(mdp: TabularMDP, policy: np.ndarray) -> np.ndarray:
    """(S A,) expected visits, one policy at a time."""
    visits, here = np.zeros((mdp.n_states, mdp.n_actions)), mdp.initial
    for _ in range(mdp.horizon):
        visits[np.arange(mdp.n_states), policy] += here
        here = here @ mdp.transitions[np.arange(mdp.n_states), policy]
    return visits.ravel()


def _log(r: Record, mdp: TabularMDP) -> np.ndarray:
    """(T, d) differences, turned so that every answer says 1."""
    items = []
    for states, actions in zip(r["pool"]["states"], r["pool"]["actions"], strict=True):
        counts = np.zeros((mdp.n_states, mdp.n_actions))
        np.add.at(counts, (states, actions), 1)
        items.append(counts.ravel())
    rows = [(items[i] - items[j]) * (1 if o else -1) for i, j, o in r["questions"] if o is not None]
    return np.array(rows).reshape(-1, mdp.n_states * mdp.n_actions)


def oracle_level(x: np.ndarray, precisions: list[float], delta: float) -> float:
    """Q - log(1/delta) in plain floats, by a rule of 120 nodes."""
    d, parts = x.shape[1], []
    for k in precisions:
        mean, root = fitted_normal(x, np.ones(len(x), dtype=int), np.zeros(len(x), dtype=int), k)
        covariance = root @ root.T
        z = (x @ mean)[:, None] + np.sqrt(np.einsum("td,de,te->t", x, covariance, x))[:, None] * NODES
        kl = 0.5 * (k * np.trace(covariance) + k * mean @ mean - d - d * np.log(k) - np.linalg.slogdet(covariance)[1])
        parts.append(float((-np.logaddexp(0, -z) @ MASSES).sum() - kl))
    return float(np.logaddexp.reduce(parts) - np.log(len(parts)) + np.log(delta))


def _oracle_gap(r: Record, mdp: TabularMDP, policies: np.ndarray) -> float:
    x, rho = _log(r, mdp), r["rho"]
    own = features(mdp, np.array(r["recommended"]))
    anchor = (1 + rho) * own - rho * np.array(r["reference"])
    total = len(x)
    some = {*range(max(0, total - 12), total), *range(0, total, max(1, total // 12))}
    stages = [[total], *(sorted({total, *ends} - {0}) for ends in (some, range(2, total, 2)))]

    @cache
    def level(until: int) -> float:
        return oracle_level(x[:until], r["prior_precisions"], r["delta"])

    worst = 0.0
    for policy in policies:
        mine = features(mdp, policy)
        changed = [
            np.where(np.arange(mdp.n_states) == s, a, policy) for s in range(mdp.n_states) for a in range(mdp.n_actions)
        ]
        rivals = np.array([features(mdp, p) for p in (*policies, *(changed if r["complete"] else []))])
        if np.allclose(mine, anchor) or (r["complete"] and np.allclose(mine, own)):
            continue  # of the best policy itself nothing need be shown: no reference is above it
        for ends in stages:  # a certificate may rest on any earlier set; the more are used, the slower this is
            bound = _largest(mine - anchor, mine - rivals, x, ends, [level(t) for t in ends], r["weight_bound"])
            if bound <= max(r["claims"]["gap"], 1e-7):
                break
        worst = max(worst, bound)
    return worst


def _largest(
    v: np.ndarray, rows: np.ndarray, x: np.ndarray, ends: list[int], levels: list[float], weight_bound: float
) -> float:
    w = cp.Variable(len(v))
    cone = rows[np.linalg.norm(rows, axis=1) > 1e-9]
    known = [cp.norm(w) <= weight_bound] + ([cone @ w >= 0] if len(cone) else [])
    for until, least in zip(ends, levels, strict=True):
        known += [-cp.sum(cp.logistic(-(x[:until] @ w))) >= least] if until else []
    problem = cp.Problem(cp.Maximize(v @ w), known)
    for solver, settings in ((cp.CLARABEL, {}), (cp.SCS, {"eps": 1e-7, "max_iters": 20_000})):
        with warnings.catch_warnings(), contextlib.suppress(cp.SolverError):
            warnings.simplefilter("ignore")  # an inaccurate end is read from the status
            problem.solve(solver=solver, **settings)
        if problem.status in ("optimal", "infeasible"):
            break
    if problem.status in ("infeasible", "infeasible_inaccurate"):
        return -np.inf
    return float(problem.value)
