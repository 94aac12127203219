"""The offline part: estimation errors, the confidence set's radius, and what data alone say."""
