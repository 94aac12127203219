"""Compiling the proofs of ``proofs_checks/coq`` and reading what they rest on."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from functools import cache
from importlib import resources
from pathlib import Path

from bridge_theory.errors import InputError
from proofs_checks.outcome import Outcome, skipped

ALLOWED = {
    "ClassicalDedekindReals.sig_forall_dec",
    "ClassicalDedekindReals.sig_not_dec",
    "FunctionalExtensionality.functional_extensionality_dep",
}
"""The axioms of the real numbers in Coq's standard library; a proof may rest on these and no others."""

_SECONDS = 120
_LIBRARY = "finite_sums"


def theorem(*, file: str, name: str, replace: tuple[str, str] = ("", "")) -> Outcome:
    """Whether Coq's kernel accepts theorem ``name`` of ``file``.v, resting on the axioms of the reals alone.

    ``replace`` changes the source before it is compiled: that is how a mutant of the statement is made.
    """
    if shutil.which("coqc") is None:
        return skipped("coqc is not installed (Debian: apt install coq)")
    old, new = replace
    source = _source(file)
    if old not in source:
        raise InputError(f"{file}.v does not contain {old!r}, so that this variant of it is none.")
    if re.search(r"\b(Admitted|Axiom|Parameter|admit)\b", source):
        return Outcome(1, (f"{file}.v leaves something unproved",))
    with tempfile.TemporaryDirectory() as folder:
        for part in (f"{_LIBRARY}.v", f"{_LIBRARY}.vo"):
            shutil.copy(Path(_compiled_library()) / part, folder)
        answer = _compile(Path(folder), file, source.replace(old, new) + f"\nPrint Assumptions {name}.\n")
    if answer.returncode:
        return Outcome(1, (f"{name}: the kernel refuses: {' '.join(answer.stderr.split())[:200]}",))
    axioms = set(re.findall(r"^([\w.]+)\s*:", answer.stdout, flags=re.MULTILINE)) - {"Axioms"}
    if not axioms <= ALLOWED or not (axioms or "Closed" in answer.stdout):
        return Outcome(1, (f"{name} rests on {', '.join(sorted(axioms - ALLOWED)) or 'an unreadable list'}",))
    return Outcome(1, details=f"{name}: accepted by the kernel, {len(axioms)} axioms of the reals")


def _source(file: str) -> str:
    return resources.files("proofs_checks.coq").joinpath(f"{file}.v").read_text(encoding="utf-8")


@cache
def _compiled_library() -> str:
    folder = tempfile.mkdtemp(prefix="bridge-coq-")
    answer = _compile(Path(folder), _LIBRARY, _source(_LIBRARY))
    if answer.returncode:
        raise RuntimeError(f"coqc refuses {_LIBRARY}.v: {answer.stderr}")
    return folder


def _compile(folder: Path, file: str, source: str) -> subprocess.CompletedProcess[str]:
    (folder / f"{file}.v").write_text(source, encoding="utf-8")
    return subprocess.run(
        ["coqc", "-q", "-Q", ".", "Bridge", f"{file}.v"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=_SECONDS,
        check=False,
    )
