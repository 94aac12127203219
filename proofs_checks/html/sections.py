"""The sections of the paper by their labels, in words."""

from __future__ import annotations

_TITLES = {
    "sec:problem_formulation": "Problem formulation",
    "sec:method": "Method",
    "sec:methods_offline": "Stage 1: offline confidence set",
    "sec:methods_online": "Stage 2: online preference learning",
    "sec:bridge": "The bridge: how offline data reduces online regret",
    "sec:experiments": "Experiments",
    "appdx:ablations": "Appendix: ablations",
    "appdx:envs": "Appendix: environments",
    "appdx:embeddings": "Appendix: embeddings",
    "appdx:efficient_hellinger_calc": "Appendix: Hellinger distance of discrete trajectories",
    "appdx:A": "Appendix: simplified setup",
    "subsec:known_dynamics": "Online learning with known dynamics",
    "app:Maximum_Likelihood_for_Density_Estimation": "Maximum likelihood for density estimation",
    "subsection: MLE Objective of Dataset of Independent Trajectories": "Maximum likelihood of trajectories",
    "appdx:policy_estimation": "Policy estimation",
    "appdx:transition_proofs": "Transition estimation",
    "appdx:concentrability_coefficient_bound": "Concentrability coefficient",
    "appdx:offline_confset_guarantees": "Guarantees of the offline set",
    "appdx:pi_t_and_proof_lemma4.9": "The policy sets of the rounds",
    "appdx:regret_analysis": "Regret analysis",
    "appdx:term_1_bounds": "Term 1",
    "appdx:term_1_auxiliary_lemmata": "Term 1: auxiliary lemmata",
    "appdx:term_2_auxiliary_lemmata": "Term 2: auxiliary lemmata",
    "appdx:": "Term 3",
    "appdx:term_3_auxiliary_lemmata": "Term 3: auxiliary lemmata",
}


def section_title(section: str) -> str:
    r"""The title of a section by its label; a section without a label is called by its text already.

    >>> section_title("sec:methods_offline"), section_title(r"Regret: \bridge{}")
    ('Stage 1: offline confidence set', 'Regret: BRIDGE')
    """
    return _TITLES.get(section, section.replace(r"\bridge{}", "BRIDGE"))
