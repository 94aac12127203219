"""Formulas of the regret analysis: potentials, known and unknown dynamics, and what offline data buy."""
