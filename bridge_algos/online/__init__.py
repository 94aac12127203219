"""The online stage: preferences in, a shrinking policy set out. BRIDGE, its known-model form and PbRL are one loop."""
