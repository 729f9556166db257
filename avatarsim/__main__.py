"""Command line: `avatarsim`, or `python -m avatarsim`; without a command it compiles the kernels ahead of their first use."""

import sys

from avatarsim.cli import main
from avatarsim.console import ended


def run() -> int:
    """Run the whole command and return its exit code, whatever becomes of its streams."""
    return ended(main)


if __name__ == "__main__":
    sys.exit(run())
