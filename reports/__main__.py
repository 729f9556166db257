"""`python -m reports write [RUN]` rebuilds the pages of a run; `python -m reports diff OLD NEW` compares two runs.

Exit codes: write 0; diff 0 when nothing got worse, 1 when something did; both 2 when a file cannot be used.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from avatarsim.errors import AvatarsimError
from reports import PAGE, write_report
from reports.diff import diff
from reports.load import load

LATEST = Path("reports/out/latest")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code."""
    parser = argparse.ArgumentParser(prog="python -m reports", description="Pages and comparisons from files of runs.")
    commands = parser.add_subparsers(dest="command", required=True)
    write = commands.add_parser("write", help="write index.html, summary.md and junit.xml of a run again")
    write.add_argument("run", type=Path, nargs="?", default=LATEST, help=f"folder of a run (default: {LATEST})")
    compare = commands.add_parser("diff", help="what got better or worse from OLD to NEW")
    compare.add_argument("old", type=Path, help="folder of the earlier run")
    compare.add_argument("new", type=Path, help="folder of the later run")
    chosen = parser.parse_args(arguments)
    try:
        if chosen.command == "write":
            write_report(chosen.run)
            print(chosen.run / PAGE)
            return 0
        changes = diff(load(chosen.old), load(chosen.new))
    except AvatarsimError as error:
        print(f"reports: {error}", file=sys.stderr)
        return 2
    print(changes.text())
    return 1 if changes.worse else 0


if __name__ == "__main__":
    sys.exit(main())
