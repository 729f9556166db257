"""Features of a scene that are not set up in PhysX, as data: feature -> consequence."""

from collections.abc import Mapping

from avatarsim.scene.joint import MANY_TURNS, Hinges
from avatarsim.scene.scene import Scene
from reference.collision_groups import BITS, collision_groups
from reference.in_physx.world import BETWEEN_HINGES, WHOLE_TURN
from reference.narrowing import alike_in_game_engines


def cannot_say(scene: Scene) -> Mapping[str, str]:
    """Return what differs; empty when PhysX can express all of the scene."""
    found = alike_in_game_engines(scene, BETWEEN_HINGES, averages=True)
    hinges = [hinge for link in scene.links if isinstance(link.joint, Hinges) for hinge in link.joint.hinges]
    wide = sum(WHOLE_TURN <= hinge.upper - hinge.lower < 2.0 * MANY_TURNS for hinge in hinges)
    if wide:
        found["ranges of a turn or more"] = f"angles of joints wrap: {wide} hinges have no limits"
    if collision_groups(scene.contact_filter) is None:
        found["scene"] = f"its pairs need more than {BITS} collision groups"
    return found
