"""Formulas of the online part: preference confidence sets, norm relations, transition bonuses, coverage."""
