"""`python -m scenarios.first_frame [--filter GLOB] [--preset NAME ...] [--frames N]`.

Times the first frame after `load` against the median frame, each scene in a process of its own, and prints the worst. A kernel
that is brought into memory after `load` is a fault, and so is a first frame of more than 10 medians; unless it takes half as long
when all is warm, loaded again in the same process, as in a scene that begins with impacts and then sleeps.

Kernels should be compiled already (`python -m avatarsim`): the first process would compile them, within `load`.
"""

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from avatarsim.command_line import ended
from avatarsim.errors import AvatarsimError, InvalidInput, StartOverlaps
from avatarsim.linking import CalledKernel
from scenarios import catalog
from scenarios.asked import asked
from scenarios.engines import GATED, opened
from scenarios.filtered import filtered
from scenarios.job import Job

MOST_TIMES = 10.0
"""Longest first frame, in multiples of the median frame. A first frame has cold caches and everything to look at; what it may not
have is something to load, which takes thousands of medians."""
OWN_SHARE = 0.5
"""Least share of a first frame of more than MOST_TIMES medians that is its own work: what it takes when it is loaded again in the
same process. Below this most of it is something that `load` left."""
WARM = 3
"""Times it is loaded again; the least counts."""
FRAMES = 600
"""Frames run per scene, or as many as it has: the median is that of ten seconds."""
TRIES = 3
"""Processes asked about a scene before its first frame counts as too long; what is left to load is left in each, a disturbance by
the rest of the machine is not."""
REFUSED = "refused, as it overlaps at the start"
"""What is said of a scene without a first frame."""
SHOWN = 12
"""Lines of the table."""
CLOCKED = 100
"""Calls of the clock before the first frame, which shall not pay for the clock's own first call."""


@dataclass(frozen=True)
class Found:
    """One scene in one process: times of `load` [s]; of the first frame, of the same frame when all is warm, and of the median
    frame [us]; kernels that frames loaded."""

    scene: str
    preset: str
    load: float
    first: float
    warm: float
    median: float
    late: int

    @property
    def times(self) -> float:
        """The first frame in multiples of the median."""
        return self.first / self.median

    @property
    def long(self) -> bool:
        """Whether it is more than MOST_TIMES medians, or no number."""
        return not self.times <= MOST_TIMES

    @property
    def good(self) -> bool:
        """Whether `load` left nothing."""
        return self.late == 0 and (not self.long or self.warm >= OWN_SHARE * self.first)


def measured(scene: str, preset: str, frames: int) -> Found | None:
    """Run a scene in this process, which has run nothing yet; None if its first pose is refused, as it should be."""
    job = Job(scene, GATED[0], preset)
    what = asked(job)
    engine, samples, clock = opened(job.engine), what.samples[:frames], time.perf_counter_ns
    begun = clock()
    try:
        engine.load(what.scene, job.settings(engine), what.scenario.dt)
    except StartOverlaps:
        return None
    load, made, dt = (clock() - begun) * 1e-9, CalledKernel.made, what.scenario.dt
    spent = np.zeros(len(samples), np.int64)
    for _ in range(CLOCKED):
        clock()
    for k, sample in enumerate(samples):
        begun = clock()
        engine.advance(sample, dt)
        spent[k] = clock() - begun
    made, again = CalledKernel.made - made, []
    for _ in range(WARM):
        engine.load(what.scene, job.settings(engine), dt)
        begun = clock()
        engine.advance(samples[0], dt)
        again.append(clock() - begun)
    engine.close()
    return Found(scene, preset, load, float(spent[0]) * 1e-3, min(again) * 1e-3, float(np.median(spent)) * 1e-3, made)


def alone(scene: str, preset: str, frames: int) -> Found | str:
    """The same in a process of its own; in several, and the shortest first frame, where it takes too long. Without a first frame,
    why there is none."""
    found: Found | None = None
    for _ in range(TRIES):
        command = [sys.executable, "-m", "scenarios.first_frame", "--alone", scene, preset, "--frames", str(frames)]
        ended = subprocess.run(command, cwd=Path(__file__).parents[1], capture_output=True, text=True, check=False)
        if ended.returncode != 0:
            return (ended.stderr.strip().splitlines() or [f"it ended with code {ended.returncode}"])[-1]
        answer = json.loads(ended.stdout)
        if answer is None:
            return REFUSED
        again = Found(**answer)
        found = again if found is None or again.late > found.late or again.times < found.times else found
        if not found.long or found.late:
            break
    return found or REFUSED


def table(found: Sequence[Found]) -> str:
    """The worst scenes, a line each."""
    worst = sorted(found, key=lambda one: (-one.late, -one.times))[:SHOWN]
    heads = f"{'frame 1 us':>11} {'warm us':>9} {'median us':>10} {'times':>7} {'loaded late':>12}"
    lines = [f"{'scene':<32} {'preset':<8} {'load s':>7} {heads}"]
    for one in worst:
        figures = f"{one.first:11.1f} {one.warm:9.1f} {one.median:10.1f} {one.times:7.1f} {one.late:12d}"
        lines.append(f"{one.scene:<32} {one.preset:<8} {one.load:7.2f} {figures}")
    return "\n".join(lines)


def main(argv: Sequence[str] | None = None) -> int:
    """Measure and print. 0: nothing is left for first frames; 1: in some scene something is; 2: usage; 3: some could not run."""
    about = " ".join(str(__doc__).split("\n\n")[1].split())
    parser = argparse.ArgumentParser(prog="python -m scenarios.first_frame", description=about)
    parser.add_argument("--filter", default="*", metavar="GLOB", help="scenes whose name matches (default: all)")
    parser.add_argument("--preset", nargs="+", default=[GATED[1]], metavar="NAME", help=f"presets (default: {GATED[1]})")
    parser.add_argument("--frames", type=int, default=FRAMES, metavar="N", help=f"frames per scene (default: {FRAMES})")
    parser.add_argument("--alone", nargs=2, metavar=("SCENE", "PRESET"), help=argparse.SUPPRESS)
    chosen = parser.parse_args(argv)
    found: list[Found] = []
    lost: list[str] = []
    try:
        if chosen.frames < 2:
            raise InvalidInput("--frames", chosen.frames, "2 at least")
        if chosen.alone:
            scene, preset = chosen.alone
            here = measured(scene, preset, chosen.frames)
            print(json.dumps(here and asdict(here)))
            return 0
        names = filtered(catalog.scenarios(), chosen.filter)
        if not names:
            raise InvalidInput("--filter", chosen.filter, "patterns that match scenes; `python -m scenarios list` names them")
        for preset in chosen.preset:
            for name in names:
                one = alone(name, preset, chosen.frames)
                said = one if isinstance(one, str) else f"{one.times:.1f} medians"
                print(f"{name} {preset}: {said}", file=sys.stderr, flush=True)
                if isinstance(one, Found):
                    found.append(one)
                elif one != REFUSED:
                    lost.append(name)
    except AvatarsimError as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    bad = [one for one in found if not one.good]
    print(table(found))
    own = sum(one.good and one.long for one in found)
    print(f"\n{len(found)} scenes; in {len(bad)} the first frame loads something, or takes more than {MOST_TIMES:g} medians")
    print(f"because of what `load` left; in {own} more it takes that long by its own work")
    if lost:
        print(f"{len(lost)} could not be run: {', '.join(lost)}")
    return 1 if bad else 3 if lost else 0


if __name__ == "__main__":
    sys.exit(ended(main))
