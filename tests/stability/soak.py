"""Soak test: one engine through a million frames of the same minutes again; memory stays flat, frames do not get slower.

`python -m tests.stability.soak --frames 1000000`. A humanoid turns, bends and leans against the furniture of a closed room, and a
palm of another user stirs loose balls in a bin: postures, contacts, impacts, islands that fall asleep and wake. Time is
held against a second engine, loaded anew for every sample, whose frames take turns with the old one's: a slower machine slows
both, and only the growth of the old one is left.
"""

import argparse
import gc
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from avatarsim.engine import FrameRecord, Settings
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.joint import Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation
from reference.judging.judge import Judge
from tests.progress_bar import told
from tests.stability.hostile import DT, furniture, hinged_avatar, walls

PERIOD = 1200
"""Frames after which the user does the same again: 20 s."""
SAMPLES = 100
"""Number of samples of memory and times. A sample is one period, with one of a fresh engine that has had one before."""
SETTLED = 0.05
"""Share of the run after which memory must be flat: by then every table has grown to the size that the scene needs."""
MOST_GROWTH = 5.0
"""[MB] that the process may grow by from then on."""
MOST_DRIFT = 0.05
"""Share by which the median frame may get slower, against a fresh engine's, from the first tenth of samples to the last."""
DEEPEST = 1e-6
"""[m] overlap of a state shown, as the engine promises."""
BIN = (-1.0, 0.6, 0.6)
"""[m] middle of the bin's floor."""

Make = Callable[[], AvatarsimEngine]


def scene() -> Scene:
    """Return the room with its furniture, an avatar of 16 hulls, a bin with eight balls and a palm over it."""
    palm = (Piece(Box((0.10, 0.10, 0.03))),)
    avatars = hinged_avatar(), rigid_avatar("palm", palm, solid(palm, 0.5))
    posture = rest(avatars)
    positions = posture.positions.copy()
    positions[0], positions[-1] = (-0.7, -0.2, 1.06), (BIN[0], BIN[1], BIN[2] + 0.5)
    bodies = (*walls(), *furniture(), bin_of_boards(), *balls())
    return Scene("soak", bodies, avatars, start=replace(posture, positions=positions))


def bin_of_boards() -> Body:
    """Return an open box of 0.5 m, 0.35 m deep: one body of a floor and four sides."""
    sides = [Piece(Box((0.02, 0.54, 0.35)), (s * 0.26, 0.0, 0.165)) for s in (1.0, -1.0)]
    sides += [Piece(Box((0.54, 0.02, 0.35)), (0.0, s * 0.26, 0.165)) for s in (1.0, -1.0)]
    return fixed("bin", (Piece(Box((0.54, 0.54, 0.02))), *sides), "wood", BIN)


def balls() -> tuple[Body, ...]:
    """Return eight balls of 9 cm side by side on the bin's floor."""
    ball = (Piece(Sphere(0.045)),)
    places = [(BIN[0] + x, BIN[1] + y, BIN[2] + 0.0563) for x in (-0.16, -0.05, 0.05, 0.16) for y in (-0.1, 0.1)]
    return tuple(simulated(f"ball_{k}", ball, "wood", solid(ball, 0.15), place) for k, place in enumerate(places))


def motion(of: Scene) -> list[TrackerSample]:
    """Return one period of the user's motion: it begins and ends in the same posture."""
    start = of.first_sample
    hinges = [hinge for link in of.links if isinstance(link.joint, Hinges) for hinge in link.joint.hinges]
    middle = np.array([0.5 * (hinge.lower + hinge.upper) for hinge in hinges])
    wide = np.array([0.5 * (hinge.upper - hinge.lower) for hinge in hinges])
    # whole numbers of swings in a period, another one for each hinge
    swings, begin = 1 + np.arange(len(hinges)) % 7, np.arcsin(np.clip((start.angles - middle) / wide, -1.0, 1.0))
    found = []
    for k in range(PERIOD):
        u = 2.0 * np.pi * k / PERIOD
        positions, rotations = start.positions.copy(), start.rotations.copy()
        # through panel, sofa and table, never out of the room
        positions[0] += (0.9 * (1.0 - np.cos(u)), 0.5 * np.sin(2.0 * u), 0.05 * np.sin(5.0 * u))
        rotations[0] = rotation.from_axis_angle((0.0, 0.0, 1.0), np.pi * np.sin(u))
        positions[-1] += (0.19 * np.sin(3.0 * u), 0.19 * np.sin(4.0 * u), -0.22 * (1.0 - np.cos(2.0 * u)))
        found.append(TrackerSample(0.0, positions, rotations, middle + wide * np.sin(begin + swings * u)))
    return found


