"""Every bound of the BRIDGE paper (arXiv 2509.26605): symbolic, numeric, certified. Pure mathematics."""

from bridge_theory.offline.radius import alpha_offline, beta_offline, offline_radius
from bridge_theory.online.confidence import (
    beta_repaired,
    beta_repaired_logdet,
    beta_t,
    confidence_radius,
    confidence_radius_repaired,
)
from bridge_theory.online.norm_relation import alpha_dT, gamma_known, matrix_shift, norm_relation, norm_relation_sharp
from bridge_theory.preference import kappa, kappa_differences
from bridge_theory.setting import Setting

__all__ = [
    "Setting",
    "alpha_dT",
    "alpha_offline",
    "beta_offline",
    "beta_repaired",
    "beta_repaired_logdet",
    "beta_t",
    "confidence_radius",
    "confidence_radius_repaired",
    "gamma_known",
    "kappa",
    "kappa_differences",
    "matrix_shift",
    "norm_relation",
    "norm_relation_sharp",
    "offline_radius",
]
