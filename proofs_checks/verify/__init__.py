"""Certified runs: an independent checker of logs, ``bridge-rl verify``."""

from proofs_checks.verify.certificate import Certificate
from proofs_checks.verify.checker import verify

__all__ = ["Certificate", "verify"]
