"""Joints of an avatar: rigid, up to three hinges that share a centre, a slide, or a native ball with swing and twist limits.

The paper builds a ball and socket from three planar joints with a common centre; `Hinges` is exactly that. `Ball` is the same
joint without gimbal lock, and its limits are stated once: a cone for the limb's direction and an interval for the twist about it.
`ReachCone` narrows the directions to a spherical polygon.

Reach cones: the directions that a limb may take, as a spherical polygon (Wilhelms and Van Gelder).
"""

from dataclasses import dataclass

import numpy as np

from avatarsim.errors import InvalidScene
from avatarsim.scene.checks import Vector, each, finite_array, instance, pair, unit_vector, within

SHORTEST_EDGE, LOWEST_SIGHT = 1e-6, 1e-6
"""A reach cone's edges and the heights from which they are seen, as sines: below, rounding decides which side is inside."""


def angle(a: np.typing.NDArray[np.float64], b: np.typing.NDArray[np.float64]) -> float:
    """Return the angle [rad] of two unit vectors (3,)."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


@dataclass(frozen=True, eq=False)
class ReachCone:
    """Directions that a limb may take, as a spherical polygon of unit `vertices` (n, 3) in the parent frame,
    counter-clockwise seen from outside, with a point inside that sees every edge (Wilhelms and Van Gelder)."""

    vertices: np.typing.NDArray[np.float64]
    visible_point: Vector

    def __post_init__(self) -> None:
        vertices = finite_array("reach cone vertices", self.vertices, (-1, 3))
        lengths = np.linalg.norm(vertices, axis=1)
        if len(vertices) < 3 or not (lengths > 1e-12).all():
            raise InvalidScene("reach cone vertices", vertices.tolist(), "at least 3 directions of non-zero length")
        vertices /= lengths[:, None]
        vertices.flags.writeable = False
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "visible_point", unit_vector("visible point of the reach cone", self.visible_point))
        self._require_sight()

    def _require_sight(self) -> None:
        """Raise unless each edge is seen from inside, once around: else the triangles of point and edges are not the polygon."""
        seen, ends = np.array(self.visible_point), np.roll(self.vertices, -1, axis=0)
        normals = np.cross(self.vertices, ends)
        lengths = np.linalg.norm(normals, axis=1)
        if not (lengths > SHORTEST_EDGE).all():
            raise InvalidScene("edge of the reach cone: sine of its length", float(lengths.min()), f"above {SHORTEST_EDGE:g}")
        sines = normals @ seen / lengths
        if not (sines > LOWEST_SIGHT).all():
            thing = "visible point of the reach cone: sine of its height above an edge"
            raise InvalidScene(thing, float(sines.min()), f"above {LOWEST_SIGHT:g}, with corners counter-clockwise from outside")
        flat = self.vertices - np.outer(self.vertices @ seen, seen)
        turns = np.arctan2(np.cross(flat, np.roll(flat, -1, axis=0)) @ seen, (flat * np.roll(flat, -1, axis=0)).sum(axis=1))
        if not abs(turns.sum() - 2.0 * np.pi) < 1e-6:
            once = float(turns.sum() / (2.0 * np.pi))
            raise InvalidScene("turns of the reach cone's corners around its visible point", once, "1")


PI = float(np.pi)
WIDEST_SWING = 0.95 * PI
"""Widest swing limit [rad]: at a swing of pi the twist is undefined; nearer to it rounding decides the twist."""

MANY_TURNS = 64.0 * PI
"""Widest hinge limit [rad]. A hinge without a stop gets +- this; wider would lose digits of the angle."""

LONGEST_SLIDE = 1e3
"""Farthest limit of a slide [m]. A slide without a stop gets +- this; farther would lose digits of the gaps around it."""


@dataclass(frozen=True)
class Hinge:
    """One planar joint: `axis` in the link frame, made a unit vector, `lower` and `upper` limit [rad].

    Raises InvalidScene for an axis without length, and for limits in the wrong order."""

    axis: Vector
    lower: float = -MANY_TURNS
    upper: float = MANY_TURNS

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", unit_vector("hinge axis", self.axis))
        within("lower hinge limit [rad]", self.lower, -MANY_TURNS, MANY_TURNS)
        within("upper hinge limit [rad]", self.upper, -MANY_TURNS, MANY_TURNS)
        if not self.lower <= self.upper:
            raise InvalidScene("hinge limits (lower, upper) [rad]", (self.lower, self.upper), "lower at most upper")


@dataclass(frozen=True)
class Rigid:
    """The link does not move against its parent."""


@dataclass(frozen=True)
class Hinges:
    """One to three hinges that share the joint's centre, the first one nearest the parent; InvalidScene for others."""

    hinges: tuple[Hinge, ...]

    def __post_init__(self) -> None:
        each("hinges of a joint", self.hinges, Hinge, "a Hinge(axis, lower, upper)")
        if not 1 <= len(self.hinges) <= 3:
            raise InvalidScene("number of hinges that share a centre", len(self.hinges), "1 to 3")


