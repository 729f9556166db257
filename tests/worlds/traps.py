"""Dead ends, tubes and posts, and avatars that they hold off."""

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.shape import Box, Piece, Sphere
from tests.worlds.little_worlds import block

BEFORE, BEHIND = (-0.3, 0.0, 0.0), (0.3, 0.0, 0.0)
"""Places before and behind the end of the pocket."""


def pocket(y: float = 0.0) -> tuple[Body, ...]:
    """Return a dead end, open towards -x, 0.3 m wide and 0.3 m deep, between -0.3 and 0, about the line at y."""
    return (
        block(f"end {y:g}", (0.02, y, 0.0), (0.02, 0.4, 0.4)),
        block(f"left {y:g}", (-0.13, y + 0.17, 0.0), (0.3, 0.02, 0.4)),
        block(f"right {y:g}", (-0.13, y - 0.17, 0.0), (0.3, 0.02, 0.4)),
        block(f"over {y:g}", (-0.13, y, 0.17), (0.3, 0.4, 0.02)),
        block(f"under {y:g}", (-0.13, y, -0.17), (0.3, 0.4, 0.02)),
    )


def closed_pocket() -> tuple[Body, ...]:
    """Return a box from the inside: the dead end with a door that is shut."""
    return (*pocket(), block("door", (-0.29, 0.0, 0.0), (0.02, 0.32, 0.32)))


def tube() -> tuple[Body, ...]:
    """Return four slabs around the x axis, inner width 0.12 m: two hands of 0.1 m cannot pass each other inside."""
    return (
        block("left", (0.0, 0.11, 0.0), (4.0, 0.1, 0.32)), block("right", (0.0, -0.11, 0.0), (4.0, 0.1, 0.32)),
        block("over", (0.0, 0.0, 0.11), (4.0, 0.32, 0.1)), block("under", (0.0, 0.0, -0.11), (4.0, 0.32, 0.1)),
    )


def limbed(name: str = "limbed") -> Avatar:
    """Return a ball of 5 cm with a smaller one on a hinge: an avatar with a joint."""
    ball, tip = (Piece(Sphere(0.05)),), (Piece(Sphere(0.03)),)
    joint = Hinges((Hinge((0.0, 0.0, 1.0), -1.0, 1.0),))
    links = (
        Link("root", None, Free(), ball, solid(ball, 1.0)),
        Link("tip", "root", joint, tip, solid(tip, 0.1), anchor=(-0.1, 0.0, 0.0)),
    )
    return Avatar(name, links, ("tip",))


def boomed() -> Avatar:
    """Return a ball with a boom of 0.3 m towards -x that hardly turns."""
    ball, boom = (Piece(Sphere(0.05)),), (Piece(Box((0.24, 0.02, 0.02)), (-0.18, 0.0, 0.0)),)
    joint = Hinges((Hinge((0.0, 0.0, 1.0), -0.1, 0.1),))
    return Avatar(
        "boomed",
        (Link("root", None, Free(), ball, solid(ball, 1.0)), Link("boom", "root", joint, boom, solid(boom, 0.1))),
        ("boom",),
    )


POST = (block("post", (-0.2, 0.1, 0.0), (0.02, 0.02, 20.0)),)
"""In the way of the boom, not of the ball."""
