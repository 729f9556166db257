"""The humanoid that the recorded motions were made for, read from its file: 15 links, 45 kg, 1.6 m.

The file (pybullet_data/humanoid/humanoid.urdf) is four times too large and has y up; masses are true. Its inertias are
placeholders and its limits wide open: inertias are those of solid shapes, limits those of `scenarios.building.avatars.limits`.
"""

from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.motions.deepmimic import z_up
from avatarsim.errors import InvalidFile
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
    """The avatar; link frames sit in the joints, x forward, y left, z up when all joints are at zero."""
    path = data_file("humanoid/humanoid.urdf")
    thing, valid = f"humanoid {path.name}", "a whole URDF file"
    try:
        # the file as shipped ends in a zero byte, a C string written whole, which no XML may hold
        robot = ElementTree.fromstring(read_bytes(path, thing, valid).rstrip(b"\0"))
    except ElementTree.ParseError as error:
        raise InvalidFile(thing, str(error), valid) from error
    elements = {_word(path, link, "name"): link for link in robot.iter("link")}
    links = []
    for joint in robot.findall("joint"):
        child, parent = (_word(path, _part(path, joint, tag), "link") for tag in ("child", "parent"))
        # the file hangs the root on a massless base, which is the world's place for it
        links.append(_link(path, elements[child], joint, None if parent == "base" else parent))
    return Avatar(name, tuple(links), CHAINS)


def _link(path: Path, element: ElementTree.Element, joint: ElementTree.Element, parent: str | None) -> Link:
    name = _word(path, element, "name")
    mass = float(_word(path, _part(path, element, "inertial/mass"), "value"))
    pieces = tuple(_piece(path, collision) for collision in element.findall("collision"))
    anchor = _vector(path, _part(path, joint, "origin"), "xyz") * SCALE if parent else np.zeros(3)
    x, y, z = z_up(anchor).tolist()
    return Link(name, parent, _joint(path, joint, name, parent), pieces, solid(pieces, mass), anchor=(x, y, z))


def _joint(path: Path, joint: ElementTree.Element, name: str, parent: str | None) -> Joint:
    kind = _word(path, joint, "type")
    if parent is None:
        return Free()
    if kind == "fixed":
        return Rigid()
    if kind == "spherical":
        return Ball(ball_limits(name), reach_cone(name))
    if kind == "revolute":
        x, y, z = z_up(_vector(path, _part(path, joint, "axis"), "xyz")).tolist()
        return Hinges((Hinge((x, y, z), *hinge_limits(name)),))
    raise InvalidFile(f"type of joint {name} in {path.name}", kind, "fixed, spherical or revolute")


def _piece(path: Path, collision: ElementTree.Element) -> Piece:
    geometry, origin = _part(path, collision, "geometry"), _part(path, collision, "origin")
    x, y, z = z_up(_vector(path, origin, "xyz") * SCALE).tolist()
    # turns by roll about x, then pitch about y, then yaw about z, all fixed axes
    angles = zip(np.eye(3), _vector(path, origin, "rpy"), strict=True)
    roll, pitch, yaw = (rotation.from_axis_angle(axis, angle) for axis, angle in angles)
    turn = rotation.multiply(UPRIGHT, rotation.multiply(yaw, rotation.multiply(pitch, roll)))
    w, a, b, c = rotation.normalised(turn).tolist()
    return Piece(_shape(path, geometry[0]), (x, y, z), (w, a, b, c))


def _shape(path: Path, element: ElementTree.Element) -> Shape:
    def length(attribute: str) -> float:
        return float(_word(path, element, attribute)) * SCALE

    if element.tag == "sphere":
        return Sphere(length("radius"))
    if element.tag == "capsule":
        return Capsule(length("radius"), length("length"))
    if element.tag == "box":
        x, y, z = (_vector(path, element, "size") * SCALE).tolist()
        return Box((x, y, z))
    raise InvalidFile(f"shape in {path.name}", element.tag, "sphere, capsule or box")


def _part(path: Path, element: ElementTree.Element, tag: str) -> ElementTree.Element:
    found = element.find(tag)
    if found is None:
        raise InvalidFile(f"<{element.tag} {element.get('name', '')}> of {path.name}", None, f"a part <{tag}>")
    return found


def _word(path: Path, element: ElementTree.Element, attribute: str) -> str:
    found = element.get(attribute)
    if found is None:
        raise InvalidFile(f"attribute {attribute} of <{element.tag}> in {path.name}", None, "a value")
    return found


def _vector(path: Path, element: ElementTree.Element, attribute: str) -> NDArray[np.float64]:
    words = _word(path, element, attribute).split()
    try:
        x, y, z = (float(word) for word in words)
    except ValueError as error:
        raise InvalidFile(f"{attribute} of <{element.tag}> in {path.name}", words, "three numbers") from error
    return np.array([x, y, z])
