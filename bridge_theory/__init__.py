"""Every bound of the BRIDGE paper (arXiv 2509.26605): symbolic, numeric, certified. Pure mathematics."""

from bridge_theory.offline.radius import alpha_offline, beta_offline, offline_radius
from bridge_theory.preference import kappa, kappa_differences
from bridge_theory.setting import Setting

__all__ = ["Setting", "alpha_offline", "beta_offline", "kappa", "kappa_differences", "offline_radius"]
