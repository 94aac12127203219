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
_UNFINISHED = r"\b(Admitted|admit|Axioms?|Parameters?|Conjectures?|bypass_check|Unset\s+\w+\s+Checking)\b"
_CLOSED = "Closed under the global context"


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
    return compiled(file, name, source.replace(old, new))


def compiled(file: str, name: str, source: str) -> Outcome:
    """Compile a source beside the library of finite sums, and judge what its theorem ``name`` rests on."""
    if unfinished(source):
        return Outcome(1, (f"{file}.v leaves something unproved: {unfinished(source)}",))
    with tempfile.TemporaryDirectory() as folder:
        for part in (f"{_LIBRARY}.v", f"{_LIBRARY}.vo"):
            shutil.copy(Path(_compiled_library()) / part, folder)
        answer = _compile(Path(folder), file, f"{source}\nPrint Assumptions {name}.\n")
    if answer.returncode:
        return Outcome(1, (f"{name}: the kernel refuses: {' '.join(answer.stderr.split())[:200]}",))
    return judged(name, answer.stdout)


def unfinished(source: str) -> str:
    """The first word of a source outside of comments that leaves something unproved; empty if there is none.

    >>> unfinished("Lemma easy : True. Proof. exact I. Qed. (* no Axiom *)"), unfinished("Axiom easy : False.")
    ('', 'Axiom')
    """
    code, nested = source, 1
    while nested:  # comments may contain comments: the innermost go first
        code, nested = re.subn(r"\(\*(?:(?!\(\*|\*\)).)*\*\)", " ", code, flags=re.DOTALL)
    found = re.search(_UNFINISHED, code)
    return found.group() if found else ""


def judged(name: str, printed: str) -> Outcome:
    """Whether what Coq prints about the assumptions of a theorem names nothing but ``ALLOWED``.

    >>> judged("easy", "Closed under the global context").holds, judged("easy", "Axioms:\\ncheat' : False").holds
    (True, False)
    """
    axioms = assumptions(printed)
    if axioms is None:
        return Outcome(1, (f"{name}: the list of its assumptions is unreadable: {printed.strip()[:200]!r}",))
    if not axioms <= ALLOWED:
        return Outcome(1, (f"{name} rests on {', '.join(sorted(axioms - ALLOWED))}",))
    return Outcome(1, details=f"{name}: accepted by the kernel, {len(axioms)} axioms of the reals")


def assumptions(printed: str) -> set[str] | None:
    """The names that ``Print Assumptions`` lists, none for a closed proof; None where the text is not such a list.

    An entry begins at the left edge with its name; its type follows after a colon and is indented where it is long.
    """
    if printed.strip() == _CLOSED:
        return set()
    head, _, body = printed.strip().partition("\n")
    entries = [line for line in body.splitlines() if line and not line[0].isspace()]
    if head != "Axioms:" or not entries:
        return None
    return {line.split()[0].removesuffix(":") for line in entries}


def _source(file: str) -> str:
    return resources.files("proofs_checks.coq").joinpath(f"{file}.v").read_text(encoding="utf-8")


@cache
def _compiled_library() -> str:
    folder = tempfile.mkdtemp(prefix="bridge-coq-")
    source = _source(_LIBRARY)
    answer = _compile(Path(folder), _LIBRARY, source)
    if answer.returncode or unfinished(source):
        raise RuntimeError(f"{_LIBRARY}.v: {unfinished(source) or answer.stderr}")
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
