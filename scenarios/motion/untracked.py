"""Motion of scenes without an avatar: samples are empty, only time passes."""

from collections.abc import Callable

from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, rest
from scenarios.scenario import RENDERED, Motion


def untracked(dt: float = RENDERED) -> Callable[[Scene, int], Motion]:
    """Empty samples, one per frame of `dt` [s]."""

    def motion(scene: Scene, seed: int) -> Motion:
        def sample(frame: int) -> TrackerSample:
            return rest(scene.avatars, (frame + 1) * dt)

        return sample

    return motion
