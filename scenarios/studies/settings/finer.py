"""Step refinement: scenarios of the catalogue with every frame cut in parts; "stack_ten~4" advances four times per frame.

A module of scenarios by name, as the catalogue is.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

from avatarsim.errors import InvalidInput
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from scenarios import catalog
from scenarios.motion.between import between
from scenarios.scenario import Motion, Scenario

MARK = "~"
"""Between the name and the number of parts."""
MAX_PARTS = 1024
"""Most parts of a frame: a slip of the hand beyond."""


def name_of(scenario: str, cut: int) -> str:
    """Return the name here of a scenario whose frames are cut in `cut` parts."""
    return f"{scenario}{MARK}{cut}"


def get(name: str) -> Scenario:
    """Return the scenario of that name. Raises UnknownName for a scene and InvalidInput for an invalid number of parts."""
    base, _, parts = name.partition(MARK)
    whole = catalog.get(base)
    if not (parts.isdecimal() and 1 <= int(parts) <= MAX_PARTS):
        raise InvalidInput(f"parts of a frame in {name}", parts, f"a whole number from 1 to {MAX_PARTS}")
    cut = int(parts)
    return replace(
        whole, name=name, dt=whole.dt / cut, frames=whole.frames * cut, motion=_cut(whole.motion, cut),
        short=None if whole.short is None else whole.short * cut,
        short_motion=None if whole.short_motion is None else _cut(whole.short_motion, cut),
    )


def _cut(motion: Callable[[Scene, int], Motion], cut: int) -> Callable[[Scene, int], Motion]:
    def finer(scene: Scene, seed: int) -> Motion:
        rendered, first = cache(motion(scene, seed)), scene.first_sample

        def sample(k: int) -> TrackerSample:
            frame, part = divmod(k + 1, cut)
            if part == 0:
                return rendered(frame - 1)
            before = first if frame == 0 else rendered(frame - 1)
            return between(before, rendered(frame), part / cut)

        return sample

    return finer

