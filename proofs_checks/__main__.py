"""``python -m proofs_checks``: the command ``bridge-rl check``."""

import sys

from bridge_theory.cli.status import exit_status
from proofs_checks.cli import main

sys.exit(exit_status("python -m proofs_checks", main, sys.argv[1:]))
