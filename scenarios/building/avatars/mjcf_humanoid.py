"""A small humanoid of 21 limited hinges, read from a file that users of other engines know: 13 bodies, 40.8 kg.

The file (pybullet_data/mjcf/humanoid.xml) gives every hinge a range and every body its shapes; masses follow from shapes at
the density of water, as the format has it.
"""

from functools import cache

from avatarsim.errors import InvalidFile
from avatarsim.scene.avatar import Avatar
from scenarios.building.avatars.mjcf import Mjcf, parsed
from scenarios.data_folder import data_file

WATER = 1000.0
"""Density [kg/m^3] of a geom without one of its own, by the format."""
CHAINS = ("right_lower_arm", "left_lower_arm", "right_foot", "left_foot")
"""Tips of the paper's chains; its head has no joint."""


@cache
def hinged_humanoid(name: str = "human") -> Avatar:
    """Return the avatar; link frames sit in the joints, x forward, y left, z up when all joints are at zero."""
    path = data_file("mjcf/humanoid.xml")
    root = parsed(path).find("worldbody/body")
    if root is None:
        raise InvalidFile(f"first body of {path.name}", None, "a body in the world")
    reader = Mjcf(path, True, lambda geom: True, lambda body, volume: WATER * volume, {})
    return Avatar(name, reader.links(root), CHAINS)
