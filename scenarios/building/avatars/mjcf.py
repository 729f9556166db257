"""Avatars from MJCF files: bodies, limited hinges, capsules, spheres, boxes and meshes; nothing else of the format.

A body's frame becomes a link's frame moved into the centre of its hinges. Hinges of one body with different centres become
links of their own in front of it, each a little ball in its joint. The first body goes where the user goes, whatever holds
it in the file.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidFile
from avatarsim.files import read_bytes
from avatarsim.scene.avatar import Link
from avatarsim.scene.body import Mass, solid
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.joint import Free, Hinge, Hinges, Joint, Rigid
from avatarsim.scene.shape import Box, Capsule, Piece, Shape, Sphere
from avatarsim.spatial import rotation
from scenarios.building.avatars.stl import hull_of

Array = NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])
BETWEEN, BALL = 0.1, 0.005
"""Mass of a link between two hinges of one body, as a share of the body's, and radius [m] of its ball, which lies inside its
neighbours: next to nothing for a user, but engines need mass and shape of every link."""
DIRECTIONS = 64
"""Directions in which a mesh's farthest points are taken as the vertices of its hull."""


@dataclass(frozen=True)
class Mjcf:
    """One file and how it is read: angles in degrees or radians, meshes by name, which geoms count, kg for a body."""

    path: Path
    degrees: bool
    wanted: Callable[[Element], bool]
    mass: Callable[[Element, float], float]
    meshes: Mapping[str, tuple[Path, Array]]

    def numbers(self, element: Element, attribute: str, count: int, default: tuple[float, ...] | None = None) -> Array:
        """Return `count` numbers of an attribute; InvalidFile when there are others, or none and no default."""
        words = element.get(attribute)
        try:
            values = np.array(default if words is None else [float(word) for word in words.split()], dtype=np.float64)
        except (TypeError, ValueError):
            values = np.zeros(0)
        # MJCF allows more numbers than a type needs: a capsule's size with fromto, say
        if values.ndim != 1 or len(values) < count or not np.isfinite(values).all():
            thing = f"{attribute} of <{element.tag} {element.get('name', '')}> in {self.path.name}"
            raise InvalidFile(thing, words, f"{count} finite numbers")
        return values[:count]

    def links(self, root: Element) -> tuple[Link, ...]:
        """Return the links of the tree below the body `root`, parents first."""
        return tuple(self._links(root, None, np.zeros(3)))

    def _links(self, body: Element, parent: str | None, parent_centre: Array) -> Iterator[Link]:
        name = named(body)
        place = self.numbers(body, "pos", 3, (0.0, 0.0, 0.0))
        turn = self.turn(body)
        groups = self._hinges(body) if parent is not None else []
        centre = groups[-1][0] if groups else np.zeros(3)
        pieces = tuple(self._piece(geom, centre) for geom in body.findall("geom") if self.wanted(geom))
        mass = self._mass(body, pieces)
        before, at = parent, place - parent_centre
        for k, (here, hinges) in enumerate(groups[:-1]):
            at = place + rotation.rotate(turn, here) - parent_centre if k == 0 else here - groups[k - 1][0]
            small = Mass(BETWEEN * mass.mass, inertia=BETWEEN * mass.inertia)
            between = f"{name}_{k}"
            ball = (Piece(Sphere(BALL)),)
            yield Link(between, before, Hinges(hinges), ball, small, anchor=_vector(at), orientation=_quaternion(turn))
            before, turn = between, np.array(rotation.IDENTITY)
            at = groups[k + 1][0] - here
        if len(groups) == 1:
            at = place + rotation.rotate(turn, centre) - parent_centre
        joint: Joint = Free() if parent is None else Hinges(groups[-1][1]) if groups else Rigid()
        if parent is None:
            at, turn = np.zeros(3), np.array(rotation.IDENTITY)
        yield Link(name, before, joint, pieces, mass, anchor=_vector(at), orientation=_quaternion(turn))
        for child in body.findall("body"):
            yield from self._links(child, name, centre)

    def _hinges(self, body: Element) -> list[tuple[Array, tuple[Hinge, ...]]]:
        """Return hinges of a body, those that share a centre together: centre in the body's frame, hinges in order."""
        groups: list[tuple[Array, tuple[Hinge, ...]]] = []
        for joint in body.findall("joint"):
            kind = joint.get("type", "hinge")
            if kind != "hinge":
                raise InvalidFile(f"type of joint {joint.get('name')} in {self.path.name}", kind, "hinge, below the root")
            low, high = (float(v) for v in self.numbers(joint, "range", 2) * (np.pi / 180.0 if self.degrees else 1.0))
            hinge = Hinge(_vector(self.numbers(joint, "axis", 3, (0.0, 0.0, 1.0))), low, high)
            centre = self.numbers(joint, "pos", 3, (0.0, 0.0, 0.0))
            if groups and np.array_equal(groups[-1][0], centre):
                groups[-1] = (centre, (*groups[-1][1], hinge))
            else:
                groups.append((centre, (hinge,)))
        return groups

    def _mass(self, body: Element, pieces: tuple[Piece, ...]) -> Mass:
        if pieces:
            return solid(pieces, self.mass(body, sum(_volume(piece.shape) for piece in pieces)))
        inertial = body.find("inertial")
        if inertial is None:
            raise InvalidFile(f"mass of body {body.get('name')} in {self.path.name}", None, "shapes or <inertial>")
        return Mass(float(self.numbers(inertial, "mass", 1)[0]), inertia=np.diag(self.numbers(inertial, "diaginertia", 3)))

    def turn(self, element: Element) -> Array:
        """Return the orientation of an element, given as quat, axisangle or euler (turns about x, y, z of the moving frame)."""
        unit = np.pi / 180.0 if self.degrees else 1.0
        if element.get("axisangle") is not None:
            x, y, z, angle = self.numbers(element, "axisangle", 4)
            return rotation.from_axis_angle(np.array([x, y, z]) / np.linalg.norm([x, y, z]), unit * angle)
        if element.get("euler") is not None:
            turned = np.array(rotation.IDENTITY)
            for axis, angle in zip(np.eye(3), self.numbers(element, "euler", 3), strict=True):
                turned = rotation.multiply(turned, rotation.from_axis_angle(axis, unit * angle))
            return turned
        return rotation.normalised(self.numbers(element, "quat", 4, rotation.IDENTITY))

    def _piece(self, geom: Element, centre: Array) -> Piece:
        place, turn = self.numbers(geom, "pos", 3, (0.0, 0.0, 0.0)), self.turn(geom)
        if geom.get("fromto") is not None:
            ends = self.numbers(geom, "fromto", 6).reshape(2, 3)
            length = float(np.linalg.norm(ends[1] - ends[0]))
            place, turn = ends.mean(axis=0), rotation.between(UP, (ends[1] - ends[0]) / length)
            return Piece(Capsule(float(self.numbers(geom, "size", 1)[0]), length), _vector(place - centre), _quaternion(turn))
        return Piece(self._shape(geom), _vector(place - centre), _quaternion(turn))

    def _shape(self, geom: Element) -> Shape:
        if (mesh := geom.get("mesh")) is not None:
            if mesh not in self.meshes:
                raise InvalidFile(f"mesh of a geom in {self.path.name}", mesh, f"one of {sorted(self.meshes)}")
            path, scale = self.meshes[mesh]
            return hull_of(path, scale, DIRECTIONS)
        kind = geom.get("type", "sphere")
        if kind == "sphere":
            return Sphere(float(self.numbers(geom, "size", 1)[0]))
        if kind == "capsule":
            radius, half = self.numbers(geom, "size", 2)
            return Capsule(float(radius), 2.0 * float(half))
        if kind == "box":
            return Box(_vector(2.0 * self.numbers(geom, "size", 3)))
        raise InvalidFile(f"type of geom {geom.get('name')} in {self.path.name}", kind, "sphere, capsule, box or mesh")


def parsed(path: Path) -> Element:
    """Return the root element of an XML file; InvalidFile when it is missing or cut off."""
    thing, valid = f"MJCF file {path.name}", "a whole MJCF file"
    try:
        return ElementTree.fromstring(read_bytes(path, thing, valid))
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        # the last two: an encoding that Python does not know
        raise InvalidFile(thing, str(error), valid) from error


def named(element: Element) -> str:
    """Return an element's name without the file's prefix, such as "palm" of "robot0:palm"."""
    return element.get("name", "").split(":")[-1]


def _volume(shape: Shape) -> float:
    if isinstance(shape, Sphere):
        return float(4.0 / 3.0 * np.pi * shape.radius**3)
    if isinstance(shape, Capsule):
        return float(np.pi * shape.radius**2 * (shape.length + 4.0 / 3.0 * shape.radius))
    # files with meshes state their masses; one that does not is refused, as no mass is nan
    return float(np.prod(shape.size)) if isinstance(shape, Box) else float("nan")


def _vector(values: Array) -> Vector:
    x, y, z = values.tolist()
    return x, y, z


def _quaternion(values: Array) -> Quaternion:
    w, x, y, z = rotation.normalised(values).tolist()
    return w, x, y, z
