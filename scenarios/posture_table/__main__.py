"""`python -m scenarios.posture_table [--presets NAME ...] [--rivals ENGINE/PRESET ...] [--clips FOLDER] [-o FILE.md|FILE.csv]`.

How postures are shown, in one table: a row per engine, preset and group. Groups: the catalogue's scenes with an avatar at their
short lengths; each room of the drawn motions (`scenarios.unseen`), with seeds drawn afresh unless given; and, with --clips, every
clip of a folder in three rooms at two heights. All figures are of poses that were shown; chatter, reversals, offsets and angles
(root mean square over links, over joints) are of frames in contact, pooled over the group. A turn of a joint or way of a root is
what is shown beyond the user's largest of that frame. "Free 0.5 s" counts frames in which the target has been free for so long;
one beyond a wall that has no door is outside its scene's region, and so not free. Times are of the engine alone, from runs one
after the other, best of the repeats.

Exit codes: 0; 2 wrong usage; 3 a run crashed or could not be measured.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError, InvalidInput, UnknownName
from runfiles.files import OUT, write_text
from runfiles.naming import GATED
from scenarios.posture_table import moments, probes, ratios
from scenarios.posture_table.plan import GROUPS, Wanted, drawn_seed, group_of, jobs, rooms, runs_of
from scenarios.posture_table.rows import rows
from scenarios.posture_table.runs import Kept, Seen, measured
from scenarios.posture_table.words import as_csv, markdown, table

MOST_JOBS = 2
"""Runs side by side: the judge takes most of the time, and a machine that is full disturbs whatever else is measured on it."""
REPEATS = 2
"""Times that every frame is timed: a disturbance seldom hits one frame twice."""
FOLDER = OUT / "postures"
"""Where runs of other engines are kept."""
EXPECTED = ("measured", "refused", "cannot-say")
"""Ends of a run that are no trouble."""


def parser() -> argparse.ArgumentParser:
    """All options."""
    about = " ".join(str(__doc__).split("\n\n")[1].split())
    top = argparse.ArgumentParser(prog="python -m scenarios.posture_table", description=about)
    top.add_argument("--presets", nargs="+", default=[GATED[1]], metavar="NAME", help="presets of our engine")
    top.add_argument("--rivals", nargs="*", default=[], metavar="ENGINE/PRESET", help="others, such as mujoco/tuned")
    top.add_argument("--groups", nargs="+", default=list(GROUPS), choices=GROUPS, help="groups of scenes (default: all)")
    top.add_argument("--scenes", default="*", metavar="GLOB", help="scenes of these groups whose name matches (default: all)")
    top.add_argument("--rooms", nargs="+", default=list(rooms()), metavar="NAME", help=f"of {', '.join(rooms())} (default: all)")
    top.add_argument("--seeds", type=int, default=6, metavar="N", help="motions drawn in each room")
    top.add_argument("--seed", type=int, default=None, metavar="K", help="seed of the first (default: drawn for this run)")
    top.add_argument("--clips", type=path_option, default=None, metavar="FOLDER", help="clips (*.txt) to be probes")
    top.add_argument("--frames", type=int, default=None, metavar="N", help="frames of each scene at most")
    top.add_argument("--quick", action="store_true", help="a third of the scenes, motions and frames")
    top.add_argument("--repeats", type=int, default=REPEATS, metavar="N", help="times that frames are timed; 0: no times")
    top.add_argument("--jobs", type=int, default=MOST_JOBS, metavar="N", help="runs side by side; timing has one")
    top.add_argument("--fresh", action="store_true", help="run other engines again, though nothing changed that they depend on")
    top.add_argument("--worst", type=int, default=0, metavar="N", help="besides, the N worst moments of each measure and preset")
    top.add_argument("--beside", default=None, metavar="PRESET", help="besides, scene by scene the ratios to this preset")
    top.add_argument("-o", dest="out", type=path_option, default=None, metavar="FILE", help="also into *.md or, rows only, *.csv")
    return top


def wanted(asked: argparse.Namespace) -> Wanted:
    """What is asked for. Raises the error of whatever is out of its range, or has a name that there is not."""
    for thing, value, least in (("--seeds", asked.seeds, 1), ("--seed", asked.seed, 0), ("--frames", asked.frames, 1),
                                ("--repeats", asked.repeats, 0), ("--jobs", asked.jobs, 1), ("--worst", asked.worst, 0)):
        if value is not None and value < least:
            raise InvalidInput(thing, value, f"{least} at least")
    for room in asked.rooms:
        if room not in rooms():
            raise UnknownName("room", room, rooms())
    if asked.out is not None and asked.out.suffix not in (".md", ".csv"):
        raise InvalidInput("-o", str(asked.out), "a name that ends in .md or .csv")
    if asked.beside is not None and asked.beside not in asked.presets:
        raise UnknownName("preset of --beside", asked.beside, asked.presets)
    probes.use(asked.clips)
    return Wanted(
        runs_of(asked.presets, asked.rivals), tuple(asked.groups), asked.scenes, tuple(asked.rooms), asked.seeds,
        drawn_seed() if asked.seed is None else asked.seed, asked.clips, asked.frames, asked.quick,
    )


def troubles(found: Sequence[Seen]) -> list[str]:
    """A sentence for every run that has no figures, or no times, and should have."""
    return [f"{run.where}, {run.job.run}: {run.state}: {run.note}" for run in found if run.note and run.state != "refused"]


def said(asked: argparse.Namespace, want: Wanted, found: Sequence[Seen]) -> str:
    """Everything that is printed."""
    motions = f"{asked.seeds} motions a room from seed {want.seed} on"
    parts = [motions, table(rows(found, group_of))]
    if asked.worst:
        for preset in asked.presets:
            parts.append(f"Worst moments of {preset}:")
            parts.append("\n".join(moments.worst([run for run in found if run.job.run == f"{GATED[0]}/{preset}"], asked.worst)))
    if asked.beside is not None:
        parts += [f"In multiples of {asked.beside}, scene by scene:",
                  markdown(ratios.lines(found, f"{GATED[0]}/{asked.beside}"))]
    return "\n\n".join([*parts, *troubles(found)])


def main(arguments: Sequence[str] | None = None) -> int:
    """Run, print, write; returns the exit code."""
    asked = parser().parse_args(arguments)
    try:
        want = wanted(asked)
        todo = jobs(want)
        print(f"{len(todo)} runs; drawn motions from seed {want.seed} on", file=sys.stderr, flush=True)
        kept = None if asked.fresh or len(want.runs) == len(asked.presets) else Kept(FOLDER)
        with tempfile.TemporaryDirectory() as folder:
            found = measured(todo, Path(folder), want.clips, asked.jobs, asked.repeats, kept, sys.stderr)
        text = said(asked, want, found)
        if asked.out is not None:
            write_text(asked.out, as_csv(rows(found, group_of)) if asked.out.suffix == ".csv" else f"{text}\n")
    except AvatarsimError as error:
        print(f"scenarios.posture_table: {error}", file=sys.stderr)
        return 2
    print(text)
    return 0 if all(run.state in EXPECTED and not run.note.startswith("not timed") for run in found) else 3


if __name__ == "__main__":
    sys.exit(ended(main))
