"""Crash testing: kill -9 at random moments, go on, and compare with a run that was left in peace.

`python -m tests.scenarios.killed [--kills N] [--of compare study] [--seed S] [--each K] [--whole]` runs both commands over a few
cheap scenes and engines, kills each run K times at moments drawn over the length of one that is left in peace (in turn the
parent alone and the whole process group), goes on as a user would, and compares what is left in the end. Times differ from run to
run, and so do what is chosen by them and the pages that show them. All else has to be equal to the last byte:

compare: results.json and results.csv but for rows of the timing pass, series of times and, of the provenance, when and how long
it ran; every array of every recording, and its meta but for the rough time of a frame; the files of scenes and of overlapping
pairs; the plan. Nothing half written is left. study: its rows but for those of times.

`--whole` runs scenes at their short lengths, with the studies that are part of a comparison, whose files have to be there.
Exit codes: 0 all equal; 1 something differs.
"""

import argparse
import csv
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from runfiles import array_file
from scenarios.run.accuracy import FRAME_SECONDS
from scenarios.run.results import is_time

ROOT = Path(__file__).resolve().parents[2]
ENGINES = ("avatarsim", "mujoco", "tracker")
WORDS: Mapping[str, Sequence[str]] = {
    "compare": ("compare", "--engine", *ENGINES, "--filter", "ball_drop,hand_over_table"),
    "study": ("study", "settings", "--engine", "avatarsim", "--filter", "ball_drop"),
}
"""What is run, but for its length."""
CUT = ("--frames", "12")
"""The length of it unless it is `--whole`: cheap, and every stage is passed."""
PATIENCE = 600.0
"""Longest a run may take [s]."""
STUDIED = ("settings.csv", "effects.csv", "judge.json")
"""Files of the studies of a whole comparison of these scenes; of times, or chosen by them."""
Kept = dict[str, object]
"""What has to be equal, by a name for it."""


@dataclass(frozen=True)
class Command:
    """One command: its words, what it leaves below `--out` that has to be equal, and with which options it goes on."""

    words: tuple[str, ...]
    kept: Callable[[Path], Kept]
    again: Callable[[Path], tuple[str, ...]]


def commands(whole: bool, words: Mapping[str, Sequence[str]] = WORDS) -> dict[str, Command]:
    """The commands by name."""
    length = () if whole else CUT
    kept: dict[str, Callable[[Path], Kept]] = {"compare": lambda out: of_run(run_of(out), whole), "study": of_study}
    again: dict[str, Callable[[Path], tuple[str, ...]]] = {"compare": resumed, "study": lambda out: ()}
    return {name: Command((*line, *length), kept[name], again[name]) for name, line in words.items()}


def run_of(out: Path) -> Path:
    """The run to which `latest` leads."""
    return (out / "latest").resolve()


def resumed(out: Path) -> tuple[str, ...]:
    """The option that goes on with the last run that has begun; none where none has."""
    begun = sorted(path.parent for path in out.glob("*-compare*/results.json"))
    return ("--resume", str(begun[-1])) if begun else ()


def of_run(folder: Path, whole: bool) -> Kept:
    """What a comparison left that has nothing to do with times."""
    found = json.loads((folder / "results.json").read_text())
    for scene in found["series"].values():
        for numbers in scene.values():
            del numbers["frame_time_us"]
    kept: Kept = {
        "rows": [row for row in found["rows"] if not is_time(row["metric"])], "series": found["series"],
        **{name: found[name] for name in ("schema_version", "engines", "scenes")},
        "versions": {name: found["provenance"][name] for name in ("python", "code", "versions")},
        "lines": [line for line in (folder / "results.csv").read_text().splitlines() if not is_time(line.split(",")[5])],
        "plan": json.loads((folder / "plan.json").read_text())["runs"],
        "studies": [name for name in STUDIED if (folder / name).exists()] if whole else [],
        "pages": sorted(str(path.relative_to(folder)) for path in folder.rglob("*.html")),
        "halves": sorted(str(path.relative_to(folder)) for path in folder.rglob(".*")),
    }
    for path in sorted((*folder.glob("scenes/*.json"), *folder.glob("overlaps/*.npz"), *folder.glob("motions/*.npz"))):
        kept[str(path.relative_to(folder))] = path.read_bytes()
    for path in sorted(folder.glob("recordings/*.npz")):
        arrays = array_file.read(path)
        meta = json.loads(str(arrays.pop("meta")))
        meta.pop(FRAME_SECONDS)
        # bytes, since numbers that are none are equal to nothing
        members = {name: (array.dtype.str, array.shape, array.tobytes()) for name, array in arrays.items()}
        kept[str(path.relative_to(folder))] = members, meta
    return kept


