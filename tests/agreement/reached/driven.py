"""Avatars that are led into something, frame after frame, and how deep they are then."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import Engine, Settings
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from reference.judging.judge import Judge
from scenarios.measure.posture.limits import joint_limit_excess

Array = NDArray[np.float64]

FRAME = 1.0 / 60.0
MM = 1e-3


@dataclass(frozen=True)
class Led:
    """By frame: the largest depth (F,) of a link in a body [m], where links are (F, links, 3) [m] and how far they are turned
    (F, links, 4), and the largest excess (F,) over the limits of a joint [deg]."""

    depths: Array
    places: Array
    turns: Array
    excess: Array


def led(engine: Engine, scene: Scene, path: Callable[[int], TrackerSample], frames: int, options: dict[str, object],
        preset: str = "tuned") -> Led:
    """Follow `path` from its first sample on."""
    engine.load(scene, Settings(preset, options), FRAME)
    records = [engine.advance(path(frame), FRAME) for frame in range(1, frames + 1)]
    engine.close()
    places = np.array([record.shown.positions for record in records])
    turns = np.array([record.shown.orientations for record in records])
    bodies, first = {body.name for body in scene.bodies}, len(scene.bodies)
    depths = [
        max((depth for a, b, depth in verdict.pairs if a in bodies or b in bodies), default=0.0)
        for verdict in Judge(scene).each(places, turns)
    ]
    angles = np.array([record.angles for record in records])
    excess = np.degrees(joint_limit_excess(scene, turns[:, first:], angles))
    return Led(np.array(depths), places[:, first:], turns[:, first:], excess)


def eased(share: float) -> float:
    """Minimum jerk from 0 to 1."""
    u = min(1.0, max(0.0, share))
    return u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
