"""`python -m scenarios.beside [--run FOLDER] [--filter GLOB] [--engine NAME] [--preset NAME]`.

Reads the recordings of a run and compares our distance from the user with another engine's, over the frames in which that one
leaves at most 1 mm of overlap on the legal side; prints a table and writes beside.csv into the run's folder.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import astuple, fields
from pathlib import Path

from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError, InvalidInput
from reference.judging.judge import Judge
from runfiles.csv_rows import csv_lines
from runfiles.files import OUT, latest, write_text
from runfiles.naming import GATED
from runfiles.record import load
from scenarios.beside.pair import Among, Beside, compared
from scenarios.beside.table import FIGURES, known, table
from scenarios.results.kept import as_recorded, fitting, scenes_of

DIGITS = 8
"""Significant digits of a figure: the closest of these are told apart by them."""
NAME = "beside.csv"
"""The file of rows."""


def rows(run: Path, pattern: str, theirs: str) -> list[Beside]:
    """A row per scene with an avatar that both engines ran, seed 0; `theirs` is engine.preset."""
    ours = ".".join(GATED)
    both = [name for name in scenes_of(run, ours, pattern) if name in scenes_of(run, theirs, pattern)]
    found = []
    for name in both:
        paths = [run / "recordings" / f"{name}.{who}.0.npz" for who in (ours, theirs)]
        first, second = (fitting(load(path), path, path is paths[0]) for path in paths)
        scenario = as_recorded(name, first)
        scene = scenario.build()
        if not scene.links:
            continue
        found.append(compared(first, second, scenario, scene, Judge(scene)))
        print(name, file=sys.stderr, flush=True)
    return found


def csv_text(found: Sequence[Beside], theirs: str) -> str:
    """All rows as CSV, with which engine is nearer and what is known of figures in which the other is."""
    parts = "kept", "alike"
    whole = [entry.name for entry in fields(Beside) if entry.name not in parts]
    among = [name for part in parts for name in (part, *(f"{part}_{entry.name}" for entry in fields(Among)[1:]))]
    nearer = ["nearer_offset", "nearer_angle", "nearer_body", *(f"{part}_nearer_{what}" for part in parts for what in FIGURES)]
    lines = (
        (
            theirs, *(getattr(row, name) for name in whole), *astuple(row.kept), *astuple(row.alike),
            *row.winner, row.body_winner, *row.kept.winner, *row.alike.winner, *known(row),
        )
        for row in found
    )
    return csv_lines(["other", *whole, *among, *nearer, "known_offset", "known_angle"], lines, DIGITS)


def main(argv: Sequence[str] | None = None) -> int:
    """Compare, print, write. 0: ours is nowhere farther; 1: somewhere; 2: usage."""
    parser = argparse.ArgumentParser(prog="python -m scenarios.beside", description=str(__doc__).splitlines()[2])
    parser.add_argument("--run", type=path_option, default=latest(OUT), metavar="FOLDER", help="a run (default: `latest`)")
    parser.add_argument("--filter", default="*", metavar="GLOB", help="scenes whose name matches (default: all)")
    parser.add_argument("--engine", default="mujoco", metavar="NAME", help="the other engine (default: mujoco)")
    parser.add_argument("--preset", default="tuned", metavar="NAME", help="with which preset (default: tuned)")
    asked = parser.parse_args(argv)
    theirs = f"{asked.engine}.{asked.preset}"
    try:
        found = rows(asked.run, asked.filter, theirs)
        if not found:
            valid = "a run and a filter with recordings of both, as `make compare` leaves them"
            raise InvalidInput(f"recordings of {theirs} and of ours", f"{asked.run}, {asked.filter}", valid)
        write_text(asked.run / NAME, csv_text(found, theirs))
    except AvatarsimError as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    print(table(found, theirs))
    print(f"\n{asked.run / NAME}")
    return 1 if any("theirs" in row.winner for row in found) else 0


if __name__ == "__main__":
    sys.exit(ended(main))
