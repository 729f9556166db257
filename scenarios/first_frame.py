"""`python -m scenarios.first_frame [--filter GLOB] [--preset NAME ...] [--frames N]`.

Times the first frame after `load` against the median frame, each scene in a process of its own. A first frame of more than 10
medians is a fault, and so is a kernel that is brought into memory after `load`.

Beside them stand what the first frame takes by its own work, in a second engine loaded in the same process, and the median of the
frames in which a simulated body moves: most frames of a scene in which all comes to rest only see that all sleeps.

Kernels should be compiled already (`python -m avatarsim`): the first process would compile them, within `load`.
"""

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median

import numpy as np

from avatarsim.console import ended
from avatarsim.errors import AvatarsimError, InvalidInput, StartOverlaps
from avatarsim.jit.linking import CalledKernel
from avatarsim.scene.scene import Scene
from runfiles.naming import GATED
from scenarios import catalog
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.running.asked import asked
from scenarios.running.offered import filtered

MOST_TIMES = 10.0
"""Longest first frame, in multiples of the median frame."""
OWN_SHARE = 0.5
"""Least share of a first frame of more than MOST_TIMES medians that is called its own work. Below this most of it is something
that `load` left."""
ENGINES = 3
"""Further engines loaded in the same process; the least of their first frames counts."""
FRAMES = 600
"""Frames run per scene, or as many as it has: the median is that of ten seconds."""
TRIES = 3
"""Processes asked about a scene before its first frame counts as too long; what is left to load is left in each, a disturbance by
the rest of the machine is not."""
REFUSED = "refused, as it overlaps at the start"
"""What is said of a scene without a first frame."""
SLOW = 1000.0
"""[us] First frames above this are counted: a fifteenth of a frame at 60 Hz."""
CLOCKED = 100
"""Calls of the clock before the first frame, which shall not pay for the clock's own first call."""
WORK_SAID = ("impacts", "resting_solves", "impact_searches", "contacts", "queries", "iterations")
"""Counts of a first frame that are said beside its time, with their medians in brackets."""


@dataclass(frozen=True)
class Found:
    """One scene in one process: times of `load` [s]; of the first frame, of that of further engines, of the median frame, and of
    the median frame in which a simulated body moves (of all frames where there is none) [us]; the share of the other frames;
    kernels that frames loaded; what the first frame counted, and the median one."""

    scene: str
    preset: str
    load: float
    first: float
    own: float
    median: float
    awake: float
    asleep: float
    late: int
    counted: str = ""

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
        """Whether the first frame is as short as it should be, and loads nothing."""
        return self.late == 0 and not self.long

    @property
    def reason(self) -> str:
        """Why it is not good; empty if it is."""
        if self.late:
            return f"{self.late} kernels loaded by frames"
        if not self.long:
            return ""
        if not self.own >= OWN_SHARE * self.first:
            return "left by load: a second engine takes less than half as long"
        beside = f"; {100.0 * self.asleep:.0f} % of the frames sleep" if self.asleep > 0.0 else ""
        return f"its own work: {self.counted}{beside}"


def sleeps(scene: Scene, counts: Mapping[str, int]) -> bool:
    """Whether no simulated body moved in a frame although there are some."""
    return scene.effects.dynamics and counts["segments"] == 0


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
    spent, counts = np.zeros(len(samples), np.int64), list[Mapping[str, int]]()
    for _ in range(CLOCKED):
        clock()
    for k, sample in enumerate(samples):
        begun = clock()
        record = engine.advance(sample, dt)
        spent[k] = clock() - begun
        counts.append(record.counts)
    made, own = CalledKernel.made - made, []
    for _ in range(ENGINES):
        other = opened(job.engine)
        other.load(what.scene, job.settings(other), dt)
        begun = clock()
        other.advance(samples[0], dt)
        own.append(clock() - begun)
        other.close()
    engine.close()
    asleep = np.array([sleeps(what.scene, frame) for frame in counts])
    counted = ", ".join(
        f"{name} {counts[0][name]} ({median([frame[name] for frame in counts]):g})"
        for name in WORK_SAID if counts[0].get(name, 0)
    )
    us = 1e-3 * spent
    # where all sleep from the first frame on, no median stands beside the other
    awake = float(np.median(us if asleep.all() else us[~asleep]))
    share, least = float(asleep.mean()), min(own) * 1e-3
    return Found(scene, preset, load, float(us[0]), least, float(np.median(us)), awake, share, made, counted)


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
    """Every scene, the worst first, a line each."""
    worst = sorted(found, key=lambda one: (-one.late, -one.times))
    heads = f"{'frame 1 us':>11} {'median us':>10} {'times':>6} {'2nd engine':>11} {'awake us':>9} {'asleep':>7} {'late':>5}"
    lines = [f"{'scene':<32} {'preset':<8} {'load s':>7} {heads}  counts of frame 1 (of the median)"]
    for one in worst:
        times = f"{one.first:11.1f} {one.median:10.1f} {one.times:6.1f} {one.own:11.1f} {one.awake:9.1f}"
        figures = f"{times} {one.asleep:7.0%} {one.late:5d}"
        lines.append(f"{one.scene:<32} {one.preset:<8} {one.load:7.2f} {figures}  {one.counted}")
    return "\n".join(lines)


def summary(found: Sequence[Found]) -> str:
    """What is wrong and why, and the longest first frame."""
    bad = [one for one in found if not one.good]
    lines = [f"{len(found)} scenes; in {len(bad)} the first frame takes more than {MOST_TIMES:g} medians, or loads something"]
    for one in sorted(bad, key=lambda one: (-one.late, -one.times)):
        awake = f"{one.first / one.awake:.1f} of frames awake"
        lines.append(f"  {one.scene} {one.preset}: {one.times:.1f} medians, {awake}; {one.reason}")
    if found:
        worst, slow = max(found, key=lambda one: one.first), sum(one.first > SLOW for one in found)
        lines.append(f"longest first frame: {worst.first:.0f} us, {worst.scene} {worst.preset}; above {1e-3 * SLOW:g} ms: {slow}")
    return "\n".join(lines)


def main(argv: Sequence[str] | None = None) -> int:
    """Measure and print. 0: all first frames are short and load nothing; 1: some is not; 2: usage; 3: some could not run."""
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
                said = one if isinstance(one, str) else f"{one.first:.1f} us, {one.times:.1f} medians"
                print(f"{name} {preset}: {said}", file=sys.stderr, flush=True)
                if isinstance(one, Found):
                    found.append(one)
                elif one != REFUSED:
                    lost.append(name)
    except AvatarsimError as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
    print(table(found))
    print(f"\n{summary(found)}")
    if lost:
        print(f"{len(lost)} could not be run: {', '.join(lost)}")
    return 1 if any(not one.good for one in found) else 3 if lost else 0


if __name__ == "__main__":
    sys.exit(ended(main))
