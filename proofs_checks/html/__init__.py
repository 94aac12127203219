"""The ledger as one self-contained page: no script, font or picture comes from elsewhere."""
