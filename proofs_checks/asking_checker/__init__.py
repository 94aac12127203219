"""Certified answers, checked: from the file of an asking session to a verdict, ``bridge-rl verify``."""
