"""An independent evaluator in exact numbers: whole trajectory laws, every policy, no rounding anywhere.

It shares nothing with ``bridge_algos``: laws are enumerated path by path from the definition, square roots are kept as
square roots, so that a comparison is decided, never estimated.
"""
