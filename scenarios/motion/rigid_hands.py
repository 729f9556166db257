"""Motions given by time: users of rigid hands, and bodies that move by themselves."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.moving import Pose, with_moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.motion.keyframes import minimum_jerk, through
from scenarios.scenario import RENDERED, Motion

Places = Callable[[float], Sequence[Vector]]
"""Origins of all hands [m] at a time [s]."""


def hands_at(places: Sequence[Vector], time: float = 0.0) -> TrackerSample:
    """Return the sample of hands that are there, upright."""
    return TrackerSample(time, np.array(places), np.tile(rotation.IDENTITY, (len(places), 1)), np.zeros(0))


def turned_hand(place: Vector, yaw: float, time: float = 0.0) -> TrackerSample:
    """Return the sample of one hand that is turned by `yaw` [rad] about the vertical."""
    return TrackerSample(time, np.array([place]), rotation.from_axis_angle((0.0, 0.0, 1.0), yaw)[None], np.zeros(0))


def by_time(at: Callable[[float], TrackerSample], dt: float = RENDERED) -> Callable[[Scene, int], Motion]:
    """Return the motion whose samples, one per frame of `dt` [s], are those of `at`; it is equal for all seeds."""
    return lambda scene, seed: lambda frame: at((frame + 1) * dt)


def led(places: Places) -> Callable[[Scene, int], Motion]:
    """Return the motion of hands that are where `places` has them at every time."""
    return by_time(lambda time: hands_at(places(time), time))


def given(poses: Callable[[float], Mapping[str, Pose]]) -> Callable[[Scene, int], Motion]:
    """Return the motion of moving bodies that follow `poses` by time [s], while hands stay where they begin."""

    def motion(scene: Scene, seed: int) -> Motion:
        start = scene.first_sample
        return by_time(lambda time: with_moving(scene.avatars, replace(start, time=time), poses(time), start))(scene, seed)

    return motion


def keyed(keys: Sequence[tuple[float, TrackerSample]], frames: int) -> Callable[[Scene, int], Motion]:
    """Return the motion from the scene's start through `keys`, each a time [s] and the sample reached by then."""
    return lambda scene, seed: through(scene.first_sample, keys, frames).motion()


def led_through(keys: Sequence[tuple[float, Vector]], frames: int) -> Callable[[Scene, int], Motion]:
    """Return the motion of one hand through `keys`, each a time [s] and the place [m] reached by then."""
    return keyed([(time, hands_at((place,))) for time, place in keys], frames)


def about_z(angle: float) -> Quaternion:
    """Return the rotation by an angle [rad] about the vertical."""
    return float(np.cos(0.5 * angle)), 0.0, 0.0, float(np.sin(0.5 * angle))


def eased(time: float, begin: float, end: float) -> float:
    """Return the share gone at `time` of a way from rest to rest between the times `begin` and `end` [s]: minimum jerk."""
    return float(minimum_jerk(np.clip([(time - begin) / (end - begin)], 0.0, 1.0))[0])
