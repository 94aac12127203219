"""The subcommands of ``bridge-rl`` that need nothing but the theory."""
