"""BRIDGE, PbRL and BC on tabular (and, behind an extra, MuJoCo) problems: exact where the paper samples."""
