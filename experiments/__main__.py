"""``python -m experiments``: the command ``bridge-rl``, where scripts are not on the path."""

import sys

from experiments.cli import main

sys.exit(main())
