"""Limits of joints by the part of the body that they move: mean ranges of motion (AAOS; Boone and Azen 1979; Kurz; ASSH).

A ball gets a circular cone that contains the ends of its range, and an interval of twist; knees also a spherical polygon
(Wilhelms and Van Gelder 2001), as they do not bend sideways. A hinge gets the range of the movement that its axis makes. All are
counted from the anatomical position, which is a standing posture of the skeleton (`stance`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.anthropometry import Part
from avatarsim.assets.models.ball_limits import swing_and_twist
from avatarsim.assets.models.skeleton import Skeleton
from avatarsim.assets.models.stance import Stance
from avatarsim.scene.joint import MANY_TURNS, WIDEST_SWING, Ball, Hinge, Hinges, ReachCone, SwingTwist
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

SLACK = 10.0
"""Degrees by which each end is widened: ranges are means of subjects, and joints of recorded skeletons are fits that miss the
anatomical ones. Less: walks of well recorded clips leave straight knees' limits; more: knees bend forward visibly."""


@dataclass(frozen=True)
class Range:
    """Ends of a range of motion [degrees]: flexion, extension, outward (abduction), inward; medial and lateral twist."""

    flexion: float
    extension: float
    outward: float
    inward: float
    medial: float
    lateral: float


RANGES = {
    "spine": Range(75.0, 30.0, 35.0, 35.0, 45.0, 45.0),
    "neck": Range(80.0, 55.0, 35.0, 35.0, 70.0, 70.0),
    "head": Range(80.0, 55.0, 35.0, 35.0, 70.0, 70.0),
    "upper arm": Range(180.0, 60.0, 180.0, 45.0, 70.0, 90.0),
    "forearm": Range(150.0, 0.0, 0.0, 0.0, 80.0, 80.0),
    "hand": Range(80.0, 70.0, 20.0, 35.0, 80.0, 80.0),
    "finger": Range(100.0, 45.0, 20.0, 20.0, 10.0, 10.0),
    "thigh": Range(125.0, 30.0, 45.0, 25.0, 40.0, 60.0),
    "shank": Range(140.0, 0.0, 0.0, 0.0, 30.0, 30.0),
    "foot": Range(20.0, 50.0, 30.0, 30.0, 35.0, 25.0),
}
"""Ranges by kind of part. The hand's twist is the forearm's, which recordings put into either joint; the twist of knee and finger
and the foot's turn to the sides are not in the tables and are estimated here. A spine of several joints has the range of the
whole spine in each: some recordings bend it in one of them. Thumbs have none: formats agree on no frame of their base."""

BENT_ONE_WAY = ("shank",)
"""Parts whose joint bends in one plane. Elbows do as well, but recordings divide the twist of the arm between shoulder and elbow
arbitrarily, so that the plane is not known."""

SHOULDER = (
    (0.0, 0.0, 1.0), (-0.87, 0.0, -0.5), (0.77, -0.64, 0.0), (-0.71, 0.71, 0.0), (0.0, -0.71, -0.71), (0.0, 1.0, 0.0),
    (1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.71, 0.71, 0.0),
)
"""Directions (forward, left, up) of a left arm at the ends of its range: flexion 180 degrees, extension 60, horizontal flexion
130 and extension 45 at shoulder height, adduction 45; and within it, to mark the inside: abduction and flexion 90, between
the two, and hanging."""

ANY_TWIST = (-float(np.pi), float(np.pi))
"""Limits of an unlimited twist [rad]: for joints whose interval would cross half a turn, which limits cannot represent."""

CORNERS = 45.0
"""Degrees between corners of a polygon along its sides: these are arcs of great circles, which bulge by a degree between them."""


@dataclass(frozen=True, eq=False)
class Movement:
    """Movement of a part by its joint, in the world in the stance, as unit vectors: `neutral` (direction of the part in the
    anatomical position), `flexed` (by flexion), `outward` (by abduction), and `own`, its direction in the stance."""

    neutral: Array
    flexed: Array
    outward: Array
    own: Array

    def direction(self, flexion: float, outward: float) -> Array:
        """Return the direction of the part after flexion and then a turn outward [degrees]."""
        a, b = np.radians(flexion), np.radians(outward)
        return np.asarray(np.cos(b) * (np.cos(a) * self.neutral + np.sin(a) * self.flexed) + np.sin(b) * self.outward)


