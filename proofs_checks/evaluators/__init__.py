"""Evaluators of stored counterexamples. They import neither the claims nor the code whose statements they judge."""
