"""A box that lies across two posts with a flat hand below it, which lifts it off."""

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.building.cases import LAID, pair_table
from scenarios.motion.rigid_hands import hands_at

TOP = 0.3
"""Height of the posts [m]."""
POST, ASIDE = (0.04, 0.1, TOP), 0.1
"""Edges of a post, and how far from the middle it stands [m]."""
BOX: Vector = (0.24, 0.08, 0.06)
"""Edges of the box [m]."""
HAND: Vector = (0.14, 0.2, 0.02)
"""Edges of the hand [m]."""
HAND_MASS = 0.5
"""Mass of the hand [kg]."""
LOW, HIGH = TOP - 0.03, TOP + 0.04
"""Heights of the hand's middle before and after it lifts the box [m]."""


def box_across_posts(name: str, mass: float, friction: float) -> Scene:
    """Return floor, posts and the box of `mass` [kg], and the hand between the posts at LOW."""
    pieces, palm = (Piece(Box(BOX)),), (Piece(Box(HAND)),)
    floor = fixed("floor", (Piece(Box((8.0, 8.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
    posts = tuple(fixed(f"post_{k}", (Piece(Box(POST)),), "wood", (x, 0.0, 0.5 * TOP)) for k, x in enumerate((-ASIDE, ASIDE)))
    box = simulated("box", pieces, "box", solid(pieces, mass), (0.0, 0.0, TOP + 0.5 * BOX[2] + LAID))
    hand = rigid_avatar("hand", palm, solid(palm, HAND_MASS), "hand")
    law = ContactLaw(0.0, friction)
    materials = pair_table(("wood", "box", "hand"), {("wood", "box"): law, ("box", "hand"): law})
    return Scene(name, (floor, *posts, box), (hand,), materials, start=hands_at(((0.0, 0.0, LOW),)))
