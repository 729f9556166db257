"""`python -m scenarios.growth [--run FOLDER] [--engine NAME ...] [--quick]`.

Times frames of growing scenes, the engines of a scene taking turns, prints a table and writes growth.csv into the run's folder.
"""

import argparse
import sys
import time
from collections.abc import Sequence

import numpy as np

from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError, UnknownName
from runfiles.csv_rows import csv_text
from runfiles.files import OUT, last_comparison, write_text
from runfiles.naming import BASELINE
from scenarios.engines import known
from scenarios.growth import worlds
from scenarios.growth.rows import Row, table
from scenarios.job import Job
from scenarios.running.harness import offers
from scenarios.running.timing import Clocked, timed_pass

NAME = "growth.csv"
"""The file of rows."""
BEST = {"mujoco": ("tuned",), "pybullet": ("tuned",)}
"""Presets timed of the engines we compare with: their best for contact. Of all others every one."""
SLEEPS = "sleeping"
"""The same with their own sleeping switched on, which neither of them does by itself."""
MOST = {
    ("mujoco", "avatars"): 10, ("pybullet", "avatars"): 10, ("pybullet", "links"): 100,
    ("mujoco", "objects"): 200, ("pybullet", "objects"): 200,
}
"""Largest size asked of an engine: more avatars, or objects that do not sleep, take these minutes, and PyBullet has no room for
the joints of 199 links."""


def jobs_of(name: str, size: int, engines: dict[str, tuple[str, ...]]) -> list[Job]:
    """Every engine and preset that takes part in a scene."""
    grows = name.split("_")[0]
    jobs = [
        Job(name, engine, preset, full=True, catalogue=worlds.__name__) for engine, presets in engines.items()
        for preset in presets if size <= MOST.get((engine, grows), size)
    ]
    # the others let bodies sleep where an option asks for it
    asleep = [
        Job(name, engine, SLEEPS, full=True, base=presets[0], options={"sleep": True}, catalogue=worlds.__name__)
        for engine, presets in engines.items() if engine in BEST and grows == "objects"
    ]
    return [*jobs, *asleep]


def row(grows: str, mode: str, size: int, clocked: Clocked) -> Row:
    """What one engine took."""
    links = len(worlds.get(clocked.job.scenario).build().links)
    if clocked.timed is None:
        return Row(grows, mode, size, links, clocked.job.run, float("nan"), float("nan"), clocked.note)
    p50, p95 = np.percentile(clocked.timed.best_us, (50, 95))
    return Row(grows, mode, size, links, clocked.job.run, float(p50), float(p95), clocked.note)


def timed(engines: dict[str, tuple[str, ...]], quick: bool) -> list[Row]:
    """All rows, scene by scene."""
    rows: list[Row] = []
    begun = time.monotonic()
    for grows, sizes in worlds.SIZES.items():
        for mode in worlds.MODES[grows]:
            for size in sizes[:1] if quick else sizes:
                jobs = jobs_of(f"{grows}_{size}_{mode}", size, engines)
                # the quick length of the timing pass: an engine that takes long gets fewer repeats
                rows += [row(grows, mode, size, clocked) for clocked in timed_pass(jobs, False)]
                print(f"{time.monotonic() - begun:6.1f} s  {grows} {size}, {mode}", file=sys.stderr, flush=True)
    return rows


def main(argv: Sequence[str] | None = None) -> int:
    """Time, print, write. 0: done; 2: usage; 3: an engine gave no times."""
    parser = argparse.ArgumentParser(prog="python -m scenarios.growth", description=str(__doc__).splitlines()[2])
    parser.add_argument("--run", type=path_option, metavar="FOLDER", help="folder for the file (default: the last comparison)")
    everybody = [name for name in known() if name != BASELINE]
    parser.add_argument("--engine", nargs="+", default=everybody, metavar="NAME", help="engines (default: all)")
    parser.add_argument("--quick", action="store_true", help="the smallest sizes only: shows that it runs")
    asked = parser.parse_args(argv)
    try:
        for name in asked.engine:
            if name not in known():
                raise UnknownName("engine", name, known())
        offered = offers(asked.engine, 1)
        engines = {name: BEST.get(name, offered[name].presets) for name in asked.engine if not offered[name].trouble}
        rows = timed(engines, asked.quick)
        folder = asked.run or last_comparison(OUT, "growth")
        write_text(folder / NAME, csv_text(rows, Row))
    except AvatarsimError as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    print(table(rows))
    print(f"\n{folder / NAME}")
    return 3 if any(row.p50 != row.p50 for row in rows) else 0


if __name__ == "__main__":
    sys.exit(ended(main))
