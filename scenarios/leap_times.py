"""`python -m scenarios.leap_times [--leaps N] [--seed N]`.

Monte Carlo of the dearest frames: the user of a humanoid leaps to a place drawn in each of the rooms of the unseen motions, clear
of things or inside them, and the frame of the leap is timed, the least of three loads; once with ways searched in that frame
(`leap_search` as set) and once without (0).
"""

import argparse
import sys
import time
from collections.abc import Sequence

import numpy as np

from avatarsim.command_line import ended
from avatarsim.engine import Settings
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import PostureSettings
from avatarsim.spatial import rotation
from scenarios.engines import GATED, opened
from scenarios.scenario import RENDERED
from scenarios.unseen.rooms import ROOMS, Room

REPEATS = 3
"""Loads of the same leap; the least time counts, which is what the frame costs when nothing disturbs."""
LEAPS = 40
"""Leaps drawn per room."""
BEYOND = 1.0
"""How far [m] outside the rectangle of a room's ways a leap may end: behind its walls."""
CALM = 5
"""Frames at the start posture before the leap."""
MOVES = PostureSettings().steps * PostureSettings().move_cap
"""Way [m] that is no leap yet."""


def leapt(scene: Scene, room: Room, random: np.random.Generator) -> TrackerSample:
    """The start posture at another place and heading, farther off than the steps of a frame go."""
    start = scene.first_sample
    while True:
        place = random.uniform(np.subtract(room.low, BEYOND), np.add(room.high, BEYOND))
        if np.linalg.norm(place - start.positions[0, :2]) > MOVES:
            break
    positions, rotations = start.positions.copy(), start.rotations.copy()
    positions[0, :2] = place
    turn = rotation.from_axis_angle((0.0, 0.0, 1.0), float(random.uniform(-np.pi, np.pi)))
    rotations[0] = rotation.multiply(turn, rotations[0])
    return TrackerSample(start.time, positions, rotations, start.angles)


def spent(scene: Scene, sample: TrackerSample, searches: int) -> float:
    """Time [ms] of the frame of the leap to `sample`."""
    engine, settings, found = opened(GATED[0]), Settings(GATED[1], {"leap_search": searches}), []
    for _ in range(REPEATS):
        engine.load(scene, settings, RENDERED)
        for _ in range(CALM):
            engine.advance(scene.first_sample, RENDERED)
        begun = time.perf_counter_ns()
        engine.advance(sample, RENDERED)
        found.append(time.perf_counter_ns() - begun)
    engine.close()
    return min(found) * 1e-6


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print, room by room: median, 95th percentile and slowest of the frames [ms]."""
    parser = argparse.ArgumentParser(prog="python -m scenarios.leap_times", description=(__doc__ or "").partition("\n\n")[2])
    parser.add_argument("--leaps", type=int, default=LEAPS, metavar="N", help="leaps per room (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the places (default %(default)s)")
    chosen = parser.parse_args(arguments)
    for searches in (PostureSettings().leap_search, 0):
        for room in ROOMS:
            random, scene = np.random.default_rng([chosen.seed, *room.name.encode()]), room.build()
            times = [spent(scene, leapt(scene, room, random), searches) for _ in range(chosen.leaps)]
            middle, most, worst = np.percentile(times, [50.0, 95.0, 100.0])
            print(f"leap_search {searches}  {room.name:9} {middle:6.2f} {most:6.2f} {worst:6.2f} ms", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(ended(main))
