"""Checks of the online claims; heavy imports stay inside the functions."""
