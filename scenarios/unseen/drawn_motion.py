"""A motion drawn by seed: recorded clips cut, mirrored, layered and time-warped, chained by cross-fades and led to and fro."""

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.motions.deepmimic import Clip
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.tracker import TrackerSample, poses_of_links
from scenarios.building.reach import reach
from scenarios.motion.mocap import clip_names, load_clip, placed, repeated, retimed
from scenarios.motion.track import LEAD_IN, Track, track_of
from scenarios.scenario import RENDERED
from scenarios.unseen.clips import cut, faded, heading, layered, mirrored, warped

Array = NDArray[np.float64]
Corner = tuple[float, float]
"""x and y [m]."""

SHORTEST, LONGEST, FADE = 60, 150, 36
"""Postures of a piece of a clip before its time is warped, one to two and a half seconds, and of a cross-fade: enough to lie
down from standing at 1.5 m/s."""
STEER, GOES, SWAY = 1.6, 0.3, 0.5
"""Largest turn [rad] of one piece against the one before, as fast as a human turns about; way [m] from which a piece can be
steered; largest turn of others [rad]."""
MIRRORED, LAYERED = 0.5, 0.4
"""Shares of the pieces that are mirrored, and that get the upper body of another clip."""
FASTEST, ROUNDS = 8.0, 8
"""Speed [m/s] of a link origin above which time is stretched, and how often at most: between two postures a link moves on an
arc, which only the postures in between show."""
TRIES, BESIDE = 4, 0.5
"""Pieces that are drawn until one ends inside the room's rectangle, or at most BESIDE [m] out of it: a run goes 3 m a second."""
SINKS = (-0.05, 0.03)
"""Height [m] of the lowest points (their 5th percentile) over the floor: users are taller or smaller than their avatars."""
OFF_START, OFF_HEADING = 0.3, 1.0
"""Distance [m] of the first piece from the start, and its turn [rad]."""
LED_IN = 2.0
"""Largest speed [m/s] of a link origin on the way from the start posture into the motion, were that way straight."""
EVERY = 10
"""Postures for each lowest point: a percentile needs no more, and each takes three milliseconds."""


@cache
def pool() -> tuple[Clip, ...]:
    """Return all recorded clips at the steps of a rendered frame; those that wrap long enough for any piece."""
    clips = []
    for name in clip_names():
        clip = load_clip(name)
        rounds = int(np.ceil(LONGEST * RENDERED / clip.times[-1])) if clip.wraps else 1
        clips.append(retimed(repeated(clip, rounds) if rounds > 1 else clip))
    return tuple(clips)


def piece(random: np.random.Generator) -> Clip:
    """Return one piece of a recorded clip, perhaps mirrored and under another upper body, its time warped."""

    def random_part() -> Clip:
        clip = pool()[random.integers(len(pool()))]
        count = int(random.integers(SHORTEST, LONGEST + 1))
        part = cut(clip, int(random.integers(max(1, len(clip.times) - count + 1))), count)
        return mirrored(part) if random.random() < MIRRORED else part

    part = random_part()
    return warped(layered(random_part(), part) if random.random() < LAYERED else part, random)


def steered(before: Clip, after: Clip, aim: Array, random: np.random.Generator) -> float:
    """Return the angle [rad] of the turn of `after` at its join so that its way leads towards `aim` (2,) [m]; at most STEER."""
    begins = max(len(before.times) - FADE, 0)
    way = (after.root_positions[-1] - after.root_positions[0])[:2]
    if not np.hypot(*way) > GOES:
        return float(random.uniform(-SWAY, SWAY))
    wanted = aim - before.root_positions[begins, :2]
    goes = np.arctan2(way[1], way[0]) + heading(before, begins) - heading(after, 0)
    turn = np.arctan2(wanted[1], wanted[0]) - goes
    return float(np.clip((turn + np.pi) % (2.0 * np.pi) - np.pi, -STEER, STEER))


def chained(random: np.random.Generator, frames: int, first: tuple[float, float, float], low: Corner, high: Corner) -> Clip:
    """Return pieces, one fading into the next, `frames` postures at least. They begin at `first` (x, y [m], heading [rad]); each
    is steered towards a place drawn between `low` and `high`, and drawn again where it would end far outside."""
    clip = piece(random)
    clip = placed(clip, first[0], first[1], first[2] - heading(clip, 0))
    while len(clip.times) < frames:
        aim, nearest, least = random.uniform(low, high), clip, np.inf
        for _ in range(TRIES):
            after = piece(random)
            longer = faded(clip, after, FADE, steered(clip, after, aim, random))
            end = longer.root_positions[-1, :2]
            outside = float(np.linalg.norm(end - np.clip(end, low, high)))
            if outside < least:
                nearest, least = longer, outside
            if outside <= BESIDE:
                break
        clip = nearest
    return clip


def origins(avatar: Avatar, track: Track) -> Array:
    """Return (F, links, 3) link origins [m] of a track."""
    return poses_of_links((avatar,), track.positions, track.rotations, track.angles)[0]


def slowed(clip: Clip, avatar: Avatar) -> Clip:
    """Return the clip with time stretched where a link origin would be faster than FASTEST."""
    for _ in range(ROUNDS):
        way = np.linalg.norm(np.diff(origins(avatar, track_of(clip, avatar)), axis=0), axis=-1).max(axis=1)
        if (way <= FASTEST * RENDERED).all():
            break
        steps = np.maximum(RENDERED, way / FASTEST)
        clip = retimed(replace(clip, times=np.concatenate([[0.0], np.cumsum(steps)])))
    return clip


def drawn_motion(
    avatar: Avatar, start: TrackerSample, facing: float, low: Corner, high: Corner, frames: int, random: np.random.Generator,
) -> Track:
    """Return `frames` postures of the humanoid `avatar` from its free posture `start`, which faces `facing` [rad], its ways
    within the rectangle from `low` to `high` [m] or near it."""
    x, y = start.positions[0, :2] + random.uniform(-OFF_START, OFF_START, 2)
    first = float(x), float(y), facing + float(random.uniform(-OFF_HEADING, OFF_HEADING))
    clip = cut(slowed(chained(random, frames, first, low, high), avatar), 0, frames)
    track = track_of(clip, avatar)
    lowest = -reach((avatar,), [track.posture(k) for k in range(0, len(track), EVERY)], (0.0, 0.0, -1.0))
    track.positions[:, 0, 2] += random.uniform(*SINKS) - np.percentile(lowest, 5.0)
    begins = origins(avatar, track)[0]
    stands = poses_of_links((avatar,), start.positions, start.rotations, start.angles)[0]
    # a smooth step is half as fast again in its middle as on average
    led = int(np.ceil(1.5 * np.linalg.norm(begins - stands, axis=-1).max() / (LED_IN * RENDERED)))
    whole = track.led_in(start, max(LEAD_IN, led))
    return Track(whole.positions[:frames], whole.rotations[:frames], whole.angles[:frames])
