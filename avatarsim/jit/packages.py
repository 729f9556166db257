"""Versions of the compiler's packages that the kernels are tested with; to name them costs no start of the compiler."""

TESTED = {"numba": (0, 68), "llvmlite": (0, 50)}
"""Minor versions that the test suite runs with; pyproject.toml lets no later ones be installed."""
