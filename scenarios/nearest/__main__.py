"""`python -m scenarios.nearest [--run FOLDER] [--filter GLOB] [--frames N] [--engine NAME] [--preset NAME]`.

Reads the recordings of a run, searches the nearest free posture of sampled frames in contact, prints a table, and writes
nearest_free.csv (every sample) and nearest_free_scenes.csv into the run's folder.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from avatarsim.errors import AvatarsimError, UnknownName
from scenarios.csv_rows import csv_text
from scenarios.files import OUT, write_text
from scenarios.kept import as_recorded, recordings, scenes_of
from scenarios.nearest.frames import Frames, Sample
from scenarios.nearest.summary import Summary, summarised, table

DIGITS = 8
"""Significant digits of a figure: the closest of these are told apart by them."""
FRAMES = 12
"""Frames sampled per scene; a search takes a second or two."""
NAME, SCENES = "nearest_free.csv", "nearest_free_scenes.csv"
"""The file of samples, and that of scenes, which the report reads."""


def searched(run: Path, names: Sequence[str], first: str, count: int) -> tuple[list[Sample], list[Summary], list[str]]:
    """All samples, their summaries, and the scenes without a frame to search."""
    samples: list[Sample] = []
    summaries: list[Summary] = []
    without: list[str] = []
    begun = time.monotonic()
    for name in names:
        found = recordings(run, name, first)
        scenario = as_recorded(name, found[0])
        scene = scenario.build()
        if not scene.links:
            continue
        here = list(Frames(scenario, scene, found[0], [one for one in found[1:] if one.frames == found[0].frames]).samples(count))
        samples += here
        summaries += [summarised(here)] if here else []
        without += [] if here else [name]
        print(f"{time.monotonic() - begun:7.1f} s  {name}", file=sys.stderr, flush=True)
    return samples, summaries, without


def main(argv: Sequence[str] | None = None) -> int:
    """Search, print, write. 0: within the promise in every scene; 1: not; 2: usage."""
    parser = argparse.ArgumentParser(prog="python -m scenarios.nearest", description=str(__doc__).splitlines()[2])
    parser.add_argument("--run", type=Path, default=OUT / "latest", metavar="FOLDER", help="a run (default: the last)")
    parser.add_argument("--filter", default="*", metavar="GLOB", help="scenes whose name matches (default: all)")
    parser.add_argument("--frames", type=int, default=FRAMES, metavar="N", help=f"frames per scene (default: {FRAMES})")
    parser.add_argument("--engine", default="avatarsim", metavar="NAME", help="whose postures (default: avatarsim)")
    parser.add_argument("--preset", default="default", metavar="NAME", help="with which preset (default: default)")
    asked = parser.parse_args(argv)
    first = f"{asked.engine}.{asked.preset}"
    try:
        names = scenes_of(asked.run, first, asked.filter)
        if not names:
            raise UnknownName(f"recordings of {first} in {asked.run}", asked.filter, ())
        samples, summaries, without = searched(asked.run, names, first, max(asked.frames, 1))
        write_text(asked.run / NAME, csv_text(samples, Sample, DIGITS))
        write_text(asked.run / SCENES, csv_text(summaries, Summary, DIGITS))
    except AvatarsimError as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    print(table(summaries, without))
    print(f"\n{asked.run / NAME}")
    return 0 if all(summary.within for summary in summaries) else 1


if __name__ == "__main__":
    sys.exit(main())
