"""Similarity transforms of a scene: larger or smaller, turned, at another place; and its recording, brought back.

Lengths, speeds and gravity grow with `scale`, times and masses stay: the motion is then the same, and so is every verdict on a
recording that was brought back.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidScene
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, Mass
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.joint import Free
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from runfiles.record import Recording

Array = NDArray[np.float64]


def _vector(array: Array) -> Vector:
    x, y, z = array.tolist()
    return x, y, z


def _shape(shape: Shape, s: float) -> Shape:
    if isinstance(shape, Sphere):
        return Sphere(s * shape.radius)
    if isinstance(shape, Capsule):
        return Capsule(s * shape.radius, s * shape.length)
    if isinstance(shape, Box):
        return Box(_vector(s * np.array(shape.size)))
    if isinstance(shape, Ellipsoid):
        return Ellipsoid(_vector(s * np.array(shape.radii)))
    return ConvexHull(s * shape.vertices)


@dataclass(frozen=True)
class Elsewhere:
    """Scale, turn (w, x, y, z) about the old origin, and place [m] of that origin afterwards."""

    scale: float = 1.0
    turn: Quaternion = rotation.IDENTITY
    origin: Vector = (0.0, 0.0, 0.0)

    @property
    def here(self) -> bool:
        """Return True if nothing changes: then not one bit does."""
        return self == Elsewhere()

    def place(self, place: object) -> Array:
        """Return where points (..., 3) are there."""
        return np.asarray(self.along(place) + np.array(self.origin))

    def along(self, vector: object) -> Array:
        """Return distances and velocities (..., 3) there."""
        return np.asarray(self.scale * rotation.rotate(np.array(self.turn), np.asarray(vector, dtype=np.float64)))

    def turned(self, orientation: object) -> Array:
        """Return orientations (..., 4) there."""
        return np.asarray(rotation.multiply(np.array(self.turn), np.asarray(orientation, dtype=np.float64)))

    def _spin(self, spin: object) -> Array:
        return np.asarray(rotation.rotate(np.array(self.turn), np.asarray(spin, dtype=np.float64)))

    def _pieces(self, pieces: tuple[Piece, ...]) -> tuple[Piece, ...]:
        return tuple(
            replace(piece, shape=_shape(piece.shape, self.scale), position=_vector(self.scale * np.array(piece.position)))
            for piece in pieces
        )

    def _mass(self, mass: Mass) -> Mass:
        return Mass(mass.mass, _vector(self.scale * np.array(mass.centre)), self.scale**2 * mass.inertia)

    def body(self, body: Body) -> Body:
        """Return a body there."""
        w, x, y, z = self.turned(body.orientation).tolist()
        return replace(
            body, pieces=self._pieces(body.pieces), position=_vector(self.place(body.position)), orientation=(w, x, y, z),
            mass=None if body.mass is None else self._mass(body.mass), velocity=_vector(self.along(body.velocity)),
            angular_velocity=_vector(self._spin(body.angular_velocity)),
        )

    def _link(self, link: Link) -> Link:
        if link.parent is None and not isinstance(link.joint, Free):
            raise InvalidScene(f"root {link.name} of an avatar to be moved", type(link.joint).__name__, "free")
        anchor = _vector(self.scale * np.array(link.anchor))
        return replace(link, pieces=self._pieces(link.pieces), mass=self._mass(link.mass), anchor=anchor)

    def avatar(self, avatar: Avatar) -> Avatar:
        """Return an avatar there; raises InvalidScene for one whose root is not free."""
        low, high = avatar.size_range
        span = (self.scale * low, self.scale * high)
        return replace(avatar, links=tuple(self._link(link) for link in avatar.links), size_range=span)

    def sample(self, sample: TrackerSample, avatars: tuple[Avatar, ...]) -> TrackerSample:
        """Return the user's sample there: only roots are in the world."""
        positions, rotations, first = sample.positions.copy(), sample.rotations.copy(), 0
        for avatar in avatars:
            positions[first], rotations[first] = self.place(positions[first]), self.turned(rotations[first])
            first += len(avatar.links)
        return TrackerSample(sample.time, positions, rotations, sample.angles)

    def scene(self, scene: Scene) -> Scene:
        """Return the scene there."""
        if self.here:
            return scene
        start = None if scene.start is None else self.sample(scene.start, scene.avatars)
        return replace(
            scene, bodies=tuple(self.body(body) for body in scene.bodies), gravity=_vector(self.along(scene.gravity)),
            avatars=tuple(self.avatar(avatar) for avatar in scene.avatars), start=start,
        )

    def back(self, recording: Recording) -> Recording:
        """Return a recording made there as if it had been recorded here."""
        if self.here:
            return recording
        home, origin = np.array(rotation.conjugate(np.array(self.turn))), np.array(self.origin)
        ways: Mapping[str, Callable[[Array], Array]] = {
            "positions": lambda there: rotation.rotate(home, there - origin) / self.scale,
            "orientations": lambda there: rotation.multiply(home, there),
            "velocities": lambda there: rotation.rotate(home, there) / self.scale,
            "angular_velocities": lambda there: rotation.rotate(home, there),
        }
        arrays: dict[str, Any] = {}
        for name, way in ways.items():
            fields = (field for field in (name, f"inside_{name}", f"raw_{name}") if hasattr(recording, field))
            arrays |= {field: np.asarray(way(getattr(recording, field))) for field in fields}
        return replace(recording, **arrays)
