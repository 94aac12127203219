"""A log that was changed in any way that matters is not certified, and never crashes the checker.

Each mutation is checked without its digest, as a forger would recompute it. What cannot be noticed in principle is what
another honest run could have written, and is left out for that reason alone:

- the answer to a comparison of two trajectories with equal features: no estimate depends on it;
- dropping the last round together with the configuration's T: a shorter run (the repaired multiplier knows no T);
- a candidate's place in the list, and a pair replaced by policies that take the same actions in every state visited
  and have the same features: the same play under other names;
- both trajectories of a round exchanged together with the pair and the answer: the same likelihood;
- entries of the configuration that no number here depends on (the solver, the discount), and those that only say how
  answers and candidates came about, on which the certificate is conditional (the oracle, the radius, the noise): they
  change its assumptions;
- for hand-set sets, delta and W where the weights stay inside: the reader's choices, not the run's;
- claims changed by less than the tolerance: nothing is computed from them.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridge_algos.run.config import preset
from bridge_algos.run.log import logged_seed
from bridge_algos.run.log_file import RunLog, load_log, log_path, save_log
from bridge_algos.run.world import build_world
from bridge_theory.errors import InputError
from experiments.cli import main
from proofs_checks.verify import verify

ROUNDS = 5
LOGS: dict[str, tuple[str, dict[str, Any]]] = {
    "known": ("bridge-known", {}),
    "unknown": ("bridge", {}),
    "many comparisons": ("bridge-known", {"comparisons": 3, "radius": 0.9, "weight_bound": 0.3}),
    "hand-set": ("bridge", {"confidence": "fixed", "gamma": 0.5, "bonus_multiplier": 0.05}),
    "stated": ("bridge", {"confidence": "stated"}),
    "likelihood": ("bridge-known", {"confidence": "likelihood", "comparisons": 2, "weight_bound": 0.3}),
}
Mutations = Iterator[tuple[str, RunLog]]


@cache
def honest(name: str) -> tuple[str, RunLog]:
    algorithm, changes = LOGS[name]
    config = preset("theory", "starmdp").but(rounds=ROUNDS, algorithms=(algorithm,), **changes)
    log = logged_seed(config, build_world(config), 1)[1]
    (certificate,) = verify(log)
    assert certificate.certified, certificate.words()
    return algorithm, log


def verdict(log: RunLog) -> str:
    """Accepted, rejected or malformed: anything else is a crash."""
    try:
        certificates = verify(log)
    except InputError as error:
        return "malformed" if len(str(error).splitlines()) == 1 else "more than a sentence"
    for item in certificates:
        assert item.certified or (item.reasons and np.isinf(item.bounds["best"]).all())
        item.words()
        json.dumps(item.record(), allow_nan=False)
    return "accepted" if all(item.certified for item in certificates) else "rejected"


def with_array(log: RunLog, name: str, array: Any) -> RunLog:
    return RunLog(log.header, {**log.arrays, name: array})


def edited(log: RunLog, name: str, edit: Callable[[np.ndarray], Any]) -> RunLog:
    array = log.arrays[name].copy()
    edit(array)
    return with_array(log, name, array)


def with_header(log: RunLog, path: tuple[str, ...], value: Any) -> RunLog:
    header = copy.deepcopy(log.header)
    place = header
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return RunLog(header, log.arrays)


def per_round(log: RunLog, algorithm: str) -> list[str]:
    return [name for name, array in log.arrays.items() if name.startswith(algorithm + "/") and name[-8:] != "policies"]


def observations(log: RunLog, algorithm: str) -> Mutations:
    """What was seen: answers, states, actions, the pair, the weights."""
    outcomes, states = log.arrays[f"{algorithm}/outcomes"], log.arrays[f"{algorithm}/states"]
    actions, policies = log.arrays[f"{algorithm}/actions"], log.arrays[f"{algorithm}/policies"]
    for t, k in np.ndindex(outcomes.shape):
        visits = [sorted(zip(states[t, i, k], actions[t, i, k], strict=True)) for i in (0, 1)]
        if visits[0] == visits[1]:
            continue  # equal features: the answer cannot matter
        for label, value in (("flipped", 1 - outcomes[t, k]), ("a tie", 0.5), ("missing", np.nan), ("two", 2.0)):
            edit = lambda a, t=t, k=k, value=value: a.__setitem__((t, k), value)  # noqa: E731
            yield f"answer {t},{k} {label}", edited(log, f"{algorithm}/outcomes", edit)
    rng = np.random.default_rng(0)
    for t in range(ROUNDS):
        for i in (0, 1):
            h = int(rng.integers(states.shape[-1]))
            for name, count in (("states", 5), ("actions", 4)):
                edit = lambda a, w=(t, i, 0, h), n=count: a.__setitem__(w, (a[w] + 1) % n)  # noqa: E731
                yield f"{name} {t},{i},{h}", edited(log, f"{algorithm}/{name}", edit)
            others = np.flatnonzero((policies[:, states[t, i, 0]] != actions[t, i, 0]).any(axis=1))
            if len(others):
                edit = lambda a, w=(t, i), other=others[0]: a.__setitem__(w, other)  # noqa: E731
                yield f"policy {i} of pair {t}", edited(log, f"{algorithm}/pairs", edit)
    for t in range(ROUNDS + 1):
        for size in (1e-3, 10.0):
            edit = lambda a, t=t, size=size: a.__setitem__((t, t % a.shape[1]), a[t, t % a.shape[1]] + size)  # noqa: E731
            yield f"weight {t} by {size}", edited(log, f"{algorithm}/w", edit)


def claims(log: RunLog, algorithm: str) -> Mutations:
    """What the run says about itself."""
    for name in ("gamma", "log_det", "uncertainty", "bonus", "solver_error"):
        for t in range(ROUNDS):
            for factor, shift in ((1.001, 0.001), (0.5, -0.001)):
                edit = lambda a, t=t, f=factor, s=shift: a.__setitem__(t, a[t] * f + s)  # noqa: E731
                yield f"{name} {t} * {factor}", edited(log, f"{algorithm}/{name}", edit)
    for t in range(ROUNDS):
        for change in (1, -1):
            edit = lambda a, t=t, c=change: a.__setitem__(t, a[t] + c)  # noqa: E731
            yield f"set size {t} {change:+}", edited(log, f"{algorithm}/set_size", edit)


def rounds(log: RunLog, algorithm: str) -> Mutations:
    """Rounds dropped, repeated, exchanged."""

    def taken(order: list[int]) -> RunLog:
        arrays = dict(log.arrays)
        for name in per_round(log, algorithm):
            extra = [order[-1] + 1] if len(arrays[name]) == ROUNDS + 1 else []
            arrays[name] = arrays[name][order + extra]
        return RunLog(log.header, arrays)

    every = list(range(ROUNDS))
    for t in every:
        dropped = taken(every[:t] + every[t + 1 :])
        yield f"round {t} dropped", dropped
        if t < ROUNDS - 1:
            yield f"round {t} dropped, T too", with_header(dropped, ("configuration", "rounds"), ROUNDS - 1)
            swapped = every.copy()
            swapped[t : t + 2] = [t + 1, t]
            yield f"rounds {t} and {t + 1} exchanged", taken(swapped)
            yield f"round {t} twice", taken([*every[: t + 1], *every[t:-1]])


def model(log: RunLog, algorithm: str) -> Mutations:
    """Numbers of the model, environment, demonstrations, candidates."""
    config = log.header["configuration"]
    changes: dict[str, list[Any]] = {
        "lam": [0.5, 2.0, 1.01],
        "slope": [2.0, 0.5],
        "rounds": [ROUNDS - 1, ROUNDS + 1, "5", None],
        "comparisons": [config["comparisons"] + 1, 0, True],
        "embedding": ["identity_short", "state_counts", "final_state", "unknown", 3],
        "confidence": [
            name for name in ("fixed", "stated", "repaired", "likelihood", "none") if name != config["confidence"]
        ],
        "environment": ["gridworld", "starmdp-text", "nowhere", 5],
        "environment_options": [{"horizon": 9}, {"size": 3}, 5, {"horizon": "8"}],
        "algorithms": [["pbrl"], "none"],
        "transition_model": ["mlp", "other"],
        "rollouts": [100],
        "delta": [0, 1, -0.1, "0.05", None],
        "weight_bound": [0.5, "1", 10**400, float("nan")],
    }
    if config["confidence"] != "fixed":
        changes["delta"] += [0.01, 0.5]
    else:
        changes |= {"gamma": [0.4, -1], "bonus_multiplier": [0.06]}
    for name, values in changes.items():
        for value in values:
            yield f"{name} = {value!r}", with_header(log, ("configuration", name), value)
    for value in (0.5, 0.12, 0, -1, "W", None, float("nan"), 10**400):
        yield f"weight bound {value!r}", with_header(log, ("weight_bound",), value)
    if config["confidence"] != "fixed":
        both = with_header(log, ("configuration", "weight_bound"), 0.2)
        yield "W everywhere", with_header(both, ("weight_bound",), 0.2)
    for value in (7, 9, 0, "8", None, 10**9, 10**30):
        yield f"horizon {value!r}", with_header(log, ("horizon",), value)
    for name in ("horizon", "weight_bound", "configuration", "seed"):
        header = {key: value for key, value in log.header.items() if key != name}
        yield f"no {name}", RunLog(header, log.arrays)

    def move(a: np.ndarray) -> None:
        a[0, 0, :2] += (1e-3, -1e-3) if a[0, 0, 1] > 0.001 else (-1e-3, 1e-3)

    yield "kernel", edited(log, "transitions", move)
    yield "kernel row", edited(log, "transitions", lambda a: a.__setitem__((1, 1), a[2, 2][::-1]))
    yield "initial", edited(log, "initial", lambda a: a.__setitem__(slice(None), 1 / len(a)))
    yield (
        "demonstrated action",
        edited(log, "demonstrations/actions", lambda a: a.__setitem__((0, 0), (a[0, 0] + 1) % 4)),
    )
    policies = f"{algorithm}/policies"
    if config["radius"] == "zero":
        n, s = log.arrays[policies].shape
        for i, j in np.ndindex(min(n, 4), s):
            edit = lambda a, w=(i, j): a.__setitem__(w, (a[w] + 1) % 4)  # noqa: E731
            yield f"policy {i} in state {j}", edited(log, policies, edit)
        yield "a candidate less", with_array(log, policies, log.arrays[policies][:-1])
        yield "a candidate twice", with_array(log, policies, log.arrays[policies][[*range(n), 0]])


def malformed(log: RunLog, algorithm: str) -> Mutations:
    """Wrong types, shapes, ranges, missing entries."""
    for name, array in log.arrays.items():
        yield f"{name} missing", RunLog(log.header, {k: v for k, v in log.arrays.items() if k != name})
        wrong = [array.astype(np.float32), array.astype(str), array.astype(complex), array[..., None], array[:0]]
        wrong += [array[:, :-1] if array.ndim > 1 else array[:-1], np.array(0.0), array.astype(np.int32)]
        for i, other in enumerate(wrong):
            yield f"{name} as {i}: {other.dtype} {other.shape}", with_array(log, name, other)
        bad = (np.nan, np.inf, -np.inf, 1e200) if array.dtype.kind == "f" else (-1, 10**6, 2**62)
        for value in bad:
            if name.endswith("outcomes") and np.isnan(value):
                continue  # a missing answer, tried above
            yield f"{name} with {value}", edited(log, name, lambda a, v=value: a.__setitem__((0,) * a.ndim, v))
    for names in ([], [algorithm, "other"], [algorithm, algorithm], ["pbrl"]):
        yield f"algorithms {names}", with_header(log, ("algorithms",), names)
        yield (
            f"algorithms {names} everywhere",
            with_header(with_header(log, ("algorithms",), names), ("configuration", "algorithms"), names),
        )


KINDS = (observations, claims, rounds, model, malformed)


@pytest.mark.parametrize("name", LOGS)
def test_every_mutation_is_rejected(name: str) -> None:
    algorithm, log = honest(name)
    tried = {label: verdict(changed) for kind in KINDS for label, changed in kind(log, algorithm)}
    assert [label for label, found in tried.items() if found not in ("rejected", "malformed")] == []
    assert len(tried) > 200
    assert sum(found == "rejected" for found in tried.values()) > 100


def test_the_order_of_an_optimistic_pair_is_checked() -> None:
    """Only ``ucb`` tells the first policy of a pair from the second, by their scores."""
    changes = {"pair_rule": "ucb", "confidence": "fixed", "gamma": 0.3}
    config = preset("theory", "starmdp").but(rounds=ROUNDS, algorithms=("bridge-known",), **changes)
    log = logged_seed(config, build_world(config), 1)[1]
    assert verdict(log) == "accepted"
    arrays = dict(log.arrays)
    for name in ("pairs", "states", "actions", "bonus"):
        arrays[f"bridge-known/{name}"] = log.arrays[f"bridge-known/{name}"].copy()
        arrays[f"bridge-known/{name}"][-1] = log.arrays[f"bridge-known/{name}"][-1][::-1]
    arrays["bridge-known/outcomes"] = log.arrays["bridge-known/outcomes"].copy()
    arrays["bridge-known/outcomes"][-1] = 1 - log.arrays["bridge-known/outcomes"][-1]
    assert verdict(RunLog(log.header, arrays)) == "rejected"


@pytest.mark.parametrize(
    ("limit", "sentence"),
    [
        ("MOST_PRODUCTS", "5 rounds with 20 features"),
        ("MOST_PAIRS", "policies in 5 rounds"),
        ("MOST_RESIDUALS", "5 rounds of 1 comparisons"),
    ],
)
def test_what_would_take_hours_is_refused(limit: str, sentence: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"proofs_checks.verify.facts.{limit}", 3)
    with pytest.raises(InputError, match=sentence):
        verify(honest("known")[1])


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("cliff", {"n_rows": 3, "n_columns": 3}),
        ("garnet", {"n_states": 6, "n_actions": -1}),
        ("chain", {"n_states": 10**9}),
        ("garnet", {"n_actions": 5}),
    ],
)
def test_a_larger_environment_is_not_made(name: str, options: dict[str, int], monkeypatch: pytest.MonkeyPatch) -> None:
    """Its size is the forger's choice: more memory than there is."""
    log = with_header(honest("known")[1], ("configuration", "environment"), name)
    monkeypatch.setattr("proofs_checks.verify.consistency.make_mdp", lambda *_, **__: pytest.fail("made"))
    (item,) = verify(with_header(log, ("configuration", "environment_options"), options))
    assert any("smaller than those of the environment" in reason for reason in item.reasons)


