"""That floats and generated definitions agree: numerical comparisons by the tactic ``interval``."""

from __future__ import annotations


def generated() -> dict[str, str]:
    """The sources of the comparisons by file name without ``.v``."""
    return {}
