"""A human avatar from a recorded skeleton: capsules along its bones, masses and radii by anthropometry, ranges of motion by name.

The bones' lengths and joints are the recording's; shapes, masses and limits are constructed, not measured on the recorded human,
and the model's notes state it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.anthropometry import (
    ABOVE_KNEE,
    BODY_MASS,
    KNEE,
    MIDDLE,
    RADII,
    SEGMENT_OF,
    SEGMENT_OF_KIND,
    SEGMENTS,
    SHOULDERS,
    STATURE,
    THICKEST,
    THINNEST,
    UNKNOWN_SHARE,
    Part,
    parts,
)
from avatarsim.assets.models.coordinates import Coordinates, Slot
from avatarsim.assets.models.model import Model
from avatarsim.assets.models.range_of_motion import ANY_TWIST, limited
from avatarsim.assets.models.skeleton import Skeleton
from avatarsim.assets.models.stance import Stance, stance
from avatarsim.errors import InvalidInput
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Mass, solid, volume
from avatarsim.scene.checks import positive
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Joint, Rigid
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Capsule, Piece, Sphere, capsule_between
from avatarsim.scene.tracker import rest
from avatarsim.tolerances import POSTURE_GAP

Array = NDArray[np.float64]

SHORTEST_BONE = 2e-3
"""Length [m] below which two joints are at one place, and no capsule lies between them."""

TOUCHING = 1e-4
"""Gap [m] below which a pair of links counts as overlapping at rest: it would be in contact in every frame."""

FLESH = 0.25
"""Share of the thinner link's radius by which a pair that overlaps when standing may be deeper in motion. The shapes are a guess,
and thighs and shoulders press into a trunk: in a recorded dance by 14 mm, a sixth of a thigh. Larger: an arm goes through a chest
unnoticed; smaller: people who sit or shrug count as overlapping."""

LEAST_MASS = 0.01
"""Mass [kg] of a link without pieces: a hundred times less than a hand, negligible in sums."""


def human(
    skeleton: Skeleton, stature: float, clip: Motion, mass: float = BODY_MASS, limits: bool = True, at_rest: bool = True
) -> Model:
    """Return the avatar of a skeleton of `stature` [m] when standing, and of `mass` [kg].

    `clip` are postures of it, among which a standing one is searched where the skeleton is not upright at rest, or its rest pose
    is excluded by `at_rest`. Links that overlap in a standing posture may do so as deep as there (`FLESH`). `limits` gives joints
    of known name their range of motion, other joints none. Raises InvalidInput for sizes that no avatar has, and for an invalid
    mass."""
    positive(f"mass of the avatar of {skeleton.name} [kg]", mass, InvalidInput)
    positive(f"height of the skeleton of {skeleton.name} [m]", stature, InvalidInput)
    named = parts(skeleton)
    standing, frame = stance(skeleton, named, clip, at_rest)
    build = _build(skeleton, named, standing, mass, stature)
    pieces = [_pieces(skeleton, k, named, build) for k in range(len(skeleton.bones))]
    masses = _masses(named, pieces, mass)
    joints = [_joint(skeleton, k, named, standing, limits) for k in range(len(skeleton.bones))]
    links = tuple(
        Link(bone.name, skeleton.bones[bone.parent].name if bone.parent >= 0 else None, joints[k], pieces[k], masses[k],
             anchor=bone.offset if bone.parent >= 0 else (0.0, 0.0, 0.0))
        for k, bone in enumerate(skeleton.bones)
    )
    avatar = Avatar(skeleton.name, links, at_rest=_overlapping(Avatar(skeleton.name, links), standing))
    notes = [
        f"shapes, masses ({mass:g} kg in all) and ranges of motion of {skeleton.name} are a construction by its joints' names "
        "and mean human bodies, not a measurement of what was recorded",
    ]
    unknown = [bone.name for bone, part in zip(skeleton.bones, named, strict=True) if not part.kind]
    if unknown:
        notes.append(f"joints of unknown name, without limits and with radii by the length of their bones: {', '.join(unknown)}")
    if limits and standing is None:
        notes.append("joints without limits: no standing posture, at rest or in the clip, to count ranges of motion from")
    elif limits:
        where = "at rest" if frame is None else "of a frame of the clip"
        notes.append(f"ranges of motion are counted from the standing posture {where}; limits=False leaves joints free")
    limits_of = {link.name: link.joint.limits for link in links if isinstance(link.joint, Ball)}
    free = [name for name, one in limits_of.items() if one is not None and one.twist == ANY_TWIST]
    if free:
        notes.append(f"joints whose twist has no limit, as their frames at rest are turned about too far: {', '.join(free)}")
    if avatar.at_rest:
        listed = ", ".join(f"{a} and {b} by {1e3 * depth:.3g} mm" for a, b, depth in avatar.at_rest)
        notes.append(f"pairs that overlap in a standing posture, and may up to: {listed}")
    return Model(avatar, coordinates(avatar, skeleton), (), tuple(notes))


def coordinates(avatar: Avatar, skeleton: Skeleton) -> Coordinates:
    """Return the generalized coordinates in the file's order: root, then every joint that turns, hinges by the file's names."""
    slots, hinge = [], 0
    for k, (link, bone) in enumerate(zip(avatar.links, skeleton.bones, strict=True)):
        if isinstance(link.joint, Hinges):
            for turn in bone.turns:
                slots.append(Slot(f"{bone.name} {turn}", "hinge", k, hinge))
                hinge += 1
        elif isinstance(link.joint, Ball | Free):
            slots.append(Slot(bone.name, "free" if isinstance(link.joint, Free) else "ball", k))
    return Coordinates(tuple(slots), len(avatar.links), hinge)


def _joint(skeleton: Skeleton, k: int, named: Sequence[Part], standing: Stance | None, limits: bool) -> Joint:
    bone = skeleton.bones[k]
    if bone.parent < 0:
        return Free()
    if not bone.axes:
        return Rigid()
    if limits:
        return limited(skeleton, k, named, standing)
    return Ball() if len(bone.axes) == 3 else Hinges(tuple(Hinge(axis) for axis in bone.axes))


@dataclass(frozen=True)
class Build:
    """Build of a body: its `mass` [kg], its `stature` [m], and the largest radius of its `trunk` [m]."""

    mass: float
    stature: float
    trunk: float

    def radius(self, part: Part, length: float) -> float:
        """Return the radius [m] of a bone of `length` [m]."""
        if part.kind in RADII:
            return RADII[part.kind] * self.stature / STATURE
        if part.kind in SEGMENT_OF:
            found = SEGMENT_OF_KIND[part.kind].radius(self.mass, self.stature)
            return min(found, self.trunk) if SEGMENT_OF[part.kind] == "trunk" else found
        return min(max(UNKNOWN_SHARE * length, THINNEST), THICKEST)


def _build(skeleton: Skeleton, named: Sequence[Part], standing: Stance | None, mass: float, stature: float) -> Build:
    """Return the build of a skeleton: its trunk no deeper than the distance of its shoulder joints allows."""
    arms = [next((k for k, part in enumerate(named) if part == Part("upper arm", side)), -1) for side in ("left", "right")]
    if standing is None or min(arms) < 0:
        return Build(mass, stature, THICKEST)
    apart = float(np.linalg.norm(standing.places[arms[0]] - standing.places[arms[1]]))
    return Build(mass, stature, max(SHOULDERS * 0.5 * apart, THINNEST))


def _pieces(skeleton: Skeleton, k: int, named: Sequence[Part], build: Build) -> tuple[Piece, ...]:
    """Return a capsule to each joint below bone k and to each tip that ends there, and a ball where it has neither."""
    bone, part, children = skeleton.bones[k], named[k], skeleton.children[k]
    if part.kind == "face" or _is_bearer(skeleton, k, named):
        return ()
    found = []
    ending = [skeleton.bones[child].offset for child in children if _is_end(skeleton, child, named)]
    for place in skeleton.ends(k):
        end = np.array(place)
        length = float(np.linalg.norm(end))
        radius = build.radius(part, length)
        if length < SHORTEST_BONE:
            continue
        if place in ending or (not children and place in bone.tips):
            # a capsule to a tip ends there, not a radius beyond it
            end *= max(length - radius, 0.5 * length) / length
        if part.kind == "thigh":
            found.append(capsule_between(np.zeros(3), end, min(radius, KNEE * build.stature / STATURE)))
            end *= ABOVE_KNEE
        found.append(capsule_between(np.zeros(3), end, radius))
    if not found and part.kind and not children and not _is_end(skeleton, k, named):
        found.append(Piece(Sphere(build.radius(part, 0.0))))
    return tuple(found)


def _is_bearer(skeleton: Skeleton, k: int, named: Sequence[Part]) -> bool:
    """Return True if bone k is a root that only carries the hips: no body reaches from the floor to them."""
    children = skeleton.children[k]
    return skeleton.bones[k].parent < 0 and len(children) == 1 and named[children[0]].kind == "pelvis"


def _is_end(skeleton: Skeleton, k: int, named: Sequence[Part]) -> bool:
    """Return True if bone k has no extent and only marks the end of its parent, which is the same part of the body."""
    bone = skeleton.bones[k]
    longest = max((float(np.linalg.norm(end)) for end in skeleton.ends(k)), default=0.0)
    return bone.parent >= 0 and longest < SHORTEST_BONE and named[k] == named[bone.parent]


def _masses(named: Sequence[Part], pieces: Sequence[tuple[Piece, ...]], mass: float) -> list[Mass]:
    """Return masses of the links: a segment's share by the volumes of its links; all by volume where a name is unknown.

    Where segments are missing the others take their place, so that the body weighs `mass` [kg]."""
    volumes = [sum(volume(piece.shape) for piece in of_link) for of_link in pieces]
    known = all(part.kind or not size for part, size in zip(named, volumes, strict=True))
    groups: dict[tuple[str, str], float] = {}
    for part, size in zip(named, volumes, strict=True):
        key = _segment(part, known)
        groups[key] = groups.get(key, 0.0) + size
    shares = {key: SEGMENTS[key[0]].share if known else size for key, size in groups.items() if size > 0.0}
    total = sum(shares.values())
    found = []
    for part, size, of_link in zip(named, volumes, pieces, strict=True):
        if not of_link:
            found.append(solid((Piece(Sphere(THINNEST)),), LEAST_MASS))
            continue
        key = _segment(part, known)
        found.append(solid(of_link, mass * shares[key] / total * size / groups[key]))
    return found


def _segment(part: Part, known: bool) -> tuple[str, str]:
    """Return the unit that shares a mass: a segment, of one side if there are two; all links together for unknown names."""
    if not (known and part.kind):
        return "", ""
    segment = SEGMENT_OF[part.kind]
    return segment, "" if segment in MIDDLE else part.side


def _overlapping(avatar: Avatar, standing: Stance | None) -> tuple[tuple[str, str, float], ...]:
    """Return pairs of links, not a link and its parent, that overlap in a standing posture, and the depth [m] allowed.
    It is the depth there plus the flesh's compression.

    Without a standing one, at rest, and then only siblings and a link with its parent's parent: others may be folded up."""
    # the engine's compiler, which reading a skeleton file does not need
    from avatarsim.model.world import build
    from avatarsim.pose_queries import deepest_overlaps

    links, home = {f"{avatar.name}/{link.name}": link for link in avatar.links}, rest([avatar])
    if standing is not None:
        home = replace(home, rotations=standing.rotations, angles=standing.angles)
    parents = {link.name: link.parent for link in avatar.links}
    found = []
    for overlap in deepest_overlaps(build(Scene(avatar.name, (), (avatar,), start=home)), least=-TOUCHING):
        a, b = links[overlap.a], links[overlap.b]
        near = a.parent == b.parent or parents.get(a.parent or "") == b.name or parents.get(b.parent or "") == a.name
        if near or standing is not None:
            flesh = FLESH * min(max(shape.radius for shape in shapes_of(link)) for link in (a, b))
            found.append((a.name, b.name, max(0.0, overlap.depth) + max(POSTURE_GAP, flesh)))
    return tuple(found)


def shapes_of(link: Link) -> list[Capsule | Sphere]:
    """Return the shapes of a link of a recorded skeleton."""
    return [piece.shape for piece in link.pieces if isinstance(piece.shape, Capsule | Sphere)]
