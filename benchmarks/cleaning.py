"""Recorded human clips of pybullet_data made free of overlap, as they were recorded, on a floor and in the gallery.

Overlap of the input and of the output is judged independently of the engine, in all frames and at ten equal steps between them.
The table of docs/cleaning.md has these figures. Kernels should be compiled already (`python -m avatarsim`).
"""

import argparse
import sys
import time
from dataclasses import dataclass
from math import nan
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.model import Model
from avatarsim.cleaning import Cleaned, Options, clean
from avatarsim.cleaning.result import OVERLAP
from avatarsim.errors import UnknownName
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import poses_of_links
from benchmarks.growth_scenes import ground
from benchmarks.output import print_rows, write_rows
from reference.judging.judge import Judge
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.gallery import gallery
from scenarios.catalog.recorded.mocap_clips import PLAYED, Played
from scenarios.motion.mocap import load_clip, placed
from scenarios.motion.track import track_of

Array = NDArray[np.float64]

ROOMS = ("floor", "gallery")
STEPS = 10
"""Equal steps between frames at which the judge looks as well."""
EXCESS = 1e-9
"""[rad] beyond a limit that rounding may leave."""
MAX_JERK = 1.5
"""Largest jerk where the input was free, in multiples of the input's there."""


@dataclass(frozen=True)
class Row:
    """One clip in one room. Before: frames that overlap, the deepest [mm], motions between frames without proof, largest excess
    beyond limits [rad]; after: frames and steps between frames that overlap, and the same. Jerk where the input was free and
    elsewhere, in multiples of the input's; free frames of the input, and of them those that changed; 95th percentile of the
    link that was moved most [mm]; clip-seconds per second of one core; promises that are broken."""

    clip: str
    room: str
    seconds: float
    frames: int
    overlap: int
    deepest_mm: float
    unproved: int
    excess_rad: float
    overlap_after: int
    overlap_between: int
    unproved_after: int
    excess_after_rad: float
    jerk_free: float
    jerk_held: float
    free: int
    free_changed: int
    moved_mm: float
    speed: float
    broken: str = ""


def motion_of(played: Played) -> Motion:
    """Return the clip at its own rate, at its place in the gallery."""
    clip = placed(load_clip(played.clip), played.x, played.y, float(np.radians(played.heading)))
    track = track_of(clip, humanoid())
    return Motion(clip.times, track.positions, track.rotations, track.angles)


def depths(judge: Judge, motion: Motion) -> Array:
    """Return (F,) deepest overlap [m] of each posture, by the judge."""
    scene = judge.scene
    links, turns = poses_of_links(scene.avatars, motion.positions, motion.rotations, motion.angles)
    at = np.array([body.position for body in scene.bodies]).reshape(-1, 3)
    turned = np.array([body.orientation for body in scene.bodies]).reshape(-1, 4)
    return judge.depths(
        np.concatenate([np.broadcast_to(at, (len(motion), *at.shape)), links], axis=1),
        np.concatenate([np.broadcast_to(turned, (len(motion), *turned.shape)), turns], axis=1),
    )


def between(motion: Motion) -> Motion:
    """Return the inner ones of STEPS equal steps from each frame to the next."""
    samples = [motion.between(k, n / STEPS) for k in range(len(motion) - 1) for n in range(1, STEPS)]
    arrays = ([getattr(sample, name) for sample in samples] for name in ("time", "positions", "rotations", "angles"))
    return Motion(*(np.array(array) for array in arrays))


def row(played: Played, room: str, options: Options) -> Row:
    """Clean one clip in one room, and judge it."""
    motion, human = motion_of(played), humanoid()
    bodies = (ground(40.0),) if room == "floor" else gallery()
    begun = time.process_time()
    cleaned = clean(motion, Model(human, None, (), ()), bodies, options)
    return judged(played.clip, room, motion, cleaned, Judge(Scene("cleaned", bodies, (human,))), time.process_time() - begun)


def judged(clip: str, room: str, motion: Motion, cleaned: Cleaned, judge: Judge, seconds: float) -> Row:
    """Return the figures of one clip that took `seconds` to clean."""
    before, after, free, duration = cleaned.before, cleaned.after, ~cleaned.held, float(motion.times[-1] - motion.times[0])
    depth, left, inside = (depths(judge, one) for one in (motion, cleaned.motion, between(cleaned.motion)))
    overlaps, stay, come = (int(np.sum(~(one <= OVERLAP))) for one in (depth, left, inside))
    jerk, held = ratio(after.jerk_free, before.jerk_free), ratio(after.jerk_held, before.jerk_held)
    broken = {
        "overlap in a frame": stay + after.overlapping, "overlap between frames": come,
        "a motion without proof": after.unproven, "limits": not after.limit_excess <= EXCESS, "jerk": jerk > MAX_JERK,
    }
    return Row(
        clip, room, duration, before.frames, overlaps, 1e3 * float(depth.max()), before.unproven, before.limit_excess, stay,
        come, after.unproven, after.limit_excess, jerk, held, int(free.sum()), int(np.sum(free & cleaned.changed)),
        1e3 * float(cleaned.moved.link_p95.max()), duration / seconds, "; ".join(name for name in broken if broken[name]),
    )


def ratio(after: float, before: float) -> float:
    """Return the ratio of two figures: 1 where they are equal, nan where the first was 0."""
    return 1.0 if after == before else after / before if before > 0.0 else nan


def run(arguments: argparse.Namespace, folder: Path) -> int:
    """Clean, write, print. 1: a promise is broken. Raises UnknownName for a clip or room that is not there."""
    clips = {played.clip: played for played in PLAYED}
    names = arguments.clips or (["walk"] if arguments.quick else list(clips))
    rooms = arguments.rooms or (["floor"] if arguments.quick else ROOMS)
    for kind, given, known in (("clip", names, clips), ("room", rooms, ROOMS)):
        for name in given:
            if name not in known:
                raise UnknownName(kind, name, known)
    options = Options(margin=arguments.margin, blend=arguments.blend, opinion=False)
    # the first call loads kernels
    row(clips[names[0]], rooms[0], options)
    rows = []
    for room in rooms:
        for name in names:
            rows.append(row(clips[name], room, options))
            print(f"cleaning  {name} in {room}", file=sys.stderr, flush=True)
    print_rows("recorded clips made free of overlap", rows)
    write_rows(folder / "cleaning.csv", rows, Row)
    return 1 if any(one.broken for one in rows) else 0
