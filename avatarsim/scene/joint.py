"""Joints of an avatar: rigid, up to three hinges that share a centre, or a native ball with swing and twist limits.

The paper builds a ball and socket from three planar joints with a common centre; `Hinges` says exactly that.
`Ball` is the same joint without gimbal lock, and its limits are stated once: a cone for the limb's direction and
an interval for the twist about it. `ReachCone` carries a spherical polygon as data.
"""

from dataclasses import dataclass

import numpy as np

from avatarsim.errors import InvalidScene
from avatarsim.scene.checks import Vector, finite_array, pair, unit_vector, within

PI = float(np.pi)
MANY_TURNS = 64.0 * PI
"""Widest hinge limit [rad]. A hinge without a stop gets +- this; wider would lose digits of the angle."""


@dataclass(frozen=True)
class Hinge:
    """One planar joint: unit `axis` in the link frame, `lower` and `upper` limit [rad]."""

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
    """One to three hinges that share the joint's centre, the first one nearest the parent."""

    hinges: tuple[Hinge, ...]

    def __post_init__(self) -> None:
        if not 1 <= len(self.hinges) <= 3:
            raise InvalidScene("number of hinges that share a centre", len(self.hinges), "1 to 3")


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


@dataclass(frozen=True)
class SwingTwist:
    """Limits of a ball joint: the limb's `axis` (link frame) stays within `swing` [rad] of `centre` (parent frame);
    the twist about it, counted from the shortest turn of `axis` onto `centre`, stays in `twist` [rad]."""

    axis: Vector
    centre: Vector
    swing: float
    twist: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", unit_vector("swing axis", self.axis))
        object.__setattr__(self, "centre", unit_vector("swing centre", self.centre))
        # at a swing of pi the twist is undefined: stay clear of it
        within("swing limit [rad]", self.swing, 0.0, 0.95 * PI)
        low, high = pair("twist limits [rad]", self.twist)
        if not within("lower twist limit [rad]", low, -PI, PI) <= within("upper twist limit [rad]", high, -PI, PI):
            raise InvalidScene("twist limits (lower, upper) [rad]", self.twist, "lower at most upper")


@dataclass(frozen=True)
class Ball:
    """A ball and socket; without `limits` it turns freely. `cone` narrows the directions further, as data."""

    limits: SwingTwist | None = None
    cone: ReachCone | None = None


@dataclass(frozen=True)
class Free:
    """Six degrees of freedom: the root of an avatar that goes where the user goes."""


Joint = Rigid | Hinges | Ball | Free
