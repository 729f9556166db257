"""What a scene's `expects` may hold beyond drops: closed forms and invariants as data, each read by one measure."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from avatarsim.scene.checks import Vector

OfTime = Callable[[float], Sequence[float]]
"""Three numbers at a time [s] since the start."""


@dataclass(frozen=True, eq=False)
class Course:
    """Key "courses": where the closed form has a body from `since` to `until` [s]; what is None is not stated.

    `position` [m] of the body frame, `velocity` [m/s] of the centre of mass, `spin` [rad/s] in world axes.
    """

    body: str
    position: OfTime | None = None
    velocity: OfTime | None = None
    spin: OfTime | None = None
    since: float = 0.0
    until: float = math.inf


@dataclass(frozen=True)
class Rest:
    """Key "rests": from `since` [s] on these bodies stand where they are."""

    bodies: tuple[str, ...]
    since: float


@dataclass(frozen=True)
class Tower:
    """Key "towers": a body with `ratio` times the mass of what carries it stands at `place` [m] from `since` [s] on."""

    body: str
    ratio: float
    place: Vector
    since: float


@dataclass(frozen=True)
class Stop:
    """Key "stops": a body slides `distance` [m] along the unit vector `direction` and stops before the time `by` [s]."""

    body: str
    distance: float
    direction: Vector
    by: float


@dataclass(frozen=True)
class Flips:
    """Key "flips": the angular velocity of a free body about its own `axis` (0, 1, 2) is zero at `times` [s]."""

    body: str
    axis: int
    times: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Pivot:
    """Key "pivots": a body whose own z axis leans at an angle a from upright turns at `rate(a)` [rad/s], until `until` [rad]."""

    body: str
    rate: Callable[[float], float]
    until: float


def steady(x: float, y: float, z: float) -> OfTime:
    """The same three numbers at any time."""
    return lambda time: (x, y, z)


def uniform(start: Sequence[float], velocity: Sequence[float], acceleration: Sequence[float] = (0.0, 0.0, 0.0)) -> OfTime:
    """start + velocity t + acceleration t^2 / 2."""
    return lambda t: tuple(s + v * t + 0.5 * a * t * t for s, v, a in zip(start, velocity, acceleration, strict=True))
