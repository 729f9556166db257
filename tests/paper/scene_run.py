"""A scene of the catalogue run by the engine, shared by the tests of the figures that show it."""

from functools import cache

import numpy as np

from avatarsim.engine import FrameRecord, Settings
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import link_poses
from avatarsim.simulator import AvatarsimEngine
from scenarios.catalog import get


@cache
def scene_run(name: str, frames: int | None = None, preset: str = "default") -> tuple[Scene, list[FrameRecord]]:
    """Return the scene and a record per frame, by default of all frames of its short run."""
    scenario = get(name).as_run(False)
    scene = scenario.build()
    motion, engine = scenario.motion(scene, 0), AvatarsimEngine()
    engine.load(scene, Settings(preset), scenario.dt)
    return scene, [engine.advance(motion(k), scenario.dt) for k in range(frames or scenario.frames)]


def of_user(name: str, frames: int) -> np.ndarray:
    """Return (frames, links, 3) where the user's own links are."""
    scenario = get(name).as_run(False)
    scene = scenario.build()
    motion = scenario.motion(scene, 0)
    return np.array([link_poses(scene.avatars, motion(k))[0] for k in range(frames)])


def of_shown(name: str, frames: int) -> np.ndarray:
    """Return (frames, links, 3) where they are shown."""
    scene, records = scene_run(name, frames)
    return np.array([record.shown.positions[len(scene.bodies) :] for record in records])
