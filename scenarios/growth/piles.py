"""Many contacts at once: balls that roll, each on its own; a pyramid of bricks that stands; the same dropped."""

from math import ceil, sqrt

from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere

MODES = ("rolling", "standing", "dropped")
"""Balls, one contact each, all independent; bricks, whose contacts all depend on one another, at rest and falling."""
FRAMES = 90
"""One and a half seconds."""
RADIUS, APART, SPEED = 0.05, 0.3, 0.2
"""Of the balls [m]; from one to the next [m], which is as far as one rolls in that time; their speed [m/s]."""
LONG, SIDE, JOINT = 0.2, 0.1, 0.002
"""Edges of a brick [m], and the air between two of one row."""
DROP = 0.01
"""How far rows are from what they land on [m]; they land one after the other."""


def rows_for(contacts: int) -> int:
    """Rows of the smallest pyramid with at least so many contact points.

    The lowest of w rows has w bricks with four points each; all others, w (w - 1) / 2, stand on two with eight: 4 w^2 in all.
    """
    return ceil(sqrt(contacts / 4.0))


def balls(count: int) -> tuple[Body, ...]:
    """Balls on a square grid that roll without slipping."""
    side, shape = ceil(sqrt(count)), (Piece(Sphere(RADIUS)),)
    return tuple(
        simulated(f"ball_{k}", shape, "wood", solid(shape, 0.5), (APART * (k % side), APART * (k // side), RADIUS),
                  velocity=(SPEED, 0.0, 0.0), angular_velocity=(0.0, SPEED / RADIUS, 0.0)) for k in range(count)
    )


def bricks(contacts: int, gap: float) -> tuple[Body, ...]:
    """A pyramid with at least so many contact points, each row ``gap`` [m] above what it stands on."""
    shape, rows = (Piece(Box((LONG, SIDE, SIDE))),), rows_for(contacts)
    return tuple(
        simulated(f"brick_{row}_{k}", shape, "wood", solid(shape, 2.0),
                  ((LONG + JOINT) * (k + 0.5 * row), 0.0, (SIDE + gap) * (row + 1) - 0.5 * SIDE))
        for row in range(rows) for k in range(rows - row)
    )


def pile(contacts: int, mode: str) -> Scene:
    """The scene of that many contacts. Without sleeping: it shows what contacts cost, not what rest saves."""
    bodies = balls(contacts) if mode == MODES[0] else bricks(contacts, DROP if mode == MODES[2] else 0.0)
    ground = fixed("floor", (Piece(Box((100.0, 100.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
    return Scene(f"contacts_{contacts}_{mode}", (ground, *bodies), narrow=("sleeping",))

