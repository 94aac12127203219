"""Certified answers, checked: from the file of an asking session to a verdict, ``bridge-rl verify``."""

from proofs_checks.asking_checker.checker import check
from proofs_checks.asking_checker.verdict import Verdict

__all__ = ["Verdict", "check"]
