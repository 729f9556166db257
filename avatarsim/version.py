"""Version of the package: read by the build, by `avatarsim.__version__` and by what the engine says of itself."""

VERSION = "0.2.0"
"""As on the package index; what a user notices of it stands in CHANGELOG.md."""
