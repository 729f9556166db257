"""Crash testing: kill -9 at random moments, resume, and compare with an undisturbed run.

`python -m tests.scenarios.killed [--kills N] [--of compare study] [--seed S] [--each K] [--whole]` runs both commands over a few
cheap scenes and engines, kills each run K times at moments drawn over the length of an undisturbed one (in turn the parent alone
and the whole process group), resumes as a user would, and compares the final files. Times differ from run to run, and so do
choices made by them and the pages that show them. All else has to be equal to the last byte:

compare: results.json and results.csv except rows of the timing pass, series of times and, of the provenance, its date and
duration; every array of every recording, and its meta except the rough time of a frame; the files of scenes and of overlapping
pairs; the plan. No half-written file is left. study: its rows except those of times.

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
"""Commands that are run, without their length."""
CUT = ("--frames", "12")
"""Length of the commands without `--whole`: cheap, but every stage runs."""
PATIENCE = 600.0
"""Longest duration of a run [s]."""
STUDIED = ("settings.csv", "effects.csv", "judge.json")
"""Files of the studies of a whole comparison of these scenes; they contain times or depend on them."""
Kept = dict[str, object]
"""Results that have to be equal, by name."""


@dataclass(frozen=True)
class Command:
    """One command: its words, the results below `--out` that have to be equal, and the options to resume it."""

    words: tuple[str, ...]
    kept: Callable[[Path], Kept]
    again: Callable[[Path], tuple[str, ...]]


def commands(whole: bool, words: Mapping[str, Sequence[str]] = WORDS) -> dict[str, Command]:
    """Return the commands by name."""
    length = () if whole else CUT
    kept: dict[str, Callable[[Path], Kept]] = {"compare": lambda out: of_run(run_of(out), whole), "study": of_study}
    again: dict[str, Callable[[Path], tuple[str, ...]]] = {"compare": resumed, "study": lambda out: ()}
    return {name: Command((*line, *length), kept[name], again[name]) for name, line in words.items()}


def run_of(out: Path) -> Path:
    """Return the run to which `latest` links."""
    return (out / "latest").resolve()


def resumed(out: Path) -> tuple[str, ...]:
    """Return the option that resumes the last run that has begun, or none without such a run."""
    begun = sorted(path.parent for path in out.glob("*-compare*/results.json"))
    return ("--resume", str(begun[-1])) if begun else ()


def of_run(folder: Path, whole: bool) -> Kept:
    """Return the results of a comparison that do not depend on times."""
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
        # bytes, since NaN is not equal to itself
        members = {name: (array.dtype.str, array.shape, array.tobytes()) for name, array in arrays.items()}
        kept[str(path.relative_to(folder))] = members, meta
    return kept


def of_study(out: Path) -> Kept:
    """Return the results of a study that do not depend on times."""
    folder = out / "studies"
    with (folder / "settings.csv").open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if not is_time(row["metric"]) and row["metric"] != "resting_frames"]
    return {"rows": rows, "halves": sorted(path.name for path in folder.rglob(".*"))}


def begin(words: Sequence[str], out: Path) -> subprocess.Popen[str]:
    """Start a command in a process group of its own."""
    line = [sys.executable, "-m", "scenarios", *words, "--jobs", "2", "--out", str(out)]
    return subprocess.Popen(line, cwd=ROOT, text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True)


def ends(words: Sequence[str], out: Path) -> tuple[int, str, float]:
    """Return the exit code, the error output and the time [s] of an undisturbed command."""
    begun = time.monotonic()
    running = begin(words, out)
    _, said = running.communicate(timeout=PATIENCE)
    return running.returncode, said, time.monotonic() - begun


def killed(words: Sequence[str], out: Path, moment: float, group: bool) -> bool:
    """Start a command and kill it after `moment` [s]; return False if it had ended before."""
    running = begin(words, out)
    try:
        running.communicate(timeout=moment)
        return False
    except subprocess.TimeoutExpired:
        if group:
            os.killpg(running.pid, signal.SIGKILL)
        else:
            running.kill()
    # worker processes that outlive it keep its error stream open until they notice its end
    running.communicate(timeout=PATIENCE)
    return True


def differing(one: Kept, other: Kept) -> list[str]:
    """Return the names of results that are not equal."""
    return [name for name in sorted({*one, *other}) if one.get(name) != other.get(name)]


def tried(name: str, asked: Command, kills: int, each: int, draw: random.Random, tell: Callable[[str], object]) -> list[str]:
    """Kill a command `kills` times, `each` times in one run; return a sentence per difference."""
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
    """Kill, resume and compare; return 1 if something differs."""
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
