"""`python -m reference.broad_phase [--run FOLDER] [--quick]`."""

import argparse
import sys
import time
from collections.abc import Sequence

from avatarsim.console import ended, path_option
from reference.broad_phase.clock import KERNELS, MOST_OBJECTS, measure
from reference.broad_phase.layouts import LAYOUTS, MOTIONS, field
from reference.broad_phase.rows import Row, csv_text
from reference.broad_phase.table import table
from runfiles.files import OUT, last_comparison, write_text

SIZES = (20, 60, 200, 600, 2000, 6000, 20000)
FULL, QUICK = (400, 9, 200_000), (3, 1, 100)
"""Warm-up frames, samples, objects times frames in a sample."""

OURS = ("sweep and prune",)
"""Measured in every motion; the others only where everything moves slowly."""

WRONG = 1
"""Exit code when a kernel found other pairs than its twin. Growth that is not flat is no error."""


def main(argv: Sequence[str] | None = None) -> int:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(prog="python -m reference.broad_phase", description=__doc__)
    parser.add_argument("--run", type=path_option, metavar="FOLDER", help="folder for the file (default: the last comparison)")
    parser.add_argument("--quick", action="store_true", help="few objects and frames: shows that it runs, times mean nothing")
    asked = parser.parse_args(argv)
    (warm, samples, work), begun = (QUICK if asked.quick else FULL), time.monotonic()
    rows: list[Row] = []
    for layout in LAYOUTS:
        for motion in MOTIONS:
            here = {size: field(layout, motion, size) for size in (SIZES[:3] if asked.quick else SIZES)}
            for name in KERNELS if motion == "all slow" else OURS:
                fields = [one for size, one in here.items() if size <= MOST_OBJECTS[name]]
                rows += measure(fields, layout, motion, name, warm, samples, work)
            print(f"{time.monotonic() - begun:6.1f} s  {layout}, {motion}", file=sys.stderr, flush=True)
    path = (asked.run or last_comparison(OUT, "broad_phase")) / "broad_phase.csv"
    write_text(path, csv_text(rows))
    print(table(rows))
    print(f"\n{path}")
    return 0 if all(row.found_is_twin for row in rows) else WRONG


if __name__ == "__main__":
    sys.exit(ended(main))
