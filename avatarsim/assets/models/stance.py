"""A posture of a recorded skeleton in which the body's own directions are known: forward, left and up of an upright stance.

Ranges of motion are counted from the anatomical position. Many skeletons are upright at rest, with every joint at zero; those
of some tools are folded along one axis at rest, and the most upright frame of the clip takes its place.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.anthropometry import Part
from avatarsim.assets.models.skeleton import Skeleton
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

UPRIGHT = 0.7
"""Cosine of the angle (45 degrees) between trunk and legs up to which a posture counts as standing."""

STRAIGHT = 0.9
"""Distance of hip and foot, as a share of the leg's bones, from which a leg counts as straight."""


@dataclass(frozen=True, eq=False)
class Stance:
    """A standing posture: unit vectors `forward`, `left` and `up` (3,) of the body in the world, `places` (bones, 3) [m] and
    orientations `turned` (bones, 4) of the bones in the world, and the posture, as in TrackerSample."""

    forward: Array
    left: Array
    up: Array
    places: Array
    turned: Array
    rotations: Array
    angles: Array


def stance(
    skeleton: Skeleton, named: Sequence[Part], clip: Motion, at_rest: bool = True
) -> tuple[Stance | None, int | None]:
    """Return a standing posture, `at_rest` or else the most upright one of a clip, and its frame; None for rest and for none."""
    rest, _ = _upright(skeleton, named, *skeleton.poses(*skeleton.still), *skeleton.still[1:])
    if rest is not None and at_rest:
        return rest, None
    best, found, best_frame = -1.0, None, None
    places, turned = skeleton.poses(clip.positions, clip.rotations, clip.angles)
    for frame in range(len(clip)):
        standing, cosine = _upright(skeleton, named, places[frame], turned[frame], clip.rotations[frame], clip.angles[frame])
        if standing is not None and cosine > best:
            best, found, best_frame = cosine, standing, frame
    return found, best_frame


def _upright(
    skeleton: Skeleton, named: Sequence[Part], places: Array, turned: Array, rotations: Array, angles: Array
) -> tuple[Stance | None, float]:
    """Return the posture as a stance, if it is one, and the cosine between trunk and legs."""
    at = {kind: _of_kind(named, kind) for kind in ("head", "neck", "foot", "toe")}
    hips = [[k for k in _of_kind(named, "thigh") if named[k].side == side] for side in ("left", "right")]
    head, feet = at["head"] or at["neck"], at["foot"] or at["toe"]
    if not (head and feet and all(hips)):
        return None, -1.0
    left, right = places[hips[0][0]], places[hips[1][0]]
    middle = 0.5 * (left + right)
    trunk, legs = places[head[0]] - middle, middle - np.mean(places[feet], axis=0)
    lengths = np.linalg.norm(trunk) * np.linalg.norm(legs)
    cosine = float(trunk @ legs / lengths) if lengths > 0.0 else -1.0
    if not (cosine > UPRIGHT and all(_straight(skeleton, places, hip[0], feet) for hip in hips)):
        return None, cosine
    up = (trunk + legs) / np.linalg.norm(trunk + legs)
    side = left - right
    side -= up * (up @ side)
    if not np.linalg.norm(side) > 0.0:
        return None, cosine
    side /= np.linalg.norm(side)
    return Stance(rotation.cross(side, up), side, up, places, turned, rotations, angles), cosine


def _of_kind(named: Sequence[Part], kind: str) -> list[int]:
    return [k for k, part in enumerate(named) if part.kind == kind]


def _straight(skeleton: Skeleton, places: Array, hip: int, feet: Sequence[int]) -> bool:
    """Return True if the leg below a hip is straight, as far as a foot of it is known."""
    for foot in feet:
        length, bone = 0.0, foot
        while bone not in (hip, -1):
            length += float(np.linalg.norm(skeleton.bones[bone].offset))
            bone = skeleton.bones[bone].parent
        if bone == hip and length > 0.0 and not np.linalg.norm(places[foot] - places[hip]) >= STRAIGHT * length:
            return False
    return True
