"""`python -m scenarios.nearest [--run FOLDER] [--filter GLOB] [--frames N] [--engine NAME] [--preset NAME] [--jobs N]`.

Reads the recordings of a run, searches the nearest free posture of sampled frames in contact, prints a table, and writes
nearest_free.csv (every sample) and nearest_free_scenes.csv into the run's folder, again after every scene.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError, InvalidInput
from avatarsim.running.processes import Died
from avatarsim.running.stopping import stoppable
from runfiles.csv_rows import csv_text
from runfiles.files import OUT, latest, write_text
from scenarios.nearest.frames import Sample
from scenarios.nearest.searched import searched
from scenarios.nearest.summary import Summary, summarised, table
from scenarios.results.gate import STOPPED
from scenarios.results.kept import scenes_of
from scenarios.running.processes import side_by_side
from scenarios.running.progress import Progress

DIGITS = 8
"""Significant digits of a figure: the closest of these are told apart by them."""
FRAMES = 12
"""Frames sampled per scene; a search takes a second or two."""
WITH_SOME = "a run and a filter with some, as `make compare` leaves them"
"""What can be searched."""
NAME, SCENES = "nearest_free.csv", "nearest_free_scenes.csv"
"""The file of samples, and that of scenes, which the report reads."""


def summaries(found: dict[str, list[Sample]]) -> list[Summary]:
    """Of every scene that had a frame to search."""
    return [summarised(samples) for samples in found.values() if samples]


def kept(run: Path, names: Sequence[str], first: str, count: int, jobs: int) -> tuple[dict[str, list[Sample]], dict[str, Died]]:
    """The samples of every scene with an avatar, in the order of `names`, and the scenes whose search ended without an answer.
    What is found is written at once: a command that is stopped leaves what it had."""
    found: dict[str, list[Sample]] = {}
    died: dict[str, Died] = {}
    with Progress("nearest", len(names), sys.stderr) as progress:
        for name, answer in side_by_side(partial(searched, run=run, first=first, count=count), names, jobs):
            if isinstance(answer, Died):
                died[name] = answer
            elif answer is not None:
                found[name] = answer
                found = {name: found[name] for name in names if name in found}
                write_text(run / NAME, csv_text([sample for samples in found.values() for sample in samples], Sample, DIGITS))
                write_text(run / SCENES, csv_text(summaries(found), Summary, DIGITS))
            progress.step(name)
    return found, died


def main(argv: Sequence[str] | None = None) -> int:
    """Search, print, write. 0: within the promise in every scene; 1: not; 2: usage, or no answer for a scene; 130: stopped."""
    parser = argparse.ArgumentParser(prog="python -m scenarios.nearest", description=str(__doc__).splitlines()[2])
    parser.add_argument("--run", type=path_option, default=latest(OUT), metavar="FOLDER", help="a run (default: `latest`)")
    parser.add_argument("--filter", default="*", metavar="GLOB", help="scenes whose name matches (default: all)")
    parser.add_argument("--frames", type=int, default=FRAMES, metavar="N", help=f"frames per scene (default: {FRAMES})")
    parser.add_argument("--engine", default="avatarsim", metavar="NAME", help="whose postures (default: avatarsim)")
    parser.add_argument("--preset", default="default", metavar="NAME", help="with which preset (default: default)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="scenes side by side; 0: here")
    asked = parser.parse_args(argv)
    first = f"{asked.engine}.{asked.preset}"
    try:
        if asked.frames < 1 or asked.jobs < 0:
            raise InvalidInput("--frames, --jobs", (asked.frames, asked.jobs), "1 and up; 0 and up")
        names = scenes_of(asked.run, first, asked.filter)
        if not names:
            raise InvalidInput(f"recordings of {first}", f"{asked.run}, {asked.filter}", WITH_SOME)
        with stoppable():
            found, died = kept(asked.run, names, first, asked.frames, asked.jobs)
    except AvatarsimError as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"stopped; what was found is in {asked.run / NAME}", file=sys.stderr)
        return STOPPED
    print(table(summaries(found), [name for name, samples in found.items() if not samples]))
    print(f"\n{asked.run / NAME}")
    for name, how in died.items():
        print(f"{name} was not searched: {how}", file=sys.stderr)
    if died:
        return 2
    return 0 if all(summary.within for summary in summaries(found)) else 1


if __name__ == "__main__":
    sys.exit(ended(main))
