"""Proofs for Coq's kernel; compiled in a temporary folder, where ``coqc`` is installed."""
