"""An articulated hand of 24 limited hinges: the Shadow hand of gymnasium-robotics, read from the installed package.

Every link carries the hull of its own mesh; two in the thumb have none, and a little box. The forearm, which the file
fixes to a mount, goes where the user goes.
"""

from functools import cache
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from avatarsim.errors import InvalidFile
from avatarsim.scene.avatar import Avatar, Link
from scenarios.building.avatars.mjcf import Mjcf, named, parsed
from scenarios.data_folder import robotics_assets

CHAINS = ("ffdistal", "mfdistal", "rfdistal", "lfdistal", "thdistal")
"""Tips of its chains: four fingers and the thumb."""
IGNORE = (
    ("palm", "ffproximal"), ("palm", "mfproximal"), ("palm", "rfproximal"), ("lfmetacarpal", "lfproximal"),
    ("palm", "thproximal"), ("thproximal", "thmiddle"),
)
"""Pairs whose hulls overlap when all joints are at zero: two hinges in one place, with a knuckle or nothing between them."""


def bends_finger(link: Link) -> bool:
    """Return whether a link's joint bends one of the four fingers, not the thumb."""
    return link.name.endswith(("proximal", "middle", "distal")) and not link.name.startswith("th")


@cache
def shadow_hand(name: str = "hand") -> Avatar:
    """Return the avatar: at zero fingers are along z, the palm faces -y. MissingPackage without gymnasium-robotics."""
    folder = robotics_assets()
    path = folder / "hand" / "robot.xml"
    forearm = parsed(path).find("body/body")
    if forearm is None:
        raise InvalidFile(f"forearm of {path.name}", None, "a body in the mount")
    reader = Mjcf(path, False, _is_seen, _stated_mass, _meshes(folder))
    return Avatar(name, reader.links(forearm), CHAINS, IGNORE)


def _is_seen(geom: Element) -> bool:
    # the visible geoms, meshes and two little boxes in the thumb; next to them lie capsules that replace them in contact
    return named(geom).startswith("V_")


def _stated_mass(body: Element, volume: float) -> float:
    inertial = body.find("inertial")
    if inertial is None or inertial.get("mass") is None:
        raise InvalidFile(f"mass of body {named(body)}", None, "an <inertial> with a mass")
    return float(inertial.get("mass", ""))


def _meshes(folder: Path) -> dict[str, tuple[Path, np.typing.NDArray[np.float64]]]:
    """Return mesh name -> file and metres per unit."""
    listed = parsed(folder / "hand" / "shared_asset.xml").findall("mesh")
    return {
        mesh.get("name", ""): (
            folder / "stls" / "hand" / mesh.get("file", ""),
            np.array([float(word) for word in mesh.get("scale", "1 1 1").split()]),
        )
        for mesh in listed
    }