def limited(skeleton: Skeleton, k: int, named: Sequence[Part], stance: Stance | None) -> Ball | Hinges:
    """Return the joint of bone k with its range of motion.
    The file's own limits of a hinge take precedence; an unknown part, and one without an entry in the table, has none."""
    bone, part = skeleton.bones[k], named[k]
    moved = _movement(skeleton, k, part, stance) if stance is not None and part.kind in RANGES else None
    if len(bone.axes) == 3:
        return Ball() if moved is None or stance is None else _ball(skeleton, k, part, moved, stance)
    if bone.limits:
        stated = zip(bone.axes, bone.limits, strict=True)
        return Hinges(tuple(Hinge(axis, max(low, -MANY_TURNS), min(high, MANY_TURNS)) for axis, (low, high) in stated))
    if moved is None or stance is None:
        return Hinges(tuple(Hinge(axis) for axis in bone.axes))
    first = sum(len(other.axes) for other in skeleton.bones[1:k] if len(other.axes) < 3)
    return Hinges(tuple(
        _hinge(bone.axes[h], part, moved, stance, bone.parent, float(stance.angles[first + h])) for h in range(len(bone.axes))
    ))


def _movement(skeleton: Skeleton, k: int, part: Part, stance: Stance) -> Movement:
    """Return the movement of bone k, whose kind is in the table."""
    bone = skeleton.bones[k]
    ends = skeleton.ends(k)
    along = _unit(rotation.rotate(stance.turned[bone.parent], bone.offset), -stance.up)
    own = _unit(rotation.rotate(stance.turned[k], np.mean(ends, axis=0)), along) if ends else along
    outward = -stance.left if part.side == "right" else stance.left
    if part.kind in ("spine", "neck", "head"):
        return Movement(own, _across(stance.forward, own, stance.up), _across(stance.left, own, stance.up), own)
    if part.kind == "thigh":
        return Movement(-stance.up, stance.forward, outward, own)
    if part.kind == "shank":
        return Movement(along, _across(-stance.forward, along, stance.up), _across(outward, along, stance.up), own)
    if part.kind == "foot":
        return Movement(own, _across(stance.up, own, -stance.forward), _across(outward, own, stance.up), own)
    if part.kind == "upper arm":
        return Movement(-stance.up, stance.forward, outward, own)
    front = _across(stance.forward, along, stance.up)
    palm = rotation.cross(along, front) if part.side != "right" else rotation.cross(front, along)
    if part.kind == "forearm":
        return Movement(along, front, palm, own)
    if part.kind == "hand":
        return Movement(along, palm, front, own)
    return Movement(own, _across(palm, own, front), _across(front, own, palm), own)


def _unit(vector: Array, otherwise: Array) -> Array:
    """Return the direction of a vector; another one for a vector without length."""
    length = float(np.linalg.norm(vector))
    return np.asarray(vector / length if length > 1e-9 else otherwise)


def _across(vector: Array, along: Array, otherwise: Array) -> Array:
    """Return the direction of a vector's part at right angles to the unit vector `along`; of another if there is hardly any."""
    for chosen in (vector, otherwise):
        part = chosen - along * (along @ chosen)
        if np.linalg.norm(part) > 0.1:
            return np.asarray(part / np.linalg.norm(part))
    return rotation.rotate(rotation.between((0.0, 0.0, 1.0), along), (1.0, 0.0, 0.0))


