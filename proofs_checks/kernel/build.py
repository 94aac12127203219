"""Compiling the sources, and asking Coq what each theorem rests on."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterable
from pathlib import Path

REALS = {
    "ClassicalDedekindReals.sig_forall_dec",
    "ClassicalDedekindReals.sig_not_dec",
    "FunctionalExtensionality.functional_extensionality_dep",
    "Classical_Prop.classic",
}
"""The axioms of the real numbers in Coq's standard library (``exp`` and ``ln`` need the last)."""

_INTEGERS = re.compile(r"(Uint63Axioms\.\w+|Uint63\.\w+|PrimInt63\.\w+)")
"""Coq's machine integers and their laws: what numerical enclosures of the tactic ``interval`` rest on besides."""
_SECONDS = 900
_CLOSED = "Closed under the global context"


def compile_sources(folder: Path, sources: dict[str, str], *, jobs: int) -> str:
    """Compile sources into an empty folder, ``jobs`` at a time; what Coq says against them, empty if all is well."""
    for name, text in sources.items():
        (folder / f"{name}.v").write_text(text, encoding="utf-8")
    files = [f"{name}.v" for name in sources]
    made = run(folder, "coq_makefile", "-Q", ".", "Bridge", "-o", "Makefile", *files)
    if not made.returncode:
        made = run(folder, "make", "--no-print-directory", f"-j{jobs}")
    return "" if made.returncode == 0 else f"{made.stdout}\n{made.stderr}".strip()


def run(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    """Run a command in a folder, without the user's own libraries and settings of Coq."""
    plain = {name: value for name, value in os.environ.items() if not name.startswith(("COQ", "MAKE", "MFLAGS"))}
    return subprocess.run(
        command, cwd=folder, env=plain, capture_output=True, text=True, timeout=_SECONDS, check=False
    )  # fmt: skip


def version() -> str:
    """Coq's version, such as ``8.16.1``."""
    printed = subprocess.run(["coqc", "--print-version"], capture_output=True, text=True, check=True).stdout
    return printed.split()[0]


def questions(folder: Path, files: Iterable[str], lines: Iterable[str]) -> dict[str, str] | str:
    """What Coq answers to commands about compiled files, by the names that ``idtac "== NAME"`` prints before them.

    A text instead is Coq's complaint.
    """
    required = " ".join(dict.fromkeys(files))
    head = [f"From Bridge Require {required}."] if required else []
    (folder / "Questions.v").write_text("\n".join([*head, *lines, ""]), encoding="utf-8")
    answer = run(folder, "coqc", "-q", "-Q", ".", "Bridge", "Questions.v")
    if answer.returncode:
        return answer.stderr.strip()
    parts = re.split(r"^== (\S+)\n", answer.stdout, flags=re.MULTILINE)[1:]
    return dict(zip(parts[::2], parts[1::2], strict=True))


def resting_on(folder: Path, names: Iterable[str]) -> set[str] | None:
    """The axioms that compiled theorems, named ``File.theorem``, rest on together; None where Coq tells none."""
    names = tuple(names)
    together = " ".join(f"let _ := @Bridge.{name} in" for name in names)
    asked = ['Goal True. idtac "== all". Abort.', f"Definition all_of_them : True := {together} I."]
    answer = questions(folder, [name.split(".")[0] for name in names], [*asked, "Print Assumptions all_of_them."])
    return None if isinstance(answer, str) else assumptions(answer["all"])


def assumptions(printed: str) -> set[str] | None:
    """The names that ``Print Assumptions`` lists, none for a closed proof; None where the text is not such a list.

    An entry begins at the left edge with its name; its type follows after a colon and is indented where it is long.

    >>> assumptions("Closed under the global context"), assumptions("Axioms:\\ncheat' : False"), assumptions("")
    (set(), {"cheat'"}, None)
    """
    if printed.strip() == _CLOSED:
        return set()
    head, _, body = printed.strip().partition("\n")
    entries = [line for line in body.splitlines() if line and not line[0].isspace()]
    if head != "Axioms:" or not entries:
        return None
    return {line.split()[0].removesuffix(":") for line in entries}


def foreign(axioms: set[str], *, numerical: bool = False) -> list[str]:
    """The axioms that are not those of the real numbers (nor, for numerical comparisons, of machine integers)."""
    return sorted(
        name for name in axioms - REALS if not (numerical and _INTEGERS.fullmatch(name))
    )  # fmt: skip