def test_the_reason_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    algorithm, log = honest("known")
    forged = edited(log, f"{algorithm}/w", lambda a: a.__setitem__(2, a[2] / 2))
    save_log(log_path(tmp_path, forged.header["seed"]), forged)
    assert main(["verify", str(tmp_path)]) == 1
    shown = capsys.readouterr().out
    assert "NOT CERTIFIED" in shown
    assert "round 3: the solver error claimed is" in shown
    assert "recomputed at least" in shown


def test_a_copy_does_not_count_as_another_seed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = honest("known")[1]
    copy = log_path(tmp_path, log.header["seed"] + 1)
    save_log(copy, log)
    assert main(["verify", str(tmp_path)]) == 2
    assert f"is the log of seed {log.header['seed']}" in capsys.readouterr().err
    assert main(["verify", str(copy)]) == 0


def test_a_damaged_file_is_one_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = log_path(tmp_path, honest("known")[1].header["seed"])
    save_log(path, honest("known")[1])
    whole = path.read_bytes()
    rng = np.random.default_rng(1)
    damaged = [whole[:n] for n in rng.integers(len(whole), size=20)] + [b"", b"PK", b"\x00" * 500]
    for _ in range(60):
        content = bytearray(whole)
        for place in rng.integers(len(whole), size=3):
            content[place] ^= int(rng.integers(1, 256))
        damaged.append(bytes(content))
    for content in damaged:
        path.write_bytes(content)
        status = main(["verify", str(tmp_path)])
        error = capsys.readouterr().err
        # a flipped bit in what zip does not read (times, attributes) leaves the content whole
        assert status == 2 or (status == 0 and load_log(path).header == honest("known")[1].header)
        assert status == 0 or len(error.strip().splitlines()) == 1
    path.unlink()
    assert main(["verify", str(path)]) == 2
    assert main(["verify", str(tmp_path)]) == 2
