"""Motion of scenes without an avatar: samples are empty, only time passes."""

from collections.abc import Callable

from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import rest
from scenarios.scenario import RENDERED, Motion


def untracked(dt: float = RENDERED) -> Callable[[Scene, int], Motion]:
    """Return empty samples, one per frame of `dt` [s]."""
    return lambda scene, seed: lambda frame: rest(scene.avatars, (frame + 1) * dt)
