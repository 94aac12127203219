"""Which packages made a result: stored with it, because another version may give other last digits."""

from __future__ import annotations

from functools import cache
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("bridge-rl", "numpy", "scipy", "xarray", "cvxpy", "highspy", "python-flint", "gymnasium", "mujoco", "torch")


@cache
def package_versions() -> dict[str, str]:
    """Installed version of each package that decides numbers; ``"not installed"`` where there is none."""
    return {package: _version(package) for package in PACKAGES}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
