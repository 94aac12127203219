"""Empirical regret beside every version of the theory: ``bridge-rl compare``, and the same from Python.

:func:`compare` turns a stored run into :class:`Comparison` objects; :func:`figure` and :func:`words` show them.
"""

from experiments.compare.comparison import Comparison, Empirical, Row, compare
from experiments.compare.figure import figure
from experiments.compare.theory_curves import Curve, LeftOut
from experiments.compare.words import table, words

__all__ = ["Comparison", "Curve", "Empirical", "LeftOut", "Row", "compare", "figure", "table", "words"]
