"""`python -m scenarios.table_2 [--run FOLDER] [--to FOLDER]`.

Reads a run that has timed scenes of the paper's Table 2, prints the table beside the paper's, and writes table_2.csv,
figure_8.csv and, timed here, figure_7.csv and figure_7_shares.csv into the run's folder, or into another run's.
"""

import argparse
import math
import sys
from collections.abc import Sequence
from dataclasses import astuple, fields
from pathlib import Path

from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError
from runfiles.csv_rows import csv_lines
from runfiles.files import OUT, latest, write_text
from scenarios.table_2.figure_7 import traces
from scenarios.table_2.printed import SCENES
from scenarios.table_2.rows import Row, rows, trace

TABLE, TRACE, LONG_TRACE, SHARES = "table_2.csv", "figure_8.csv", "figure_7.csv", "figure_7_shares.csv"
"""The files of the table and of the traces."""


def written(run: Path, folder: Path, clocks: bool = True) -> list[Row]:
    """Write the files of `run` into `folder`; nothing where the run has none of the scenes."""
    found = rows(run, clocks)
    if found:
        write_text(folder / TABLE, csv_lines([entry.name for entry in fields(Row)], [astuple(row) for row in found]))
        lines = [
            (run, k + 1, us, int(iterations)) for run, numbers in trace(run).items()
            for k, (us, iterations) in enumerate(zip(numbers["us"], numbers["iterations"], strict=True))
        ]
        write_text(folder / TRACE, csv_lines(("run", "frame", "us", "iterations"), lines))
        if clocks:
            hand = traces()
            stages = [(trace.run, name, share) for trace in hand for name, share in trace.shares.items()]
            write_text(folder / SHARES, csv_lines(("run", "stage", "share"), stages))
            long = [(trace.run, k + 1, float(us), int(touches)) for trace in hand
                    for k, (us, touches) in enumerate(zip(trace.us, trace.contact, strict=True))]
            write_text(folder / LONG_TRACE, csv_lines(("run", "frame", "us", "contact"), long))
    return found


def _cell(value: float, width: int, digits: int) -> str:
    return f"{'-':>{width}s}" if math.isnan(value) else f"{value:{width}.{digits}f}"


def table(found: Sequence[Row]) -> str:
    """A line per scene and method."""
    lines = [
        f"{'scene':18s} {'method':22s} {'frames':>6s} {'ms':>8s} {'joints':>7s} {'iter':>6s} {'IK %':>6s} {'pairs':>6s} "
        f"{'cq %':>6s} {'us/joint':>8s} {'us/iter':>8s} {'us/pair':>8s} {'us/query':>8s} {'posing %':>8s} {'overlap mm':>10s}",
    ]
    for r in found:
        lines.append(
            f"{r.scene:18s} {r.run:22s} {r.frames:6d} {r.ms:8.4f} {_cell(r.joints, 7, 1)} {_cell(r.iterations, 6, 2)} "
            f"{_cell(r.ik_share, 6, 1)} {_cell(r.pairs, 6, 2)} {_cell(r.collision_share, 6, 1)} {_cell(r.us_per_joint, 8, 3)} "
            f"{_cell(r.us_per_iteration, 8, 3)} {_cell(r.us_per_pair, 8, 3)} {_cell(r.us_per_query, 8, 3)} "
            f"{_cell(r.posing_share, 8, 1)} {_cell(1e3 * r.overlap, 10, 4)}"
        )
    return "\n".join(lines)


def main(argv: Sequence[str] | None = None) -> int:
    """Read, print, write. 0: done; 2: the run cannot be used; 5: it has none of the scenes."""
    parser = argparse.ArgumentParser(prog="python -m scenarios.table_2", description=str(__doc__).splitlines()[2])
    parser.add_argument("--run", type=path_option, default=latest(OUT), metavar="FOLDER", help="a run (default: `latest`)")
    parser.add_argument("--to", type=path_option, metavar="FOLDER", help="folder for the files (default: that of the run)")
    parser.add_argument("--no-clocks", action="store_true", help="leave out the shares, which need a run of their own")
    asked = parser.parse_args(argv)
    folder = asked.to or asked.run
    try:
        found = written(asked.run, folder, not asked.no_clocks)
    except (AvatarsimError, OSError) as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    if not found:
        print(f"the run has timed none of {', '.join(SCENES)}", file=sys.stderr)
        return 5
    print(table(found))
    print(f"\n{folder / TABLE}")
    return 0


if __name__ == "__main__":
    sys.exit(ended(main))
