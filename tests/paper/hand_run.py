"""The short run of the hand over the table, shared by the tests of Figures 1 and 7."""

from functools import cache

from avatarsim.engine import FrameRecord, Settings
from avatarsim.scene.scene import Scene
from avatarsim.simulator import AvatarsimEngine
from scenarios.catalog import get


@cache
def hand_run() -> tuple[Scene, list[FrameRecord]]:
    """The scene and a record per frame."""
    scenario = get("hand_over_table").as_run(False)
    scene = scenario.build()
    motion, engine = scenario.motion(scene, 0), AvatarsimEngine()
    engine.load(scene, Settings(), scenario.dt)
    return scene, [engine.advance(motion(k), scenario.dt) for k in range(scenario.frames)]
