"""Scripted human motion: postures at given times, and between them the minimum-jerk profile of point-to-point movements."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.motion.track import Track
from scenarios.scenario import RENDERED, Motion

Array = NDArray[np.float64]
Draw = Callable[[np.random.Generator], TrackerSample]
"""A posture that is a little different each time."""
Pose = Callable[..., TrackerSample]
"""`posed` of one avatar from one posture."""
Key = tuple[float, TrackerSample]
"""A time [s] after the start and the posture reached by then."""


def minimum_jerk(u: Array) -> Array:
    """Return share of the way at share `u` of the time: rest to rest without a jump in acceleration (Flash and Hogan 1985)."""
    return u**3 * (10.0 - 15.0 * u + 6.0 * u * u)


def posed(
    avatar: Avatar, base: TrackerSample, turned: Mapping[str, Vector] | None = None,
    bent: Mapping[str, tuple[float, ...]] | None = None, moved: Vector = (0.0, 0.0, 0.0),
) -> TrackerSample:
    """Return `base`, the posture of one avatar, with some joints set and the root moved by `moved` [m].

    `turned`: link -> rotation vector [degrees] of a ball or free joint; `bent`: link -> its hinge angles [degrees].
    """
    positions, rotations, angles = base.positions.copy(), base.rotations.copy(), base.angles.copy()
    positions[0] += moved
    turned, bent = dict(turned or {}), dict(bent or {})
    first = 0
    for k, link in enumerate(avatar.links):
        if link.name in turned:
            rotations[k] = rotation.from_rotation_vector(np.radians(turned.pop(link.name)))
        if isinstance(link.joint, Hinges):
            count = len(link.joint.hinges)
            if link.name in bent:
                angles[first : first + count] = np.radians(bent.pop(link.name))
            first += count
    for name in [*turned, *bent]:
        raise UnknownName(f"joint of avatar {avatar.name}", name, (link.name for link in avatar.links))
    return TrackerSample(base.time, positions, rotations, angles)


def through(start: TrackerSample, keys: Sequence[Key], frames: int) -> Track:
    """Return `frames` postures, one per rendered frame, from `start` at time 0 through all keys; then the user rests."""
    times = np.array([0.0, *(time for time, _ in keys)])
    if not (np.diff(times) > 0.0).all():
        raise InvalidInput("times of the keys [s]", times[1:].tolist(), "rising, above 0")
    samples = [start, *(sample for _, sample in keys)]
    now = np.arange(1, frames + 1) * RENDERED
    after = np.clip(np.searchsorted(times, now), 1, len(times) - 1)
    u = minimum_jerk(np.clip((now - times[after - 1]) / (times[after] - times[after - 1]), 0.0, 1.0))

    def ends(field: str) -> tuple[Array, Array]:
        values = np.array([getattr(sample, field) for sample in samples])
        return values[after - 1], values[after]

    (p, p_to), (q, q_to), (a, a_to) = ends("positions"), ends("rotations"), ends("angles")
    return Track(
        p + u[:, None, None] * (p_to - p),
        rotation.slerp(q, q_to, np.tile(u[:, None], q.shape[1])),
        a + u[:, None] * (a_to - a),
    )


def again_and_again(start: TrackerSample, ready: Draw, push: Draw, frames: int, seed: int) -> Track:
    """Return cycles of getting ready, pushing, holding and letting go, never twice the same: Figure 8's spikes.

    Half a second to a push and back, as humans reach; holds and rests are shorter. A longer track begins as a shorter one.
    """
    random = np.random.default_rng(seed)
    keys: list[Key] = []
    time = 0.0
    while time < frames * RENDERED:
        pushed, ready_again = push(random), ready(random)
        for sample, least, most in ((pushed, 0.45, 0.7), (pushed, 0.1, 0.4), (ready_again, 0.4, 0.6), (ready_again, 0.05, 0.3)):
            time += random.uniform(least, most)
            keys.append((time, sample))
    return through(start, keys, frames)


def pushes(
    ready: Callable[[Pose, np.random.Generator], TrackerSample], push: Callable[[Pose, np.random.Generator], TrackerSample],
    frames: int,
) -> Callable[[Scene, int], Motion]:
    """Return the motion of `again_and_again` for a scene's first avatar; both postures are `posed` from the scene's start."""

    def motion(scene: Scene, seed: int) -> Motion:
        start = scene.first_sample
        pose = partial(posed, scene.avatars[0], start)
        return again_and_again(start, partial(ready, pose), partial(push, pose), frames, seed).motion()

    return motion
