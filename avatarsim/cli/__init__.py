"""Command line of the package, `avatarsim` or `python -m avatarsim`: clean, audit, pieces, compile."""

from avatarsim.cli.dispatch import main

__all__ = ["main"]
