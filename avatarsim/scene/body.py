"""Fixed and simulated bodies. Driven bodies are avatars, if only of one link (`avatarsim.scene.avatar`).

Mass, centre of mass and inertia of bodies; of solid convex pieces in closed form, of hulls by tetrahedra.

Materials: restitution and friction belong to a *pair* of materials, as in the paper's Table 1.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidScene, UnknownName
from avatarsim.scene.checks import (
    FASTEST,
    FASTEST_SPIN,
    Quaternion,
    Vector,
    bounded,
    each,
    finite_array,
    instance,
    listed,
    name_pairs,
    named,
    place,
    positive,
    unit_quaternion,
    within,
)
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.spatial import rotation

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Mass:
    """`mass` [kg], `centre` of mass in the body frame [m], `inertia` (3, 3) about it, body axes [kg m^2].

    Raises InvalidScene for an inertia that no solid has: not symmetric, or a moment above the sum of the others."""

    mass: float
    centre: Vector = (0.0, 0.0, 0.0)
    inertia: Array = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        positive("mass", self.mass)
        object.__setattr__(self, "centre", place("centre of mass", self.centre))
        inertia = finite_array("inertia", self.inertia, (3, 3))
        if not np.allclose(inertia, inertia.T, rtol=1e-9, atol=1e-12 * np.abs(inertia).max()):
            raise InvalidScene("inertia", inertia.tolist(), "a symmetric matrix")
        moments = np.linalg.eigvalsh(inertia)
        # a real solid obeys the triangle inequality; 1e-9 leaves room for rounding of thin rods
        if not (moments[0] > 0.0 and moments[0] + moments[1] >= moments[2] * (1.0 - 1e-9)):
            raise InvalidScene("principal moments of inertia", moments.tolist(), "positive, none above the sum of the others")
        inertia.flags.writeable = False
        object.__setattr__(self, "inertia", inertia)


def _moments(shape: Shape) -> tuple[float, Array, Array]:
    """Return the volume, centroid and covariance integral of x x^T about the centroid, of one shape in its own frame."""
    if isinstance(shape, ConvexHull):
        return _hull_moments(shape.vertices)
    if isinstance(shape, Sphere):
        volume, second = 4.0 / 3.0 * np.pi * shape.radius**3, np.full(3, shape.radius**2 / 5.0)
    elif isinstance(shape, Ellipsoid):
        radii = np.array(shape.radii)
        volume, second = 4.0 / 3.0 * np.pi * float(np.prod(radii)), radii**2 / 5.0
    elif isinstance(shape, Box):
        size = np.array(shape.size)
        volume, second = float(np.prod(size)), size**2 / 12.0
    else:
        volume, second = _capsule_moments(shape)
    return volume, np.zeros(3), volume * np.diag(second)


def _capsule_moments(shape: Capsule) -> tuple[float, Array]:
    r, length = shape.radius, shape.length
    cylinder, ball = np.pi * r * r * length, 4.0 / 3.0 * np.pi * r**3
    volume = cylinder + ball
    across = (cylinder * r * r / 4.0 + ball * r * r / 5.0) / volume
    # each half ball has its centroid 3 r / 8 beyond the end of the segment
    along = (cylinder * length**2 / 12.0 + ball * (r * r / 5.0 + length**2 / 4.0 + 3.0 * r * length / 8.0)) / volume
    return volume, np.array([across, across, along])


def _hull_moments(vertices: Array) -> tuple[float, Array, Array]:
    """Return exact volume, centroid and covariance of a convex polytope, as a fan of tetrahedra from an inner point."""
    # qhull comes with scipy, which takes a fifth of a second to import: only scenes with hulls pay for it
    from scipy.spatial import ConvexHull as QuickHull

    inner = vertices.mean(axis=0)
    corners = (vertices - inner)[QuickHull(vertices).simplices]
    volumes = np.abs(np.linalg.det(corners)) / 6.0
    volume = float(volumes.sum())
    sums = corners.sum(axis=1)
    centroid = (volumes[:, None] * sums / 4.0).sum(axis=0) / volume
    # covariance of a tetrahedron (0, a, b, c): V/20 (sum p p^T + s s^T), s = a + b + c
    products = np.einsum("tki,tkj->tij", corners, corners) + np.einsum("ti,tj->tij", sums, sums)
    about_inner = (volumes[:, None, None] * products / 20.0).sum(axis=0)
    return volume, centroid + inner, about_inner - volume * np.outer(centroid, centroid)


def volume(shape: Shape) -> float:
    """Return the volume [m^3] of one shape."""
    if not isinstance(shape, Shape):
        raise InvalidScene("shape whose volume is asked for", shape, "a Sphere, Capsule, Box, Ellipsoid or ConvexHull")
    return _moments(shape)[0]


def solid(pieces: Sequence[Piece], mass: float) -> Mass:
    """Return the mass properties of a body of total `mass` [kg], spread evenly over its `pieces` (overlaps count twice).

    Closed forms of the shapes; of hulls, sums over tetrahedra. Raises InvalidScene for no pieces, or a mass that is none."""
    positive("mass", mass)
    given = tuple(listed(pieces))
    each("pieces of a solid", given, Piece, "a Piece(shape)")
    if not given:
        raise InvalidScene("number of pieces of a solid", 0, "at least 1")
    volumes, centres, covariances = [], [], []
    for piece in pieces:
        v, c, s = _moments(piece.shape)
        turn = rotation.to_matrix(piece.orientation)
        volumes.append(v)
        centres.append(turn @ c + np.array(piece.position))
        covariances.append(turn @ s @ turn.T)
    total = sum(volumes)
    centre = sum((v * c for v, c in zip(volumes, centres, strict=True)), np.zeros(3)) / total
    covariance = np.zeros((3, 3))
    for v, c, s in zip(volumes, centres, covariances, strict=True):
        covariance += s + v * np.outer(c - centre, c - centre)
    covariance *= mass / total
    x, y, z = (float(value) for value in centre)
    return Mass(mass, (x, y, z), np.trace(covariance) * np.eye(3) - covariance)


@dataclass(frozen=True)
class ContactLaw:
    """Contact law of a pair of materials: `restitution` (eq. 8, 0 to 1) and Coulomb `friction` (eq. 10, 0 to 100), which have no
    unit. Raises InvalidScene for others."""

    restitution: float
    friction: float

    def __post_init__(self) -> None:
        within("restitution", self.restitution, 0.0, 1.0)
        within("friction", self.friction, 0.0, 100.0)


@dataclass(frozen=True)
class PairTable:
    """The contact law of every unordered pair of material names: `PairTable({("ice", "metal"): ContactLaw(0.1, 0.02)})`.

    Raises InvalidScene for a pair that is stated twice and differently; a scene in which two materials may meet that have no
    pair is refused with UnknownName when it is loaded."""

    pairs: Mapping[tuple[str, str], ContactLaw]

    def __post_init__(self) -> None:
        instance("pairs of a PairTable", self.pairs, Mapping, "a mapping {(name, name): ContactLaw(restitution, friction)}")
        name_pairs("pairs of a PairTable", tuple(self.pairs))
        both_ways = dict[tuple[str, str], ContactLaw]()
        for (a, b), contact in self.pairs.items():
            instance(f"contact of {a} and {b}", contact, ContactLaw, "a ContactLaw(restitution, friction)")
            if both_ways.get((a, b), contact) != contact:
                raise InvalidScene(f"contact of {a} and {b}", contact, f"that of {b} and {a}, {both_ways[a, b]!r}")
            both_ways[a, b] = both_ways[b, a] = contact
        object.__setattr__(self, "pairs", both_ways)

    @property
    def names(self) -> tuple[str, ...]:
        """Return every material that occurs, sorted."""
        return tuple(sorted({name for pair in self.pairs for name in pair}))

    def contact(self, a: str, b: str) -> ContactLaw:
        """Return coefficients of materials a and b, in either order."""
        try:
            return self.pairs[a, b]
        except KeyError:
            raise UnknownName("pair of materials", f"{a}, {b}", (f"{x}, {y}" for x, y in self.pairs)) from None


TABLE_1 = PairTable(
    {
        ("wood", "wood"): ContactLaw(0.3, 0.3),
        ("wood", "human"): ContactLaw(0.2, 0.2),
        ("wood", "metal"): ContactLaw(0.2, 0.1),
        ("human", "human"): ContactLaw(0.1, 0.1),
        ("human", "metal"): ContactLaw(0.2, 0.1),
        ("metal", "metal"): ContactLaw(0.3, 0.1),
    }
)
"""The paper's Table 1: restitution and friction of wood, human and metal."""


