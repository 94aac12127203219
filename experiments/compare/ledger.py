"""What the ledger knows about a statement, and about a run that is one of its counterexamples."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache

from bridge_algos.envs.counterexamples import is_counterexample
from bridge_algos.run.config import preset
from experiments.compare.subject import Subject
from proofs_checks.counterexample import evaluator, on_environment, violated

_BY = {"cited": " given a cited theorem", "text": " by an argument in words"}


@dataclass(frozen=True)
class Replay:
    """The ledger's replay of this very run, in exact numbers.

    Args:
        counterexample: name of the stored counterexample.
        label: the statement that it refutes.
        sentence: what breaks, in one sentence.
        regret: R_T, the same whatever is answered.
        violated_from: the first round drawn from which on the stated bound is certainly exceeded; None if it never is.
    """

    counterexample: str
    label: str
    sentence: str
    regret: Fraction
    violated_from: int | None


def exact_replay(subject: Subject) -> Replay | None:
    """The replay, when the run has the settings of a counterexample about regret and the regret that it proves."""
    config = subject.config
    if not is_counterexample(config.environment):
        return None
    if config != preset("counterexample", config.environment).but(rounds=config.rounds):
        return None
    for example in on_environment(config.environment):
        if example.data.get("quantity") != "regret":
            continue
        rounds = [int(t) for t in subject.rounds]
        sides = [evaluator(example.kind)({**example.data, "T": str(t)}) for t in rounds]
        broken = [violated(example.relation, left, right) for left, right in sides]
        left = sides[-1][0]
        low, high = left if isinstance(left, tuple) else (left, left)
        realised = subject.regret[:, -1]
        if low != high or (abs(realised - float(low)) > 1e-9 * float(low)).any():
            return None
        first = next((t for i, t in enumerate(rounds) if all(broken[i:])), None)
        return Replay(example.name, example.label, example.sentence, low, first)
    return None


def refuted_label(source: str) -> str | None:
    """The label under which the ledger holds the statement to be false, "" when it does not.

    None where the ledger's engines, the extra ``checks``, are not installed.
    """
    word = false_word(source)
    return word if word is None else source if word else ""


@cache
def false_word(source: str) -> str | None:
    """How the ledger calls a statement that it holds to be false; "" for any other, also if a part of it is false.

    A refutation by an instance or a machine-run proof is "false" alone; otherwise its weakest link is named. None where
    the ledger's engines, the extra ``checks``, are not installed.

    >>> false_word("thm:main_known"), false_word("local:kappa")
    ('false', '')
    """
    from proofs_checks.ledger import claims, missing_engines

    if missing_engines():
        return None
    from proofs_checks.strength import weakest

    whole = next((claim for claim in claims() if claim.label == source and not claim.part), None)
    return f"false{_BY.get(str(weakest(whole)), '')}" if whole is not None and whole.verdict == "false" else ""


def holds(source: str) -> bool:
    """Whether the ledger holds every claim under a label to be true; no, where its engines are not installed."""
    from proofs_checks.ledger import claims, missing_engines

    if missing_engines():
        return False
    verdicts = [claim.verdict for claim in claims() if claim.label == source]
    return bool(verdicts) and all(verdict.startswith("true") for verdict in verdicts)
