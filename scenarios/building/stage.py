"""Floor and endless walls for scenes with one avatar, the regions that go with them, and scenes of a humanoid."""

from collections.abc import Callable
from typing import Unpack

from avatarsim.scene.body import Body
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.cases import fixture
from scenarios.building.promises import AVATAR
from scenarios.building.scenes import above
from scenarios.scenario import INFINITE, Fields, Motion, Region, Scenario

SPAN = 20.0
"""Width of floor and walls [m]: no motion leads round them within a scene, so their far side is the wrong side."""
THICK = 0.2
"""Thickness of floor and walls [m]. A motion that goes 0.3 m beyond a face comes out at the back."""
HIGH = 4.0
"""Height of walls [m]."""


def floor() -> Body:
    """Return a slab whose top is z = 0."""
    return fixture("floor", Box((SPAN, SPAN, THICK)), "wood", (0.0, 0.0, -0.5 * THICK))


def wall_ahead(face: float) -> Body:
    """Return a wall across the x axis whose near face is at x = `face` [m]."""
    return fixture("wall", Box((THICK, SPAN, HIGH)), "wood", (face + 0.5 * THICK, 0.0, 0.5 * HIGH))


def above_floor(*bodies: str) -> Region:
    """Return the region above the middle of the floor."""
    # the middle, not the face: origins of shoulders and hips lie up to 5 mm outside the avatar's own shapes
    return above(-0.5 * THICK, *bodies, reason="nothing sinks through the floor")


def before_wall(face: float, *bodies: str, axis: int = 0) -> Region:
    """Return the region before the middle of the wall at `face` [m] along an axis, and above that of the floor."""
    high = [INFINITE, INFINITE, INFINITE]
    high[axis] = face + 0.5 * THICK
    x, y, z = high
    reason = "nothing goes through the wall, nor through the floor; it cannot be walked round"
    return Region(bodies, (-INFINITE, -INFINITE, -0.5 * THICK), (x, y, z), reason)


def with_human(
    name: str, title: str, judged: str, motion: Callable[[Scene, int], Motion],
    bodies: Callable[[], tuple[Body, ...]] = lambda: (floor(),), at: tuple[float, ...] = (), *, region: Region,
    **fields: Unpack[Fields],
) -> Scenario:
    """Return a scene of the humanoid with its root `at` x, y [m] and heading [rad], by default with the promises of AVATAR."""

    def build() -> Scene:
        human = humanoid()
        return Scene(name, bodies(), (human,), start=standing(human, *at))

    fields.setdefault("bounds", AVATAR)
    fields["regions"] = (region,)
    return Scenario(name, title, judged, build, motion, **fields)