def of_study(out: Path) -> Kept:
    """What a study left that has nothing to do with times."""
    folder = out / "studies"
    with (folder / "settings.csv").open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if not is_time(row["metric"]) and row["metric"] != "resting_frames"]
    return {"rows": rows, "halves": sorted(path.name for path in folder.rglob(".*"))}


def begin(words: Sequence[str], out: Path) -> subprocess.Popen[str]:
    """Start a command in a process group of its own."""
    line = [sys.executable, "-m", "scenarios", *words, "--jobs", "2", "--out", str(out)]
    return subprocess.Popen(line, cwd=ROOT, text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True)


def ends(words: Sequence[str], out: Path) -> tuple[int, str, float]:
    """Exit code, what was said on the error stream, and the time [s] of a command that is left in peace."""
    begun = time.monotonic()
    running = begin(words, out)
    _, said = running.communicate(timeout=PATIENCE)
    return running.returncode, said, time.monotonic() - begun


def killed(words: Sequence[str], out: Path, moment: float, group: bool) -> bool:
    """Start a command and kill it after `moment` [s]; False if it had ended before."""
    running = begin(words, out)
    try:
        running.communicate(timeout=moment)
        return False
    except subprocess.TimeoutExpired:
        if group:
            os.killpg(running.pid, signal.SIGKILL)
        else:
            running.kill()
    # worker processes that outlive it hold its error stream until they notice that it has gone
    running.communicate(timeout=PATIENCE)
    return True


def differing(one: Kept, other: Kept) -> list[str]:
    """Names of what is not equal."""
    return [name for name in sorted({*one, *other}) if one.get(name) != other.get(name)]


def tried(name: str, asked: Command, kills: int, each: int, draw: random.Random, tell: Callable[[str], object]) -> list[str]:
    """Kill a command `kills` times, `each` times in one run; a sentence per difference."""
    troubles = list[str]()
    with tempfile.TemporaryDirectory(prefix="killed-") as folder:
        peace = Path(folder) / "peace"
        code, said, length = ends(asked.words, peace)
        wanted, done = asked.kept(peace), 0
        tell(f"{name}: {length:.1f} s in peace, exit code {code}, {len(wanted)} things to compare")
        while done < kills:
            out, moments = Path(folder) / "out", list[str]()
            while len(moments) < min(each, kills - done):
                moment, group = draw.uniform(0.0, length), (done + len(moments)) % 2 == 1
                if killed((*asked.words, *asked.again(out)), out, moment, group):
                    moments.append(f"{moment:.2f} s{' (group)' if group else ''}")
            done += len(moments)
            words = (*asked.words, *asked.again(out))
            ended, said, _ = ends(words, out)
            lost = differing(wanted, asked.kept(out)) if ended == code else [f"exit code {ended}: {said[-2000:]}"]
            troubles += [f"{name} killed after {', '.join(moments)}: {what}" for what in lost]
            how = "resumed" if "--resume" in words else "begun again"
            tell(f"{name} {done}/{kills}: killed after {', '.join(moments)}, {how}: {', '.join(lost) or 'equal'}")
            shutil.rmtree(out)
    return troubles


def main(argv: Sequence[str] | None = None) -> int:
    """Kill, go on, compare."""
    top = argparse.ArgumentParser(prog="python -m tests.scenarios.killed", description=str(__doc__).splitlines()[0])
    top.add_argument("--kills", type=int, default=50, metavar="N", help="kills of each command (50)")
    top.add_argument("--of", nargs="+", choices=WORDS, default=list(WORDS), help="commands (both)")
    top.add_argument("--seed", type=int, default=1, metavar="S", help="of the moments (1)")
    top.add_argument("--each", type=int, default=1, metavar="K", help="kills of one run before it is left in peace (1)")
    top.add_argument("--whole", action="store_true", help="short lengths in place of 12 frames, with the studies")
    asked = top.parse_args(argv)
    draw, known = random.Random(asked.seed), commands(asked.whole)
    troubles = [said for name in asked.of for said in tried(
        name, known[name], asked.kills, asked.each, draw, lambda said: print(said, flush=True))]
    print("\n".join(troubles) or f"{asked.kills} kills of {' and of '.join(asked.of)}: all equal")
    return 1 if troubles else 0


if __name__ == "__main__":
    sys.exit(main())
