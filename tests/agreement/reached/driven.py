"""Avatars that are driven into an obstacle frame by frame, and their depths."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from avatarsim.engine import Engine, Settings
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from reference.judging.judge import Judge
from tests.agreement.runs import Array, played, poses


@dataclass(frozen=True)
class Led:
    """By frame: the largest depth (F,) of a link in a body [m], and positions of links (F, links, 3) [m]."""

    depths: Array
    places: Array


def led(engine: Engine, scene: Scene, path: Callable[[int], TrackerSample], frames: int, options: dict[str, object]) -> Led:
    """Run the tuned preset along `path` from its first sample on."""
    samples = [path(frame) for frame in range(1, frames + 1)]
    records = played(engine, scene, samples, Settings("tuned", options))[1:]
    places, turns = poses(records)
    bodies, first = {body.name for body in scene.bodies}, len(scene.bodies)
    depths = [
        max((depth for a, b, depth in verdict.pairs if a in bodies or b in bodies), default=0.0)
        for verdict in Judge(scene).each(places, turns)
    ]
    return Led(np.array(depths), places[:, first:])
