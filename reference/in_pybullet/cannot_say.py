"""What PyBullet has no words for in a scene, as data: feature -> consequence."""

from collections.abc import Mapping

import numpy as np

from avatarsim.scene.joint import Ball, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Ellipsoid
from reference.in_pybullet.stand_ins import ELLIPSOID_VERTICES, WIDEST
from reference.narrowing import alike_in_both
from reference.pair_factors import Array, coefficients, fit, weights

RARE = 1e-3
"""Weight, relative to the likeliest pair, below which two bodies hardly ever meet: not worth a word."""

LISTED = 4
"""Pairs named in full when the product rule misses them; the others are counted."""


def cannot_say(scene: Scene) -> Mapping[str, str]:
    """Empty when PyBullet can express all of the scene."""
    found: dict[str, str] = {}
    links = scene.links
    balls = [link.joint for link in links if isinstance(link.joint, Ball)]
    pieces = [piece for body in scene.bodies for piece in body.pieces]
    pieces += [piece for link in links for piece in link.pieces]
    if any(isinstance(piece.shape, Ellipsoid) for piece in pieces):
        found["ellipsoids"] = f"replaced by hulls of {ELLIPSOID_VERTICES} points on their surface"
    for what, wanted, matters in zip(("restitution", "friction"), coefficients(scene), weights(scene), strict=True):
        said = _missed(scene, wanted, matters)
        if said:
            found[what] = said
    limits = [ball.limits for ball in balls if ball.limits is not None]
    if limits:
        wide = sum(limit.swing > WIDEST for limit in limits)
        found["swing cones"] = (
            "a joint has limits of two angles and of twist: a cone is the pyramid about it, up to 16 degrees wider in its corners"
            + (f"; of {wide} joints with cones wider than {np.degrees(WIDEST):g} degrees only twist is limited" if wide else "")
            + ". Motors hold harder beyond the cone (tuned only)"
        )
    if any(isinstance(link.joint, Hinges) and len(link.joint.hinges) > 1 for link in links):
        found["shared centres"] = (
            "one joint per link: stand-in links of 0.1 % of the link's mass and inertia between hinges"
        )
    if any(avatar.couplings for avatar in scene.avatars):
        found["couplings"] = "each joint is led by itself: what blocks a follower does not stop its leader"
    if scene.effects.coupling:
        found["virtual coupling"] = (
            "no spring of eq. 6: after a collision a link goes back to its user as constraints and motors have it"
        )
    return found | alike_in_both(scene)


def _missed(scene: Scene, wanted: Array, matters: Array) -> str:
    """What the product rule makes of the pairs it cannot say; empty when it says all that are likely to meet."""
    misses = [miss for miss in fit(scene, wanted, matters).misses if matters[miss[0], miss[1]] > RARE * matters.max()]
    if not misses:
        return ""
    listed = ", ".join(
        f"{scene.names[a]} on {scene.names[b]} {said:.3f} instead of {meant:.3f}" for a, b, meant, said in misses[:LISTED]
    )
    more = f" and {len(misses) - LISTED} more" if len(misses) > LISTED else ""
    return f"a pair's coefficient is the product of its bodies' factors, here the closest fit: {listed}{more}"
