"""Floor and endless walls for scenes with one avatar, and the regions that go with them."""

from avatarsim.scene.body import Body, fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.scenario import INFINITE, Region

SPAN = 20.0
"""Width of floor and walls [m]: no motion leads round them within a scene, so their far side is the wrong side."""
THICK = 0.2
"""Thickness of floor and walls [m]. A motion that goes 0.3 m beyond a face comes out at the back."""
HIGH = 4.0
"""Height of walls [m]."""


def floor() -> Body:
    """A slab whose top is z = 0."""
    return fixed("floor", (Piece(Box((SPAN, SPAN, THICK))),), "wood", (0.0, 0.0, -0.5 * THICK))


def wall_ahead(face: float) -> Body:
    """A wall across the x axis whose near face is at x = `face` [m]."""
    return fixed("wall", (Piece(Box((THICK, SPAN, HIGH))),), "wood", (face + 0.5 * THICK, 0.0, 0.5 * HIGH))


def human_before_wall(name: str, face: float) -> Scene:
    """The humanoid stands on the floor, its root over the origin, and looks at a wall at x = `face` [m]."""
    human = humanoid()
    return Scene(name, (floor(), wall_ahead(face)), (human,), start=standing(human))


def above_floor(*bodies: str) -> Region:
    """No frame origin below the middle of the floor."""
    # the middle, not the face: origins of shoulders and hips lie up to 5 mm outside the avatar's own shapes
    low, high = (-INFINITE, -INFINITE, -0.5 * THICK), (INFINITE, INFINITE, INFINITE)
    return Region(bodies, low, high, "nothing sinks through the floor")


def before_wall(face: float, *bodies: str) -> Region:
    """No frame origin beyond the middle of the wall at `face` [m], nor below that of the floor."""
    low, high = (-INFINITE, -INFINITE, -0.5 * THICK), (face + 0.5 * THICK, INFINITE, INFINITE)
    return Region(bodies, low, high, "nothing goes through the wall, nor through the floor; it cannot be walked round")
