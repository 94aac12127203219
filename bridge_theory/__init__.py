"""Every bound of the BRIDGE paper (arXiv 2509.26605): symbolic, numeric, certified. Pure mathematics."""

from bridge_theory.offline.radius import alpha_offline, beta_offline, offline_radius
from bridge_theory.online.bonus import empirical_bonus, expected_bonus, xi, xi_bar, xi_repaired
from bridge_theory.online.bonus_relation import empirical_from_true_bonus, empirical_from_true_bonus_sharp
from bridge_theory.online.confidence import (
    beta_repaired,
    beta_repaired_logdet,
    beta_t,
    confidence_radius,
    confidence_radius_repaired,
)
from bridge_theory.online.coverage import coverage_failure, covered_bonus, reach_size
from bridge_theory.online.l1_bonus import bonus_radius, estimated_radius_sum, transition_bonus
from bridge_theory.online.multiplier import (
    gamma_unknown,
    gamma_unknown_repaired,
    net_delta,
    net_scale,
    online_bonus_delta,
    step_bonus_delta,
)
from bridge_theory.online.norm_relation import alpha_dT, gamma_known, matrix_shift, norm_relation, norm_relation_sharp
from bridge_theory.preference import kappa, kappa_differences
from bridge_theory.regret.known import (
    feature_difference_sum,
    regret_known_from_sum,
    regret_known_rate,
    regret_known_scale,
    regret_known_stated,
    regret_regime_large_horizon,
    regret_regime_small_horizon,
    regret_regime_transition,
)
from bridge_theory.regret.known_repaired import (
    expected_potential,
    regret_known_apriori,
    regret_known_log,
    regret_known_repaired,
    regret_known_version_space,
)
from bridge_theory.regret.offline_gain import (
    delta_n_known,
    delta_n_known_deterministic,
    delta_n_unknown,
    delta_n_unknown_deterministic,
    delta_n_version_space,
    delta_n_version_space_sharp,
    elliptical_floor,
    exact_recovery_failure,
    regret_known_deterministic,
)
from bridge_theory.regret.potential import (
    elliptical_norm_sum,
    elliptical_potential,
    elliptical_potential_capped,
    potential_factor,
)
from bridge_theory.regret.trivial import regret_diameter, regret_hindsight, regret_offline, regret_trivial, regret_width
from bridge_theory.regret.unknown import gamma_true_bonus, regret_unknown_squared, regret_unknown_stated
from bridge_theory.regret.unknown_repaired import (
    radius_sum,
    radius_sum_covered,
    regret_unknown_covered,
    regret_unknown_repaired,
)
from bridge_theory.setting import Setting

__all__ = [
    "Setting",
    "alpha_dT",
    "alpha_offline",
    "beta_offline",
    "beta_repaired",
    "beta_repaired_logdet",
    "beta_t",
    "bonus_radius",
    "confidence_radius",
    "confidence_radius_repaired",
    "coverage_failure",
    "covered_bonus",
    "delta_n_known",
    "delta_n_known_deterministic",
    "delta_n_unknown",
    "delta_n_unknown_deterministic",
    "delta_n_version_space",
    "delta_n_version_space_sharp",
    "elliptical_floor",
    "elliptical_norm_sum",
    "elliptical_potential",
    "elliptical_potential_capped",
    "empirical_bonus",
    "empirical_from_true_bonus",
    "empirical_from_true_bonus_sharp",
    "estimated_radius_sum",
    "exact_recovery_failure",
    "expected_bonus",
    "expected_potential",
    "feature_difference_sum",
    "gamma_known",
    "gamma_true_bonus",
    "gamma_unknown",
    "gamma_unknown_repaired",
    "kappa",
    "kappa_differences",
    "matrix_shift",
    "net_delta",
    "net_scale",
    "norm_relation",
    "norm_relation_sharp",
    "offline_radius",
    "online_bonus_delta",
    "potential_factor",
    "radius_sum",
    "radius_sum_covered",
    "reach_size",
    "regret_diameter",
    "regret_hindsight",
    "regret_known_apriori",
    "regret_known_deterministic",
    "regret_known_from_sum",
    "regret_known_log",
    "regret_known_rate",
    "regret_known_repaired",
    "regret_known_scale",
    "regret_known_stated",
    "regret_known_version_space",
    "regret_offline",
    "regret_regime_large_horizon",
    "regret_regime_small_horizon",
    "regret_regime_transition",
    "regret_trivial",
    "regret_unknown_covered",
    "regret_unknown_repaired",
    "regret_unknown_squared",
    "regret_unknown_stated",
    "regret_width",
    "step_bonus_delta",
    "transition_bonus",
    "xi",
    "xi_bar",
    "xi_repaired",
]
