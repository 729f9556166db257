"""Fixed and simulated bodies. Driven bodies are avatars, if only of one link (`avatarsim.scene.avatar`)."""

from dataclasses import dataclass
from enum import Enum

from avatarsim.errors import InvalidScene
from avatarsim.scene.checks import (
    FASTEST,
    FASTEST_SPIN,
    Quaternion,
    Vector,
    bounded,
    each,
    instance,
    named,
    place,
    unit_quaternion,
)
from avatarsim.scene.mass import Mass
from avatarsim.scene.shape import Piece
from avatarsim.spatial import rotation


class Role(Enum):
    """Role of a body: fixed, moved by the laws of physics, or driven by the user (the paper's three classes)."""

    FIXED = 0
    SIMULATED = 1
    DRIVEN = 2


@dataclass(frozen=True)
class Body:
    """A rigid body: convex pieces, material, first pose, and for simulated ones mass and first velocities.

    `position` [m] and `orientation` (w, x, y, z) place the body frame in the world; `velocity` [m/s] is that of
    the centre of mass, `angular_velocity` [rad/s] is in world axes. Their components are at most `FARTHEST`, `FASTEST` and
    `FASTEST_SPIN` of `avatarsim.scene.checks`, where the reasons stand.
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
    """A body that stays where it is: furniture, walls, the ground.

    `pieces` in the body's frame, which `position` [m] and `orientation` (w, x, y, z) place in the world; `material` a name of the
    scene's table of pairs. Raises InvalidScene for what is no such thing.
    """
    return Body(name, Role.FIXED, pieces, material, position, orientation)


def simulated(name: str, pieces: tuple[Piece, ...], material: str, mass: Mass, position: Vector = (0.0, 0.0, 0.0),
              orientation: Quaternion = rotation.IDENTITY, velocity: Vector = (0.0, 0.0, 0.0),
              angular_velocity: Vector = (0.0, 0.0, 0.0)) -> Body:
    """A loose body, which obeys the laws of physics: eqs 7 to 10 of Schmidl and Lin 2004 where it is struck.

    As `fixed`, and with the `mass` of its pieces (see `solid`), the first `velocity` [m/s] of its centre of mass and the first
    `angular_velocity` [rad/s] in world axes. Raises InvalidScene for what is no such thing.
    """
    return Body(name, Role.SIMULATED, pieces, material, position, orientation, mass, velocity, angular_velocity)