@dataclass(frozen=True)
class Slide:
    """A prismatic joint along `axis` in the link frame, made a unit vector; `lower` and `upper` limit [m].

    Raises InvalidScene for an axis without length, and for limits in the wrong order."""

    axis: Vector
    lower: float = -LONGEST_SLIDE
    upper: float = LONGEST_SLIDE

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", unit_vector("slide axis", self.axis))
        within("lower slide limit [m]", self.lower, -LONGEST_SLIDE, LONGEST_SLIDE)
        within("upper slide limit [m]", self.upper, -LONGEST_SLIDE, LONGEST_SLIDE)
        if not self.lower <= self.upper:
            raise InvalidScene("slide limits (lower, upper) [m]", (self.lower, self.upper), "lower at most upper")


@dataclass(frozen=True)
class SwingTwist:
    """Limits of a ball joint: the limb's `axis` (link frame) stays within `swing` [rad] of `centre` (parent frame);
    the twist about it, counted from the shortest turn of `axis` onto `centre`, stays in `twist` [rad].

    Raises InvalidScene for a swing above 0.95 pi, and a twist beyond half a turn or in the wrong order."""

    axis: Vector
    centre: Vector
    swing: float
    twist: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", unit_vector("swing axis", self.axis))
        object.__setattr__(self, "centre", unit_vector("swing centre", self.centre))
        within("swing limit [rad]", self.swing, 0.0, WIDEST_SWING)
        lower, upper = pair("twist limits [rad]", self.twist)
        twist = within("lower twist limit [rad]", lower, -PI, PI), within("upper twist limit [rad]", upper, -PI, PI)
        if not twist[0] <= twist[1]:
            raise InvalidScene("twist limits (lower, upper) [rad]", twist, "lower at most upper")
        object.__setattr__(self, "twist", twist)


@dataclass(frozen=True)
class Ball:
    """A ball and socket; without `limits` it turns freely. `cone` narrows the directions of the limb further.

    The limb is the `axis` of the limits; without limits it is the axis that points to the cone's visible point at zero.
    """

    limits: SwingTwist | None = None
    cone: ReachCone | None = None

    def __post_init__(self) -> None:
        instance("limits of a ball joint", self.limits, SwingTwist | None, "a SwingTwist(axis, centre, swing, twist), or None")
        instance("cone of a ball joint", self.cone, ReachCone | None, "a ReachCone(vertices, visible_point), or None")
        if self.limits is None or self.cone is None:
            return
        away = angle(np.array(self.limits.centre), np.array(self.cone.visible_point))
        if not away < self.limits.swing:
            thing = "angle from the swing centre to the visible point of the reach cone [rad]"
            raise InvalidScene(thing, away, f"below {self.limits.swing:g}")


@dataclass(frozen=True)
class Free:
    """Six degrees of freedom: the root of an avatar that goes where the user goes."""


Joint = Rigid | Hinges | Slide | Ball | Free


SMALLEST_RATIO, LARGEST_RATIO = 1e-3, 1e3
"""Ratios of a coupling, without their signs: beyond, the digits of one joint are lost in the other."""


@dataclass(frozen=True)
class Coupling:
    """One hinge or slide of an avatar that follows another: its coordinate is `ratio` times the leader's plus `offset` [rad, m].

    `follower` and `leader` are numbers among the avatar's angles, link by link; the leader has the lower number. Raises
    InvalidScene for others and for a ratio of which the size is not from 0.001 to 1000."""

    follower: int
    leader: int
    ratio: float
    offset: float = 0.0

    def __post_init__(self) -> None:
        for name in ("follower", "leader"):
            number = getattr(self, name)
            if isinstance(number, bool) or not isinstance(number, int):
                raise InvalidScene(f"{name} of a coupling", number, "the number of an angle of the avatar")
        if not 0 <= self.leader < self.follower:
            raise InvalidScene("leader of a coupling", self.leader, f"an angle before its follower's, which is {self.follower}")
        within("size of the ratio of a coupling", abs(self.ratio), SMALLEST_RATIO, LARGEST_RATIO)
        within("offset of a coupling [rad, m]", self.offset, -LONGEST_SLIDE, LONGEST_SLIDE)


def axes_of(joint: Joint) -> tuple[Hinge | Slide, ...]:
    """Return the hinges of a joint, or its slide: one for each number of `TrackerSample.angles`."""
    if isinstance(joint, Hinges):
        return joint.hinges
    return (joint,) if isinstance(joint, Slide) else ()


def unit_of(axis: Hinge | Slide) -> str:
    """Return the unit of the coordinate of a hinge or a slide: rad or m."""
    return "m" if isinstance(axis, Slide) else "rad"
