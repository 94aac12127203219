"""``bridge-rl report``: runs and reproductions as one self-contained page."""
