"""Effects that a scene's author left out, in the other engines: which engines have the switch, and which do not support it.

Restitution, friction, limits and self-contact are left out by the adapters. No engine here knows reach cones, nor looks for
impacts within a step, and sleeping is off unless a preset asks for it: a scene without them runs there as it always does.
"""

from collections.abc import Mapping

from avatarsim.scene.joint import Ball, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import ConvexHull, Ellipsoid, ellipsoid_hull
from reference.pair_factors import missed

ELLIPSOID_VERTICES = 162
"""Vertices of the hull that replaces an ellipsoid: it lies inside by at most about 2 % of the largest radius."""
ALWAYS_THERE: Mapping[str, str] = {
    "overlap_removal": "not switched off apart from contact as a whole",
    "coupling": "a driven link is a body with mass, which gives and takes in every contact",
    "dynamics": "what is free moves: simulated bodies are not held fixed",
    "gyroscopic": "not switched off for links",
}
"""Effects that these adapters do not leave out, and the consequence."""


def alike_in_all(scene: Scene) -> dict[str, str]:
    """Features that no other engine has -> consequence; `no EFFECT` -> why not, for effects that were narrowed away in vain."""
    lacks: dict[str, str] = {}
    if any(isinstance(link.joint, Ball) and link.joint.cone for link in scene.links):
        lacks["reach cones"] = "no spherical polygons: ignored"
    if any(any(link.surface_velocity) for link in scene.links):
        lacks["surface velocity"] = "belts do not carry loose bodies"
    if any(avatar.coupled_mass is not None for avatar in scene.avatars):
        lacks["coupled mass"] = "an avatar's links have one mass: their own"
    return lacks | {f"no {effect.replace('_', ' ')}": ALWAYS_THERE[effect] for effect in scene.lapsed if effect in ALWAYS_THERE}


def hull_of(shape: ConvexHull | Ellipsoid, vertices: int = ELLIPSOID_VERTICES) -> ConvexHull:
    """Return the hull itself, or the one that replaces an ellipsoid."""
    return ellipsoid_hull(shape.radii, vertices) if isinstance(shape, Ellipsoid) else shape


def alike_in_game_engines(scene: Scene, share: float = 1e-3, averages: bool = False, vertices: int = ELLIPSOID_VERTICES
                          ) -> dict[str, str]:
    """Return features -> consequence in engines with a joint per pair of bodies, a coefficient per body, of which products or
    `averages` are taken, hulls of `vertices` points for ellipsoids and stand-ins of a `share` of the mass between hinges."""
    lacks, links = missed(scene, averages), scene.links
    pieces = [piece for body in scene.bodies for piece in body.pieces] + [piece for link in links for piece in link.pieces]
    if any(isinstance(piece.shape, Ellipsoid) for piece in pieces):
        lacks["ellipsoids"] = f"replaced by hulls of {vertices} points on their surface"
    if any(isinstance(link.joint, Hinges) and len(link.joint.hinges) > 1 for link in links):
        lacks["shared centres"] = (
            f"one joint per body: stand-ins of {100.0 * share:g} % of the link's mass and inertia between hinges"
        )
    if any(avatar.couplings for avatar in scene.avatars):
        lacks["couplings"] = "each joint is led by itself: what blocks a follower does not stop its leader"
    if scene.effects.coupling:
        lacks["virtual coupling"] = "no spring as in equation 6: a link returns to its user by its own drive"
    return lacks | alike_in_all(scene)
