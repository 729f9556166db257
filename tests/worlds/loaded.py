"""An engine with a scene, in one call."""

from typing import Any

from avatarsim.engine import Settings
from avatarsim.scene.scene import Scene
from avatarsim.simulator import AvatarsimEngine

DT = 1.0 / 60.0
"""Frame of the tests [s]."""


def loaded(scene: Scene, method: str = "default", dt: float = DT, **settings: Any) -> AvatarsimEngine:
    """Return an engine that has loaded a scene."""
    engine = AvatarsimEngine()
    engine.load(scene, Settings(method, **settings), dt)
    return engine
