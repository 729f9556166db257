"""Features of a scene that are not set up in PhysX, as data: feature -> consequence."""

from collections.abc import Mapping

from avatarsim.scene.joint import MANY_TURNS, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import ConvexHull
from reference.collision_groups import BITS, collision_groups
from reference.in_physx.world import BETWEEN_HINGES, MAX_VERTICES, WHOLE_TURN
from reference.narrowing import alike_in_game_engines


def unsupported(scene: Scene) -> Mapping[str, str]:
    """Return the differences; empty when PhysX can express all of the scene."""
    features = alike_in_game_engines(scene, BETWEEN_HINGES, averages=True, vertices=MAX_VERTICES)
    hinges = [hinge for link in scene.links if isinstance(link.joint, Hinges) for hinge in link.joint.hinges]
    wide = sum(WHOLE_TURN <= hinge.upper - hinge.lower < 2.0 * MANY_TURNS for hinge in hinges)
    if wide:
        features["ranges of a turn or more"] = f"angles of joints wrap: {wide} hinges have no limits"
    pieces = [piece for body in scene.bodies for piece in body.pieces] + [piece for link in scene.links for piece in link.pieces]
    large = sum(isinstance(piece.shape, ConvexHull) and len(piece.shape.vertices) > MAX_VERTICES for piece in pieces)
    if large:
        features["large hulls"] = f"hulls of more than {MAX_VERTICES} vertices are thinned by the package: {large} pieces"
    if collision_groups(scene.contact_filter) is None:
        features["scene"] = f"its pairs need more than {BITS} collision groups"
    return features
