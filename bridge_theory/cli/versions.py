"""The bounds that are set side by side in figures and plans: the paper's text, and what is proved instead."""

from __future__ import annotations

from bridge_theory.bound import Bound
from bridge_theory.offline.confidence_set import offline_radius_repaired, offline_radius_repaired_angle
from bridge_theory.offline.radius import offline_radius
from bridge_theory.regret.known import regret_known_stated
from bridge_theory.regret.known_repaired import regret_known_version_space
from bridge_theory.regret.offline_gain import regret_known_deterministic
from bridge_theory.regret.unknown_repaired import regret_unknown_repaired

RADIUS: tuple[Bound, ...] = (offline_radius, offline_radius_repaired, offline_radius_repaired_angle)
REGRET: tuple[Bound, ...] = (
    regret_known_stated,
    regret_unknown_repaired,
    regret_known_deterministic,
    regret_known_version_space,
)
