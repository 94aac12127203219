"""``make proofs``: compile the whole development and let a theorem count only if nothing is left unproved.

``python -m proofs_checks.kernel.gate`` compares what it finds with ``recorded.json``; ``--record`` writes that file.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Iterable, Sequence
from pathlib import Path

from bridge_algos.files import atomic_write_text
from proofs_checks.kernel import agreement, refutations
from proofs_checks.kernel.build import compile_sources, foreign, questions, resting_on, run, version
from proofs_checks.kernel.manifest import Development, Mutant, Theorem, shipped
from proofs_checks.kernel.recorded import FILE, Record, expected_digest
from proofs_checks.kernel.sentences import faults

_INSTALL = "install them with: apt install coq libcoq-interval"
_RESERVED = re.compile(r"(Uint63\w*|PrimInt63|Classical\w*|FunctionalExtensionality|Questions|Probe|Mutant\d+)")


def main(argv: list[str]) -> int:
    """Check everything. Returns 0 if all holds and agrees with the record, else 1, with one line for each problem."""
    options = argparse.ArgumentParser(prog="make proofs", description=__doc__)
    options.add_argument("--jobs", type=int, default=2, help="files compiled at a time (default 2)")
    options.add_argument("--record", action="store_true", help="write what was found to recorded.json")
    chosen = options.parse_args(argv)
    if shutil.which("coqc") is None:
        print(f"coqc is not installed; {_INSTALL}", file=sys.stderr)
        return 1
    start = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="bridge-coq-") as folder:
        numerical = _has_interval(Path(folder))
        record, problems = inspect(Path(folder), shipped(), jobs=chosen.jobs, numerical=numerical)
    if not numerical and os.environ.get("CI"):
        problems.append("libcoq-interval must be installed where CI is set, got none")
    if not numerical:
        print(f"the tactic interval is not installed, so that numerical files were left out; {_INSTALL}")
    if chosen.record and not problems and numerical:
        atomic_write_text(FILE, record.text())
    elif not problems:
        problems = record.differences(Record.stored(), numerical=numerical)
    for problem in problems:
        print(f"PROBLEM {problem}")
    counts = f"{len(record.theorems)} theorems, {len(record.refutations)} refutations, {record.mutants} mutants refuted"
    print(f"Coq {record.coq}: {counts}; {len(problems)} problems; {time.perf_counter() - start:.0f} s")
    return int(bool(problems))


def inspect(folder: Path, what: Development, *, jobs: int, numerical: bool) -> tuple[Record, list[str]]:
    """Compile and question a development in an empty folder: what counts, and what is wrong, a line each."""
    refuting = refutations.generated(numerical=numerical)
    texts = {**what.sources, **refuting, **(agreement.generated() if numerical else {})}
    record = Record(version(), expected_digest(), [], [], 0)
    problems = [f"{name}.v: {fault}" for name, text in texts.items() for fault in faults(text)]
    problems += [f"{name}.v has a name of the standard library" for name in texts if _RESERVED.fullmatch(name)]
    if problems:
        return record, problems
    if refused := compile_sources(folder, texts, jobs=jobs):
        return record, [f"the kernel refuses: {_gist(refused)}"]
    problems += _unmet(folder, what)
    if not problems:
        problems += _resting(folder, what, refuting, record)
        problems += _survivors(folder, what, record)
    return record, problems


def _resting(folder: Path, what: Development, refuting: Iterable[str], record: Record) -> list[str]:
    """Record what rests on allowed axioms alone; the rest are the problems."""
    names = [f"{one.file}.{name}" for one in what.theorems.values() for name in (one.name, one.nonvacuity)]
    if not (problems := _wrong(folder, names, numerical=False)):
        record.theorems += sorted(what.theorems)
    numbers = [f"{file}.refuted" for file in refuting]
    if not (more := _wrong(folder, numbers, numerical=True)):
        record.refutations += sorted(refutations.example_of(file) for file in refuting)
    return problems + more


def _wrong(folder: Path, names: Sequence[str], *, numerical: bool) -> list[str]:
    """The theorems that rest on something else; one question about all of them where there is none."""
    axioms = resting_on(folder, names)
    if axioms is not None and not foreign(axioms, numerical=numerical):
        return []
    if len(names) > 1:
        return [problem for name in names for problem in _wrong(folder, [name], numerical=numerical)]
    if axioms is None:
        return [f"{names[0]}: the list of its assumptions is unreadable"]
    return [f"{names[0]} rests on {', '.join(foreign(axioms, numerical=numerical))}"]


def _unmet(folder: Path, what: Development) -> list[str]:
    """What is wrong with the instances: one is missing, has premises of its own, or does not use its theorem."""
    lines, problems = [], []
    instances = {one.name: f"Bridge.{one.file}.{one.nonvacuity}" for one in what.theorems.values()}
    for name, instance in instances.items():
        lines += [
            f'Goal True. idtac "== {name}". match type of {instance} with forall _, _ => idtac "premises" | _ => '
            "idtac end. Abort.",
            f"Print {instance}.",
        ]
    answer = questions(folder, [one.file for one in what.theorems.values()], lines)
    if isinstance(answer, str):
        return [f"an exported theorem or its instance is missing: {_gist(answer)}"]
    for one in what.theorems.values():
        told = answer[one.name]
        if told.startswith("premises"):
            problems.append(f"{one.nonvacuity} has premises; state it for concrete data")
        if one.name not in _names(told) and one.name not in _used(folder, one, instances[one.name]):
            problems.append(f"{one.nonvacuity} does not apply {one.name}")
    return problems


def _used(folder: Path, one: Theorem, instance: str) -> set[str]:
    """The proved theorems that an instance uses, lemmas on the way included; Coq takes a while to say so."""
    command = f'Goal True. idtac "== {one.name}". Abort. Print Opaque Dependencies {instance}.'
    answer = questions(folder, [one.file], [command])
    return set() if isinstance(answer, str) else _names(answer[one.name])


def _names(text: str) -> set[str]:
    return {name.split(".")[-1] for name in re.findall(r"[\w.']+", text)}


def _survivors(folder: Path, what: Development, record: Record) -> list[str]:
    """Count the wrong variants whose negation Coq accepts; the others are the problems."""
    asked = {one.theorem: f"@{what.theorems[one.theorem].file}.{one.theorem}" for one in what.mutants}
    lines = [f'Goal True. idtac "== {name}". Abort. Check {full}.' for name, full in asked.items()]
    wide = ["Set Printing Width 100000. Set Printing Depth 100000.", *lines]
    answer = questions(folder, what.sources, [_imports(what), *wide])
    if isinstance(answer, str):
        return [f"the statements cannot be printed: {_gist(answer)}"]
    problems = []
    for number, one in enumerate(what.mutants):
        statement = " ".join(answer[one.theorem].partition(" : ")[2].split())
        changed = f"{one.theorem} with {one.new!r} for {one.old!r}"
        if statement.count(one.old) != 1:
            problems.append(f"{changed}: the text must occur once in the statement, as Coq prints it: {statement}")
        elif wrong := faults(one.refutation) or _unrefuted(folder, f"Mutant{number}", what, one, statement):
            problems.append(f"the mutant {changed} is not refuted: {wrong}")
        else:
            record.mutants += 1
    return problems


def _unrefuted(folder: Path, file: str, what: Development, one: Mutant, statement: str) -> str:
    """Why Coq does not accept the negation of the changed statement; empty if it does."""
    text = (
        f"{_imports(what)}\nGoal {statement}.\nexact @{what.theorems[one.theorem].file}.{one.theorem}. Qed.\n"
        f"Theorem refuted : ~ ({statement.replace(one.old, one.new)}).\nProof. intro claim. {one.refutation} Qed.\n"
    )
    (folder / f"{file}.v").write_text(text, encoding="utf-8")
    answer = run(folder, "coqc", "-q", "-Q", ".", "Bridge", f"{file}.v")
    if answer.returncode:
        return _gist(answer.stderr)
    return "; ".join(_wrong(folder, [f"{file}.refuted"], numerical=False))


def _imports(what: Development) -> str:
    return (
        "Require Import Reals List Lra Lia Bool.\n"
        f"From Bridge Require Import {' '.join(what.sources)}.\nImport ListNotations.\nOpen Scope R_scope."
    )


def _has_interval(folder: Path) -> bool:
    (folder / "Probe.v").write_text("From Interval Require Import Tactic.\n", encoding="utf-8")
    found = run(folder, "coqc", "-q", "Probe.v").returncode == 0
    for file in folder.glob("*Probe*"):
        file.unlink()
    return found


def _gist(text: str) -> str:
    return " ".join(text.split())[-400:]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