@dataclass
class Report:
    """Measurements: times [ns] of all frames, per sample the median of the old engine's over the fresh one's, resident
    memory [bytes], overlap [m]."""

    times: np.ndarray
    ratios: list[float] = field(default_factory=list)
    resident: list[int] = field(default_factory=list)
    overlap: list[float] = field(default_factory=list)
    frames: int = 0
    worst_counts: dict[str, int] = field(default_factory=dict)

    @property
    def growth(self) -> float:
        """[MB] from where memory has settled to the most of all later samples."""
        settled = min(int(SETTLED * len(self.resident)), len(self.resident) - 1)
        return (max(self.resident[settled:]) - self.resident[settled]) / 1e6

    @property
    def drift(self) -> float:
        """By which share the median frame is slower at the end, against that of a fresh engine."""
        tenth = max(1, len(self.ratios) // 10)
        return float(np.median(self.ratios[-tenth:]) / np.median(self.ratios[:tenth]) - 1.0)

    @property
    def deepest(self) -> float:
        """[m] largest overlap that the judge found."""
        return max(self.overlap, default=0.0)

    def figures(self) -> dict[str, tuple[float, float]]:
        """Return each promised figure and the most that it may be."""
        return {
            "growth [MB]": (self.growth, MOST_GROWTH), "drift of the median frame": (self.drift, MOST_DRIFT),
            "overlap [m]": (self.deepest, DEEPEST),
        }

    def faults(self) -> list[str]:
        """Return names of the figures that are too large, or no numbers."""
        return [name for name, (value, most) in self.figures().items() if not value <= most]

    def text(self) -> str:
        """Return a line for every figure."""
        times = self.times[: self.frames] / 1e3
        worst, (p50, p99) = int(np.argmax(times)), np.percentile(times, [50.0, 99.0])
        return "\n".join([
            f"{self.frames} frames, {len(self.resident)} samples; median {p50:.1f} us, p99 {p99:.1f} us",
            f"worst frame: {times[worst]:.1f} us, number {worst % PERIOD} of its period, {self.worst_counts}",
            *(f"{name}: {value:.3g}, at most {most:g}" for name, (value, most) in self.figures().items()),
        ])


def resident() -> int:
    """Return bytes of this process that are in memory, once unused objects were given back."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * resource.getpagesize()


def soak(frames: int, make: Make = AvatarsimEngine, samples: int = SAMPLES, progress: bool = False) -> Report:
    """Run `frames` frames at least, in whole periods; at even distances a sample of times and memory."""
    of = scene()
    moves, judge, old = motion(of), Judge(of), make()
    old.load(of, Settings(), DT)
    periods = max(2, -(-frames // PERIOD))
    sampled = {round(k) for k in np.linspace(1, periods - 1, min(samples, periods - 1))}
    # touched now, or the pages of later frames would count as growth
    report = Report(np.full(periods * PERIOD, 1, dtype=np.int64))
    worst = 0
    for period in told(range(periods), periods, "period") if progress else range(periods):
        fresh = prepared(make, of, moves) if period in sampled else None
        young = np.zeros(PERIOD)
        for k, sample in enumerate(moves):
            if fresh is not None:
                young[k], _ = timed(fresh, sample)
            took, record = timed(old, sample)
            report.times[report.frames] = took
            report.frames += 1
            if took > worst:
                worst, report.worst_counts = took, {**record.counts, **record.statuses}
        if fresh is not None:
            fresh.close()
            fresh = None
            report.ratios.append(float(np.median(report.times[report.frames - PERIOD : report.frames]) / np.median(young)))
            shown = record.shown
            report.overlap.append(judge.overlaps(shown.positions, shown.orientations).deepest)
            report.resident.append(resident())
    return report


def prepared(make: Make, of: Scene, moves: list[TrackerSample]) -> AvatarsimEngine:
    """Return a fresh engine that has been through one period, as the old one has: balls are stirred, tables have grown."""
    engine = make()
    engine.load(of, Settings(), DT)
    for sample in moves:
        engine.advance(sample, DT)
    return engine


def timed(engine: AvatarsimEngine, sample: TrackerSample) -> tuple[int, FrameRecord]:
    """Return one frame and the time [ns] that it took."""
    begun = time.perf_counter_ns()
    record = engine.advance(sample, DT)
    return time.perf_counter_ns() - begun, record


def main(words: list[str] | None = None) -> int:
    """Return 0 if memory is flat, frames are as fast as at first and nothing overlaps; 1 otherwise."""
    options = argparse.ArgumentParser(prog="python -m tests.stability.soak", description="One engine through very many frames.")
    options.add_argument("--frames", type=int, default=1_000_000, metavar="N", help="frames (default 1000000)")
    asked = options.parse_args(words)
    report = soak(asked.frames, progress=True)
    print(report.text())
    return int(bool(report.faults()))


if __name__ == "__main__":
    sys.exit(main())