class Role(Enum):
    """Role of a body: fixed, moved by the laws of physics, or driven by the user (the paper's three classes)."""

    FIXED = 0
    SIMULATED = 1
    DRIVEN = 2


@dataclass(frozen=True)
class Body:
    """A rigid body: convex pieces, material, first pose, and for simulated ones mass and first velocities.

    `position` [m] and `orientation` (w, x, y, z) place the body frame in the world; `velocity` [m/s] is that of the centre of
    mass, `angular_velocity` [rad/s] is in world axes. Their components are at most `FARTHEST`, `FASTEST` and `FASTEST_SPIN` of
    `avatarsim.scene.checks`, with the reasons.
    """

    name: str
    role: Role
    pieces: tuple[Piece, ...]
    material: str
    position: Vector = (0.0, 0.0, 0.0)
    orientation: Quaternion = rotation.IDENTITY
    mass: Mass | None = None
    velocity: Vector = (0.0, 0.0, 0.0)
    angular_velocity: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        named("a body", self.name)
        instance(f"role of body {self.name}", self.role, Role, "Role.FIXED or Role.SIMULATED")
        each(f"pieces of body {self.name}", self.pieces, Piece, "a Piece(shape)")
        named(f"the material of body {self.name}", self.material)
        instance(f"mass of body {self.name}", self.mass, Mass | None, "a Mass, for instance solid(pieces, kg)")
        if not self.pieces:
            raise InvalidScene(f"number of pieces of body {self.name}", 0, "at least 1")
        if self.role is Role.DRIVEN:
            raise InvalidScene(f"role of body {self.name}", "driven", "fixed or simulated; driven bodies are avatars")
        if self.role is Role.SIMULATED and self.mass is None:
            raise InvalidScene(f"mass of simulated body {self.name}", None, "a Mass, for instance solid(pieces, kg)")
        object.__setattr__(self, "position", place(f"position of {self.name}", self.position))
        object.__setattr__(self, "orientation", unit_quaternion(f"orientation of {self.name}", self.orientation))
        object.__setattr__(self, "velocity", bounded(f"velocity of {self.name} [m/s]", self.velocity, FASTEST))
        spin = bounded(f"angular velocity of {self.name} [rad/s]", self.angular_velocity, FASTEST_SPIN)
        object.__setattr__(self, "angular_velocity", spin)
        if self.role is Role.FIXED and any((*self.velocity, *self.angular_velocity)):
            raise InvalidScene(f"velocity of fixed body {self.name}", (*self.velocity, *spin), "zero: what is fixed never moves")


