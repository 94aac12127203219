"""Certified answers: a theory of preference queries without kappa (the companion's G1' to G10), as formulas."""
