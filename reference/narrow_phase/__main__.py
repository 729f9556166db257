"""`python -m reference.narrow_phase [--run FOLDER] [--cells GLOB] [--quick]`."""

import argparse
import sys
import time
from collections.abc import Sequence
from fnmatch import fnmatchcase

from avatarsim.console import ended, path_option
from reference.narrow_phase.benchmark import FULL, QUICK, ROWS, about, measure, write
from reference.narrow_phase.cells import cells
from reference.narrow_phase.field import ROOMS
from reference.narrow_phase.harness_cost import loop_cost
from reference.narrow_phase.start_up import measured
from reference.narrow_phase.table import report
from reference.narrow_phase.verdict import judged
from runfiles.files import OUT, last_comparison

NOTHING, MISSING = 5, 3
"""Exit codes, those of `python -m scenarios`: the filter matched nothing; a library is missing. Losing a cell is no error."""


def main(argv: Sequence[str] | None = None) -> int:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(prog="python -m reference.narrow_phase", description=__doc__)
    parser.add_argument("--run", type=path_option, metavar="FOLDER", help="folder for the files (default: the last comparison)")
    parser.add_argument("--cells", default="*", metavar="GLOB", help='cells by name, such as "box-*" or "* deep"')
    parser.add_argument("--quick", action="store_true", help="a few pairs: shows that it runs, times mean nothing")
    asked = parser.parse_args(argv)
    chosen = [cell for cell in cells() if fnmatchcase(cell.name, asked.cells)]
    if not chosen:
        print(f"no cell matches {asked.cells!r}; there are: {', '.join(cell.name for cell in cells())}", file=sys.stderr)
        return NOTHING
    plan, begun = (QUICK if asked.quick else FULL), time.monotonic()

    def say(line: str) -> None:
        print(f"{time.monotonic() - begun:6.1f} s  {line}", file=sys.stderr, flush=True)

    rows, identities, absent = measure(ROOMS, chosen, plan, say)
    folder = asked.run or last_comparison(OUT, "narrow_phase")
    said = about(plan, rows, identities, absent, time.monotonic() - begun)
    write(folder, rows, said)
    print(report(rows, judged(rows), loop_cost(plan.pairs)))
    for name, why in absent.items():
        print(f"{name}: {why}")
    if not asked.quick:
        say("start-up: compiling the collide room from nothing, then starting the engine")
        start_up = measured()
        write(folder, rows, {**said, "start_up": start_up.as_dict()})
        print(f"\n{start_up}")
    print(f"\n{folder / ROWS}")
    return MISSING if absent else 0


if __name__ == "__main__":
    sys.exit(ended(main))
