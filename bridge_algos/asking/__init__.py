"""Certified answers: preference questions, a likelihood set of weights, and a gap that says when to stop."""
