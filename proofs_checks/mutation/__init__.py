"""Mutate the formulas of ``bridge_theory`` one constant or operator at a time, and see whether anything notices."""
