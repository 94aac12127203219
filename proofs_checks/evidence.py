"""Evidence: a check of a statement together with the wrong variants (mutants) that the same check must reject."""

from __future__ import annotations

import inspect
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from proofs_checks.context import Context
from proofs_checks.counterexample import Counterexample, load, replay
from proofs_checks.outcome import Outcome

Kind = Literal[
    "kernel-checked", "proved", "refuted", "step proved", "exact on instances", "agrees on instances", "covered",
    "text", "cited", "open",
]  # fmt: skip

STRENGTH: tuple[Kind, ...] = (
    "kernel-checked", "proved", "refuted", "step proved", "exact on instances", "agrees on instances", "covered",
    "text", "cited", "open",
)  # fmt: skip
"""The kinds of evidence, strongest first; a refutation settles a statement as a proof does."""

MEANING: dict[Kind, str] = {
    "kernel-checked": "a proof checked by the kernel of Coq",
    "proved": "holds on the whole stated domain, by a derivation that a machine ran (SymPy, Z3, ball arithmetic)",
    "refuted": "a small exact counterexample, replayed by an independent evaluator",
    "step proved": "one step of the proof holds on its whole domain, by a machine-run derivation; the rest is text",
    "exact on instances": "holds in exact arithmetic on every enumerated or generated finite instance; not a proof",
    "agrees on instances": "agrees to a stated tolerance, in floating point, on instances; not a proof",
    "covered": "holds in simulation at least as often as claimed, by exact confidence limits; not a proof",
    "text": "argued in words alone; no machine has checked it",
    "cited": "taken from the literature, not checked here",
    "open": "neither proved nor refuted here",
}

_LONG = 60
Check = Callable[..., Outcome]
"""``check(**variant) -> Outcome``: without arguments it checks the statement itself. A parameter called ``context``
receives the run's `Context`."""


@dataclass(frozen=True)
class Mutant:
    """A wrong variant of the statement: keyword arguments under which the check must find a failure."""

    name: str
    variant: Mapping[str, Any]


def mutant(name: str, **variant: Any) -> Mutant:
    """``mutant("constant 2 instead of 3", constant=2)``."""
    if not variant:
        raise TypeError(f"the mutant {name!r} changes nothing; give the keyword argument of the check that it changes")
    return Mutant(name, variant)


@dataclass(frozen=True)
class Evidence:
    """One piece of evidence.

    Attributes:
        kind: what the check is worth, see ``MEANING``.
        words: what exactly was checked, in one sentence (LaTeX between dollars).
        check: the function that checks it; None only for cited and open statements.
        mutants: wrong variants that the check must reject; at least one for every check.
        arguments: keyword arguments of the check for the statement itself.
        full_only: too long for a quick run.
        counterexample: the stored instance of a refutation.
    """

    kind: Kind
    words: str
    check: Check | None = None
    mutants: tuple[Mutant, ...] = ()
    arguments: Mapping[str, Any] = field(default_factory=dict)
    full_only: bool = False
    counterexample: Counterexample | None = None

    def __post_init__(self) -> None:
        if self.check is None and self.kind not in ("cited", "open"):
            raise TypeError(f"evidence of kind {self.kind!r} needs a check: {self.words}")
        if self.check is None:
            return
        if not self.mutants:
            raise TypeError(f"a check that rejects nothing is no evidence; plant a mutant: {self.words}")
        takes = inspect.signature(self.check).parameters
        unknown = {name for planted in self.mutants for name in planted.variant if name not in takes}
        if unknown:
            raise TypeError(f"{self.key} does not take {', '.join(sorted(unknown))}, which its mutants change")

    def run(self, context: Context, variant: Mapping[str, Any] | None = None) -> Outcome:
        """Run the check, for the statement itself or for a mutant's ``variant``."""
        if self.check is None:
            raise TypeError(f"there is nothing to run: {self.words}")
        extra = {"context": context} if "context" in inspect.signature(self.check).parameters else {}
        outcome = self.check(**extra, **{**self.arguments, **(variant or {})})
        if not isinstance(outcome, Outcome):
            raise TypeError(f"{self.key} returned {outcome!r}; a check returns an Outcome")
        return outcome

    @property
    def handle(self) -> str:
        """What a `Link` calls it: its Coq theorem or counterexample, else its check, else its kind."""
        named = self.arguments.get("name")
        if self.check is None:
            return self.kind
        return named if isinstance(named, str) else self.check.__name__

    @property
    def key(self) -> str:
        """A name for the check with its arguments, the same in every process; empty where there is no check."""
        if self.check is None:
            return ""
        function = self.check
        module, name = function.__module__.removeprefix("proofs_checks."), function.__qualname__
        given = ", ".join(f"{key}={value!r}" for key, value in sorted(self.arguments.items()))
        if len(given) > _LONG:  # a name has to fit into a line
            given = f"{given[:_LONG]}... {zlib.crc32(given.encode()):08x}"
        return f"{module}.{name}({given})" if given else f"{module}.{name}"


def kernel_checked(words: str, check: Check, *mutants: Mutant, full_only: bool = False, **arguments: Any) -> Evidence:
    """A proof that Coq's kernel has checked; the check is ``skipped`` where ``coqc`` is missing."""
    return Evidence("kernel-checked", words, check, mutants, arguments, full_only)


def proved(words: str, check: Check, *mutants: Mutant, full_only: bool = False, **arguments: Any) -> Evidence:
    """A machine-run derivation of the whole statement, for all values of its domain. Never samples."""
    return Evidence("proved", words, check, mutants, arguments, full_only)


def proved_step(words: str, check: Check, *mutants: Mutant, full_only: bool = False, **arguments: Any) -> Evidence:
    """A machine-run derivation of one step; the statement itself follows by the text of the proof."""
    return Evidence("step proved", words, check, mutants, arguments, full_only)


def exact(words: str, check: Check, *mutants: Mutant, full_only: bool = False, **arguments: Any) -> Evidence:
    """Holds exactly (rationals, or certified balls) on finite instances that are enumerated or generated.

    The check compares no floating-point numbers; a test reads the comparisons it makes.
    """
    return Evidence("exact on instances", words, check, mutants, arguments, full_only)


def agrees(words: str, check: Check, *mutants: Mutant, full_only: bool = False, **arguments: Any) -> Evidence:
    """Agrees up to rounding on instances: two floating-point numbers are compared, with a tolerance."""
    return Evidence("agrees on instances", words, check, mutants, arguments, full_only)


def covered(words: str, check: Check, *mutants: Mutant, full_only: bool = False, **arguments: Any) -> Evidence:
    """Holds in simulation as often as claimed, judged by exact Clopper-Pearson limits."""
    return Evidence("covered", words, check, mutants, arguments, full_only)


def refuted(name: str) -> Evidence:
    """The stored counterexample ``counterexamples/NAME.json``; its controls are the mutants that must be rejected."""
    instance = load(name)
    mutants = tuple(Mutant(control.name, {"control": control.name}) for control in instance.controls)
    return Evidence("refuted", instance.sentence, replay, mutants, {"name": name}, counterexample=instance)


def cited(source: str) -> Evidence:
    """Taken from the literature: author, year, theorem; say if it was quoted from memory."""
    return Evidence("cited", source)


def unsettled(words: str, check: Check | None = None, *mutants: Mutant, **arguments: Any) -> Evidence:
    """An open question; the check, if any, holds as long as no counterexample is known."""
    return Evidence("open", words, check, mutants, arguments)