def _ball(skeleton: Skeleton, k: int, part: Part, moved: Movement, stance: Stance) -> Ball:
    """Return the limits of a ball, in the frame of the parent."""
    bone, reach = skeleton.bones[k], RANGES[part.kind]
    to_parent = rotation.conjugate(stance.turned[bone.parent])
    cone = None
    if part.kind == "upper arm":
        mirror = np.array([1.0, -1.0 if part.side == "right" else 1.0, 1.0])
        basis = np.stack([stance.forward, stance.left, stance.up])
        middle, swing = _shoulder()
        centre, swing = (middle * mirror) @ basis, swing + np.radians(SLACK)
    else:
        centre = moved.direction(0.5 * (reach.flexion - reach.extension), 0.5 * (reach.outward - reach.inward))
        ends = _outline(moved, reach, part.kind in BENT_ONE_WAY)
        swing = max(float(np.arctan2(np.linalg.norm(np.cross(centre, end)), centre @ end)) for end in ends)
        if part.kind in BENT_ONE_WAY:
            cone = _polygon(rotation.rotate(to_parent, np.array(ends)), rotation.rotate(to_parent, centre))
    axis = rotation.rotate(rotation.conjugate(stance.turned[k]), moved.own)
    centre = rotation.rotate(to_parent, centre)
    _, twisted = swing_and_twist(stance.rotations[k], axis, centre)
    inner, outer = (np.radians(end + SLACK) for end in (reach.medial, reach.lateral))
    low, high = (twisted - outer, twisted + inner) if part.side != "right" else (twisted - inner, twisted + outer)
    if not (low >= -np.pi and high <= np.pi):
        low, high = ANY_TWIST
    limits = SwingTwist(tuple(axis), tuple(centre), min(swing, WIDEST_SWING), (float(low), float(high)))
    return Ball(limits, cone)


def _outline(moved: Movement, reach: Range, corners: bool) -> list[Array]:
    """Return directions at the ends of a range, with the slack: the four ends, or corners of a polygon around all of it."""
    low, high = -reach.extension - SLACK, reach.flexion + SLACK
    inward, outward = -reach.inward - SLACK, reach.outward + SLACK
    if not corners:
        middle, side = 0.5 * (low + high), 0.5 * (inward + outward)
        return [moved.direction(a, b) for a, b in ((low, side), (high, side), (middle, inward), (middle, outward))]
    along = np.linspace(low, high, int(np.ceil((high - low) / CORNERS)) + 1)
    return [*(moved.direction(a, inward) for a in along), *(moved.direction(a, outward) for a in along[::-1])]


def _polygon(corners: Array, seen: Array) -> ReachCone:
    """Return a reach cone of corners in either order around the point that sees all edges."""
    turned = float(sum(np.cross(a, b) @ seen for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)))
    return ReachCone(corners if turned > 0.0 else corners[::-1], tuple(seen))


@cache
def _shoulder() -> tuple[Array, float]:
    """Return centre (forward, left, up) and half angle [rad] of the smallest cone, to a degree, of a left arm's directions."""
    ends = np.array(SHOULDER) / np.linalg.norm(SHOULDER, axis=1)[:, None]
    k = np.arange(20_000) + 0.5
    height, turn = 1.0 - 2.0 * k / len(k), np.pi * (1.0 + np.sqrt(5.0)) * k
    ring = np.sqrt(1.0 - height * height)
    spread = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=-1)
    centre = spread[np.argmax((spread @ ends.T).min(axis=1))]
    return centre, max(float(np.arctan2(np.linalg.norm(np.cross(centre, end)), centre @ end)) for end in ends)


def _hinge(axis: tuple[float, float, float], part: Part, moved: Movement, stance: Stance, parent: int, angle: float) -> Hinge:
    """Return a hinge with the range of its movement: flexion, a turn outward or twist, whichever it makes most of."""
    reach = RANGES[part.kind]
    about = rotation.rotate(stance.turned[parent], axis)
    way = rotation.cross(about, moved.own)
    shares = {"twist": float(about @ moved.own), "flexion": float(way @ moved.flexed), "outward": float(way @ moved.outward)}
    kind = max(shares, key=lambda one: abs(shares[one]))
    at, low, high = 0.0, -reach.lateral, reach.medial
    if kind == "twist" and part.side == "right":
        low, high = -reach.medial, reach.lateral
    if kind == "flexion":
        at, low, high = _angle(moved, moved.flexed), -reach.extension, reach.flexion
    if kind == "outward":
        at, low, high = _angle(moved, moved.outward), -reach.inward, reach.outward
    low, high = low - SLACK - at, high + SLACK - at
    if shares[kind] < 0.0:
        low, high = -high, -low
    return Hinge(axis, angle + float(np.radians(low)), angle + float(np.radians(high)))


def _angle(moved: Movement, towards: Array) -> float:
    """Return the angle [degrees] by which the part is moved from its neutral direction towards another, in the stance."""
    return float(np.degrees(np.arctan2(moved.own @ towards, moved.own @ moved.neutral)))
