"""One deterministic Hypothesis profile for the whole directory: a failure is the same failure everywhere."""

from hypothesis import HealthCheck, settings

settings.register_profile(
    "theory",
    max_examples=20,
    derandomize=True,
    database=None,
    deadline=None,
    # formulas with conditions discard many random points; that is meant
    suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
)
settings.load_profile("theory")
