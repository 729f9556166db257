"""`python -m avatarsim`: compile the kernels ahead of their first use."""

import argparse
import os
import sys

from avatarsim.compile_ahead import PARTS, compile_everything, compile_share


def main() -> int:
    """0 when everything is compiled."""
    parser = argparse.ArgumentParser(
        prog="python -m avatarsim", description="Compile the engine's kernels now instead of at their first use; kept on disk."
    )
    parser.add_argument("--parts", choices=PARTS, nargs="+", help="only these parts, in this process")
    parts = parser.parse_args().parts
    if parts is None:
        return 0 if compile_everything() else 1
    compile_share(parts)
    # What was compiled is on disk; to take down millions of objects one by one would cost seconds.
    os._exit(0)


if __name__ == "__main__":
    sys.exit(main())