def fixed(name: str, pieces: tuple[Piece, ...], material: str, position: Vector = (0.0, 0.0, 0.0),
          orientation: Quaternion = rotation.IDENTITY) -> Body:
    """Return a body that stays where it is: furniture, walls, the ground.

    `pieces` in the body's frame, which `position` [m] and `orientation` (w, x, y, z) place in the world; `material` a name of the
    scene's table of pairs. Raises InvalidScene for other values.
    """
    return Body(name, Role.FIXED, pieces, material, position, orientation)


def simulated(name: str, pieces: tuple[Piece, ...], material: str, mass: Mass, position: Vector = (0.0, 0.0, 0.0),
              orientation: Quaternion = rotation.IDENTITY, velocity: Vector = (0.0, 0.0, 0.0),
              angular_velocity: Vector = (0.0, 0.0, 0.0)) -> Body:
    """Return a loose body, which obeys the laws of physics: eqs 7 to 10 of Schmidl and Lin 2004 where it is struck.

    As `fixed`, and with the `mass` of its pieces (see `solid`), the first `velocity` [m/s] of its centre of mass and the first
    `angular_velocity` [rad/s] in world axes. Raises InvalidScene for other values.
    """
    return Body(name, Role.SIMULATED, pieces, material, position, orientation, mass, velocity, angular_velocity)
