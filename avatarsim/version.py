"""Version of the package: read by the build, by `avatarsim.__version__` and by the engine's record of itself."""

VERSION = "0.2.0"
"""As on the package index; its changes for users are in CHANGELOG.md."""
