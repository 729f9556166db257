"""The humanoid that the recorded motions were made for, read from its file: 15 links, 45 kg, 1.6 m.

The file (pybullet_data/humanoid/humanoid.urdf) is four times too large and has y up; masses are true. Its inertias are
placeholders and its limits wide open: inertias are those of solid shapes, limits those of `scenarios.building.avatars.limits`.
"""

from collections.abc import Iterator
from functools import cache
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.motions.deepmimic import Y_UP
from avatarsim.errors import InvalidFile, described
from avatarsim.files import read_bytes
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.checks import Quaternion
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Joint, Rigid
from avatarsim.scene.shape import Box, Capsule, Piece, Shape, Sphere
from avatarsim.spatial import rotation
from scenarios.building.avatars.limits import ball_limits, hinge_limits, reach_cone
from scenarios.data_folder import data_file

SCALE = 0.25
"""Size of our humanoid over the file's. The clips' root heights (0.9 m) are those of this scale."""
UPRIGHT: Quaternion = (float(np.sqrt(0.5)), float(np.sqrt(0.5)), 0.0, 0.0)
"""Turns the file's axes (y up) into ours (z up): a quarter turn about x."""
CHAINS = ("right_wrist", "left_wrist", "right_ankle", "left_ankle", "neck")
"""Tips of the paper's chains: arms, legs, neck."""


@cache
def humanoid(name: str = "human") -> Avatar:
    """Return the avatar; link frames are in the joints, x forward, y left, z up when all are at zero. Raises InvalidFile."""
    path = data_file("humanoid/humanoid.urdf")
    thing, valid = f"humanoid {path.name}", "a whole URDF file"
    try:
        # the file as shipped ends in a zero byte, a C string written whole, which no XML may hold
        return Avatar(name, tuple(_links(ElementTree.fromstring(read_bytes(path, thing, valid).rstrip(b"\0")))), CHAINS)
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        # a part, an attribute or a number that is not there
        raise InvalidFile(thing, described(error), valid) from error


def _links(robot: Element) -> Iterator[Link]:
    elements = {link.attrib["name"]: link for link in robot.iter("link")}
    for joint in robot.findall("joint"):
        name, parent = (_part(joint, tag).attrib["link"] for tag in ("child", "parent"))
        # the file hangs the root on a massless base, which is the world's place for it
        root, element = parent == "base", elements[name]
        pieces = tuple(map(_piece, element.findall("collision")))
        mass = solid(pieces, float(_part(element, "inertial/mass").attrib["value"]))
        x, y, z = Y_UP.vectors(np.zeros(3) if root else _vector(_part(joint, "origin"), "xyz") * SCALE).tolist()
        yield Link(name, None if root else parent, Free() if root else _joint(joint, name), pieces, mass, anchor=(x, y, z))


def _joint(joint: Element, name: str) -> Joint:
    kind = joint.attrib["type"]
    if kind == "fixed":
        return Rigid()
    if kind == "spherical":
        return Ball(ball_limits(name), reach_cone(name))
    if kind == "revolute":
        x, y, z = Y_UP.vectors(_vector(_part(joint, "axis"), "xyz")).tolist()
        return Hinges((Hinge((x, y, z), *hinge_limits(name)),))
    raise ValueError(f"joint {name} is {kind}, not fixed, spherical or revolute")


def _piece(collision: Element) -> Piece:
    geometry, origin = _part(collision, "geometry"), _part(collision, "origin")
    x, y, z = Y_UP.vectors(_vector(origin, "xyz") * SCALE).tolist()
    # turns by roll about x, then pitch about y, then yaw about z, all fixed axes
    angles = zip(np.eye(3), _vector(origin, "rpy"), strict=True)
    roll, pitch, yaw = (rotation.from_axis_angle(axis, angle) for axis, angle in angles)
    turn = rotation.multiply(UPRIGHT, rotation.multiply(yaw, rotation.multiply(pitch, roll)))
    w, a, b, c = rotation.normalised(turn).tolist()
    return Piece(_shape(geometry[0]), (x, y, z), (w, a, b, c))


def _shape(element: Element) -> Shape:
    def length(attribute: str) -> float:
        return float(element.attrib[attribute]) * SCALE

    if element.tag == "sphere":
        return Sphere(length("radius"))
    if element.tag == "capsule":
        return Capsule(length("radius"), length("length"))
    if element.tag == "box":
        x, y, z = (_vector(element, "size") * SCALE).tolist()
        return Box((x, y, z))
    raise ValueError(f"shape {element.tag}, not sphere, capsule or box")


def _part(element: Element, tag: str) -> Element:
    """Return the first part of that tag. Raises IndexError without one."""
    return element.findall(tag)[0]


def _vector(element: Element, attribute: str) -> NDArray[np.float64]:
    x, y, z = map(float, element.attrib[attribute].split())
    return np.array([x, y, z])
