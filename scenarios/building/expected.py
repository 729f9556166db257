"""Closed forms and invariants that a scene expects beyond drops, as data, each read by one measure."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from avatarsim.scene.checks import Vector
from reference.closed_form import roll_distance, roll_speed, roll_time, stop_distance, stop_time

OfFloat = Callable[[float], float]
OfTime = Callable[[float], Sequence[float]]
"""Three numbers at a time [s] since the start."""


@dataclass(frozen=True, eq=False)
class Course:
    """Key "courses": where the closed form has a body from `since` to `until` [s]; values of None are not stated.

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
    """Key "rests": from `since` [s] on these bodies stay where they are."""

    bodies: tuple[str, ...]
    since: float


@dataclass(frozen=True)
class Tower:
    """Key "towers": a body with `ratio` times the mass of its support rests at `place` [m] from `since` [s] on."""

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
    """Key "pivots": a body whose z axis leans at an angle a from upright turns at `rate(a)` [rad/s], until `until` [rad]."""

    body: str
    rate: Callable[[float], float]
    until: float


@dataclass(frozen=True, eq=False)
class Top:
    """Key "tops": a body turns about its own z axis at `spin` [rad/s], and that axis about gravity at a mean `precession`."""

    body: str
    spin: float
    precession: float


@dataclass(frozen=True)
class Wave:
    """Key "waves": `bodies` in a row, `pitch` [m] apart, topple one another; from `first` to `last` at `speed` [m/s]."""

    bodies: tuple[str, ...]
    pitch: float
    speed: float
    first: int
    last: int


@dataclass(frozen=True)
class Pile:
    """Key "piles": from `since` [s] on the origins of `bodies` are on the mean `height` [m] above that of the body `floor`."""

    bodies: tuple[str, ...]
    floor: str
    height: float
    since: float


@dataclass(frozen=True)
class Carried:
    """Key "carried": from `since` to `until` [s] the links together carry a body, which stays where it is in their frames."""

    body: str
    links: tuple[str, ...]
    since: float
    until: float = math.inf


@dataclass(frozen=True)
class Pressed:
    """Key "pressed": from `since` to `until` [s] a body is pressed along gravity, and has no reason to go sideways."""

    body: str
    since: float
    until: float = math.inf


@dataclass(frozen=True)
class Sag:
    """Key "sags": from `since` to `until` [s] a loaded link hangs `sag` [m] below its user: by equation 6 load over spring."""

    link: str
    sag: float
    since: float
    until: float = math.inf


def steady(x: float, y: float, z: float) -> OfTime:
    """Return the same three numbers at any time."""
    return lambda time: (x, y, z)


def uniform(start: Sequence[float], velocity: Sequence[float], acceleration: Sequence[float] = (0.0, 0.0, 0.0)) -> OfTime:
    """Return start + velocity t + acceleration t^2 / 2 by time t."""
    return lambda t: tuple(s + v * t + 0.5 * a * t * t for s, v, a in zip(start, velocity, acceleration, strict=True))


def slides_to_stop(speed: float, friction: float, gravity: float) -> tuple[OfFloat, OfFloat]:
    """Return way [m] and speed [m/s] by time of a body that slides over a level floor until it stops."""
    ends, way = stop_time(speed, friction, gravity), stop_distance(speed, friction, gravity)
    return lambda t: way * (1.0 - max(0.0, 1.0 - t / ends) ** 2), lambda t: speed * max(0.0, 1.0 - t / ends)


def slides_to_roll(speed: float, drag: float, begins: float, way: float, end: float) -> tuple[OfFloat, OfFloat]:
    """Return way [m] and speed [m/s] by time of a body that friction slows by `drag` [m/s^2] until it rolls.

    It rolls at `end` [m/s] from the time `begins` [s] and the way `way` [m] on.
    """
    return (
        lambda t: speed * t - 0.5 * drag * t * t if t < begins else way + end * (t - begins),
        lambda t: speed - drag * t if t < begins else end,
    )


def ball_to_roll(speed: float, friction: float, gravity: float) -> tuple[OfFloat, OfFloat]:
    """Return `slides_to_roll` of a ball that begins without spin."""
    begins, way = roll_time(speed, friction, gravity), roll_distance(speed, friction, gravity)
    return slides_to_roll(speed, friction * gravity, begins, way, roll_speed(speed))
