"""Projection of a ball's turn into its swing cone, reach cone and twist interval (Wilhelms and Van Gelder 2001), in plain Python.

The twin of `inside_cone` of `avatarsim/model/joint_limits.py`, which takes the engine's arrays; its comments say what swing and
twist are. Where polygon and cone both say no, the limb goes to the nearest of: the foot on an edge, the foot on the circle, the
place where the arc to the point that sees every edge enters.
"""

from dataclasses import dataclass
from math import atan2, cos, pi, sin

from avatarsim.live.drive.turns import (
    NO_LENGTH,
    about,
    add,
    any_normal,
    between,
    conjugate,
    cross,
    dot,
    exp,
    multiply,
    norm,
    normalised,
    rotate,
    scaled,
    sub,
)
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.joint import WIDEST_SWING, Ball

INWARD = 1e-7
"""[rad] by which a projected turn is inside its limits, so that rounding of quaternions never shows as an excess. Its twin's is
1e-9: what is clipped here is so far inside there that the engine leaves it alone, also after it has gone through a sample."""

OFF_THE_EDGE = 1e-5
"""Share of the way to the point that sees all edges by which a limb on an edge is inside: a thousandth of a degree, and of the
sight of any edge, which is a hundredth at least in a useful polygon, still more than `INWARD`."""

HALVINGS = 30
"""Of the arc to the point that sees all edges: what is left of it, at most pi, is below `INWARD`."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Of a ball: `axis` of the limb in the link's frame, `centre` in the parent's, `swing` and `twist` [rad], `untwist`, the
    inverse of the turn from which twist is counted; and of a reach cone the edges (start, end, normal inside) and the point
    inside that sees them all."""

    axis: Vector
    centre: Vector
    swing: float
    twist: tuple[float, float]
    untwist: Quaternion
    edges: tuple[tuple[Vector, Vector, Vector], ...]
    seen: Vector

    def is_allowed(self, limb: Vector, most: float) -> bool:
        """Return True if a direction swings at most `most` [rad] and is in the polygon, if there is one."""
        return _angle(limb, self.centre) <= most and (not self.edges or self._is_in_polygon(limb))

    def _is_in_polygon(self, limb: Vector) -> bool:
        for start, end, inward in self.edges:
            ahead = dot(cross(self.seen, start), limb) >= 0.0 and dot(cross(self.seen, end), limb) <= 0.0
            if ahead and dot(inward, limb) >= INWARD:
                return True
        return False

    def nearest(self, limb: Vector, most: float) -> Vector:
        """The allowed direction that is nearest to a limb's, or nearly so."""
        if self.is_allowed(limb, most):
            return limb
        if not self.edges:
            return _on_circle(self.centre, most, limb)
        found = [_on_circle(self.centre, most, limb)]
        # a place on an edge is moved a little to the point that sees all, which takes it off the other edge of a corner as well
        edged = [_on_edge(start, end, inward, limb) for start, end, inward in self.edges]
        found += [_unit(add(one, scaled(sub(self.seen, one), OFF_THE_EDGE))) for one in edged]
        found = [one for one in found if self.is_allowed(one, most)]
        return max([*found, self._entry(limb, most)], key=lambda one: dot(one, limb))

    def _entry(self, limb: Vector, most: float) -> Vector:
        """Where the arc from a direction to the point that sees every edge comes to what is allowed."""
        across = cross(self.seen, limb)
        length, out = norm(across), _angle(self.seen, limb)
        axis = scaled(across, 1.0 / length) if length > NO_LENGTH else any_normal(self.seen)
        low, high = 0.0, 1.0
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            is_in = self.is_allowed(rotate(about(axis, middle * out), self.seen), most)
            low, high = (middle, high) if is_in else (low, middle)
        return rotate(about(axis, low * out), self.seen)


def limits_of(joint: Ball, orientation: Quaternion) -> Limits | None:
    """What limits a ball of a link with this rest orientation; None for one that turns freely."""
    if joint.limits is None and joint.cone is None:
        return None
    edges: tuple[tuple[Vector, Vector, Vector], ...] = ()
    seen = (0.0, 0.0, 1.0)
    if joint.cone is not None:
        seen = joint.cone.visible_point
        corners: list[Vector] = [(x, y, z) for x, y, z in joint.cone.vertices.tolist()]
        edges = tuple(_edge(a, b) for a, b in zip(corners, [*corners[1:], corners[0]], strict=True))
    if joint.limits is None:
        axis, centre, swing, twist = rotate(conjugate(orientation), seen), seen, WIDEST_SWING, (-pi, pi)
    else:
        axis, centre, swing, twist = joint.limits.axis, joint.limits.centre, joint.limits.swing, joint.limits.twist
    return Limits(axis, centre, swing, twist, conjugate(between(axis, centre)), edges, seen)


def inside(limits: Limits, full: Quaternion) -> Quaternion:
    """The turn `full`, from the link's frame to the parent's, or the nearest one that the limits allow, or nearly so."""
    limb = rotate(full, limits.axis)
    swung = between(limits.centre, limb)
    left = multiply(multiply(conjugate(swung), full), limits.untwist)
    twist = 2.0 * atan2(left[1] * limits.centre[0] + left[2] * limits.centre[1] + left[3] * limits.centre[2], left[0])
    twist = atan2(sin(twist), cos(twist))
    low, high = limits.twist
    # half a turn is where any interval that reaches it goes on at its other end
    margin = min(INWARD, 0.5 * (high - low)) if high - low < 2.0 * pi - NO_LENGTH else 0.0
    clipped = twist
    if not low + margin <= twist <= high - margin:
        clipped = low + margin if _apart(twist, low) < _apart(twist, high) else high - margin
    most = max(0.0, limits.swing - INWARD)
    allowed = limits.nearest(limb, most)
    if allowed is limb and clipped == twist:
        return full
    untwisted = multiply(about(limits.centre, clipped), conjugate(limits.untwist))
    return normalised(multiply(between(limits.centre, allowed), untwisted))


def _apart(a: float, b: float) -> float:
    """Angle [rad] between two on the circle."""
    return abs(atan2(sin(a - b), cos(a - b)))


def _angle(a: Vector, b: Vector) -> float:
    return atan2(norm(cross(a, b)), dot(a, b))


def _edge(start: Vector, end: Vector) -> tuple[Vector, Vector, Vector]:
    normal = cross(start, end)
    return start, end, scaled(normal, 1.0 / norm(normal))


def _on_circle(centre: Vector, radius: float, limb: Vector) -> Vector:
    """The direction at angle `radius` [rad] from the centre that is nearest to a limb's; any where all are."""
    across = cross(centre, limb)
    length = norm(across)
    axis = scaled(across, 1.0 / length) if length > NO_LENGTH else any_normal(centre)
    return rotate(exp(scaled(axis, radius)), centre)


def _on_edge(start: Vector, end: Vector, inward: Vector, limb: Vector) -> Vector:
    """The point nearest to a limb's on the great arc from start to end."""
    foot = sub(limb, scaled(inward, dot(inward, limb)))
    length = norm(foot)
    if length > NO_LENGTH:
        foot = scaled(foot, 1.0 / length)
        if dot(cross(inward, start), foot) >= 0.0 and dot(cross(end, inward), foot) >= 0.0:
            return foot
    return start if dot(start, limb) >= dot(end, limb) else end


def _unit(v: Vector) -> Vector:
    return scaled(v, 1.0 / norm(v))
