"""Check functions: each returns an ``Outcome`` and takes the constants that its mutants change."""
