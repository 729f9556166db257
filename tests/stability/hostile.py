"""Hostile material: avatars, a closed room of thin walls with furniture, and motions no user should make."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from avatarsim.engine import FrameRecord
from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import Body, fixed, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample, link_poses, rest
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

DT = 1.0 / 60.0
ROOM = np.array([[-2.0, -1.5, 0.0], [2.0, 1.5, 2.6]])
"""Inner faces of the walls [m]."""
WALL = 0.01
"""Thickness of the walls [m]."""
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


Turns = tuple[tuple[Vector, float, float], ...]
"""Axis and limits [rad] of each hinge of a joint."""


def bone(
    name: str, parent: str | None, anchor: Vector, centre: Vector, radii: Vector, hinges: Turns, lean: float = 0.0
) -> Link:
    """Return a link of one 52-corner hull; `lean` [rad] turns its rest orientation about x."""
    pieces = (Piece(ellipsoid_hull(radii), centre),)
    joint = Hinges(tuple(Hinge(*hinge) for hinge in hinges)) if hinges else Free()
    w, x, y, z = (float(value) for value in rotation.from_axis_angle(X, lean))
    return Link(
        name, parent, joint, pieces, solid(pieces, 1.0 + 50.0 * float(np.prod(radii))), anchor=anchor, orientation=(w, x, y, z)
    )


def hinged_avatar() -> Avatar:
    """Return sixteen hulls, 37 hinges and a free root; hinges three to a joint, as in the paper."""
    wide = ((X, -2.6, 2.6), (Y, -2.6, 2.6), (Z, -1.5, 1.5))
    hip, ankle = ((X, -0.8, 0.8), (Y, -2.1, 0.6), (Z, -0.8, 0.8)), ((X, -0.5, 0.5), (Y, -0.7, 0.7), (Z, -0.5, 0.5))
    elbow, wrist = ((Y, -2.5, 0.0), (Z, -1.4, 1.4)), ((X, -1.2, 1.2), (Y, -0.5, 0.5))
    links = [
        bone("pelvis", None, (0, 0, 0), (0, 0, 0), (0.10, 0.15, 0.09), ()),
        bone("chest", "pelvis", (0, 0, 0.12), (0, 0, 0.16), (0.11, 0.16, 0.20), ((X, -0.6, 0.6), (Y, -0.6, 1.2), (Z, -0.8, 0.8))),
        bone("neck", "chest", (0, 0, 0.36), (0, 0, 0.05), (0.05, 0.05, 0.06), ((X, -0.4, 0.4), (Y, -0.4, 0.6), (Z, -0.6, 0.6))),
        bone("head", "neck", (0, 0, 0.10), (0, 0, 0.10), (0.09, 0.08, 0.12), ((X, -0.4, 0.4), (Y, -0.5, 0.6), (Z, -0.9, 0.9))),
    ]
    for side, s in (("left", 1.0), ("right", -1.0)):
        arm, fore, thigh, shin = (f"{side}_{part}" for part in ("upper_arm", "forearm", "thigh", "shin"))
        links += [
            bone(arm, "chest", (0, 0.20 * s, 0.28), (0, 0, -0.15), (0.045, 0.045, 0.15), wide, lean=1.0 * s),
            bone(fore, arm, (0, 0, -0.30), (0, 0, -0.13), (0.04, 0.04, 0.13), elbow),
            bone(f"{side}_hand", fore, (0, 0, -0.27), (0, 0, -0.09), (0.02, 0.045, 0.09), wrist),
            bone(thigh, "pelvis", (0, 0.10 * s, -0.06), (0, 0, -0.21), (0.07, 0.07, 0.21), hip),
            bone(shin, thigh, (0, 0, -0.43), (0, 0, -0.20), (0.05, 0.05, 0.20), ((Y, 0.0, 2.4),)),
            bone(f"{side}_foot", shin, (0, 0, -0.43), (0.06, 0, -0.03), (0.12, 0.045, 0.035), ankle),
        ]
    tips = ("left_hand", "right_hand", "left_foot", "right_foot", "head")
    return Avatar("dummy", tuple(links), tips)


def walls() -> tuple[Body, ...]:
    """Return floor, ceiling and four walls of 1 cm around ROOM; they overlap at the edges, so nothing leaks."""
    middle, size = ROOM.mean(axis=0), ROOM[1] - ROOM[0]
    found = []
    for axis, name in enumerate("xyz"):
        for end, sign in (("low", -1.0), ("high", 1.0)):
            extent = size + 2.0 * WALL
            extent[axis] = WALL
            place = middle.copy()
            place[axis] = ROOM[0 if sign < 0 else 1, axis] + 0.5 * sign * WALL
            found.append(fixed(f"wall_{name}_{end}", (Piece(Box(triple(extent))),), "wood", triple(place)))
    return tuple(found)


def furniture() -> tuple[Body, ...]:
    """Return a table, a sofa, a free-standing panel of 1 cm, column, ball, smooth egg: every kind of shape."""
    legs = [Piece(Box((0.05, 0.05, 0.70)), (x, y, -0.37)) for x in (-0.5, 0.5) for y in (-0.3, 0.3)]
    table = (Piece(Box((1.2, 0.7, 0.04))), *legs)
    return (
        fixed("table", table, "wood", (1.1, 0.6, 0.74)),
        fixed("sofa", (Piece(Box((0.7, 0.5, 0.4))), Piece(Box((0.7, 0.1, 0.5)), (0.0, -0.25, 0.4))), "wood", (-1.4, -1.15, 0.21)),
        fixed("panel", (Piece(Box((0.01, 1.0, 1.6))),), "metal", (0.55, -0.85, 0.81)),
        fixed("column", (Piece(Capsule(0.08, 2.0)),), "metal", (-1.6, 1.1, 1.2)),
        fixed("ball", (Piece(Sphere(0.15)),), "wood", (0.2, 1.2, 0.9)),
        fixed("egg", (Piece(Ellipsoid((0.2, 0.3, 0.15))),), "wood", (1.5, -1.0, 0.9)),
    )


def triple(values: Array) -> Vector:
    """Return three floats."""
    x, y, z = (float(value) for value in values)
    return x, y, z


@dataclass(frozen=True)
class Trial:
    """A scene, the free posture to which every hostile stretch returns, and its name."""

    scene: Scene
    home: TrackerSample


def trial(avatar: Avatar, home: TrackerSample) -> Trial:
    """Return the avatar at home in the closed room."""
    return Trial(Scene("hostile", (*walls(), *furniture()), (avatar,), start=home), home)


def hinged_trial() -> Trial:
    """Return the sixteen hulls in the room."""
    avatar = hinged_avatar()
    at_rest = rest((avatar,))
    positions = at_rest.positions.copy()
    positions[0] = (-0.7, 0.2, 1.06)
    return trial(avatar, replace(at_rest, positions=positions))


def humanoid_trial() -> Trial:
    """Return the recorded humanoid (ball joints, spheres, capsules, boxes) in the room."""
    from scenarios.building.avatars.humanoid import humanoid
    from scenarios.building.avatars.standing import standing

    avatar = humanoid()
    return trial(avatar, standing(avatar, -0.7, 0.2))


def two_trial() -> Trial:
    """Return the sixteen hulls and a palm driven by another user: two avatars in the room, each in the other's way."""
    palm = (Piece(Box((0.18, 0.09, 0.03))),)
    avatars = hinged_avatar(), rigid_avatar("palm", palm, solid(palm, 0.5))
    at_rest = rest(avatars)
    positions = at_rest.positions.copy()
    positions[0], positions[-1] = (-0.7, 0.2, 1.06), (0.1, 0.3, 1.3)
    home = replace(at_rest, positions=positions)
    return Trial(Scene("hostile", (*walls(), *furniture()), avatars, start=home), home)


TRIALS = {"hinged": hinged_trial, "humanoid": humanoid_trial, "two": two_trial}
KINDS = ("teleport", "swing", "drive", "tangle", "furniture")


def away(kind: str, at: Trial, frames: int, rng: np.random.Generator) -> Iterator[TrackerSample]:
    """Yield one stretch of hostile motion."""
    home, links = at.home, at.scene.links
    balls = np.array([isinstance(link.joint, Ball) for link in links])
    roots = [k for k, link in enumerate(links) if isinstance(link.joint, Free)]
    limits = np.array([(h.lower, h.upper) for link in links if isinstance(link.joint, Hinges) for h in link.joint.hinges])
    targets = [np.array(body.position) for body in furniture()]
    positions, rotations, angles = home.positions.copy(), home.rotations.copy(), home.angles.copy()
    heading, speed = rng.normal(size=3), rng.uniform(0.5, 30.0)
    heading /= np.linalg.norm(heading)
    rate, phase = rng.uniform(-100.0, 100.0, len(angles)), rng.uniform(0.0, 6.28, len(angles))
    axes, ball_rate = rng.normal(size=(len(links), 3)), rng.uniform(-100.0, 100.0, len(links))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    for k in range(frames):
        jump = k % 12 == 0
        if kind == "teleport" and jump:
            positions[roots] = rng.uniform(ROOM[0] - 1.0, ROOM[1] + 1.0, (len(roots), 3))
        if kind == "furniture" and jump:
            positions[roots] = [targets[k] + rng.normal(size=3) * 0.1 for k in rng.integers(len(targets), size=len(roots))]
        if kind in ("teleport", "furniture") and jump:
            rotations[roots] = rotation.normalised(rng.normal(size=(len(roots), 4)))
        if kind in ("teleport", "furniture", "tangle") and jump:
            angles = rng.uniform(limits[:, 0] - 1.2, limits[:, 1] + 1.2)
            rotations[balls] = rotation.normalised(rng.normal(size=(int(balls.sum()), 4)))
        if kind == "swing":
            angles = 1.5 * np.sin(phase + rate * k * DT / 1.5)
            rotations[balls] = rotation.from_axis_angle(axes, 1.5 * np.sin(ball_rate * k * DT / 1.5))[balls]
        if kind == "drive":
            positions[roots] += heading * speed * DT
            rotations[roots] = rotation.multiply(rotations[roots], rotation.from_axis_angle(Z, 0.1))
        yield TrackerSample(k * DT, positions.copy(), rotations.copy(), angles.copy())


def hostile_motion(at: Trial, seed: int, away_frames: int, home_frames: int) -> Iterator[tuple[str, TrackerSample]]:
    """Yield stretches of every kind in turn for ever, each followed by the free home posture ("home")."""
    rng, stretch = np.random.default_rng(seed), 0
    while True:
        for sample in away(KINDS[stretch % len(KINDS)], at, away_frames, rng):
            yield KINDS[stretch % len(KINDS)], sample
        for _ in range(home_frames):
            yield "home", at.home
        stretch += 1


def one_return(at: Trial, seed: int, away_frames: int, home_frames: int) -> Iterator[tuple[str, TrackerSample]]:
    """Yield from home one stretch of the kind that the seed gives, and home again."""
    kind = KINDS[seed % len(KINDS)]
    for sample in away(kind, at, away_frames, np.random.default_rng(seed)):
        yield kind, sample
    for _ in range(home_frames):
        yield "home", at.home


def link_error(scene: Scene, record: FrameRecord, sample: TrackerSample) -> float:
    """Return the root mean square distance [m] of shown link origins from the tracker's."""
    wanted, _ = link_poses(scene.avatars, sample)
    shown = record.shown.positions[len(scene.bodies) :]
    return float(np.sqrt(((shown - wanted) ** 2).sum(axis=1).mean()))


def outside_room(scene: Scene, record: FrameRecord) -> float:
    """Return how far [m] the middle of a link's piece is outside the room; negative when all are inside.

    Middles, not link origins: a joint's centre may lie a few millimetres outside the link's own shape.
    """
    first = len(scene.bodies)
    of = [first + k for k, link in enumerate(scene.links) for _ in link.pieces]
    places = np.array([piece.position for link in scene.links for piece in link.pieces])
    middles = record.shown.positions[of] + rotation.rotate(record.shown.orientations[of], places)
    return float(max((ROOM[0] - middles).max(), (middles - ROOM[1]).max()))


def hinge_excess(scene: Scene, record: FrameRecord) -> float:
    """Return the largest excess of a hinge beyond its limits [rad]; 0 or less when all obey."""
    limits = [(h.lower, h.upper) for link in scene.links if isinstance(link.joint, Hinges) for h in link.joint.hinges]
    if not limits:
        return 0.0
    low, high = np.array(limits).T
    return float(max((low - record.angles).max(), (record.angles - high).max()))


def ball_excess(scene: Scene, orientations: Array) -> Array:
    """Return (F,) the largest excess of swing or twist of a ball [rad], by scipy's rotations, from shown orientations (F, n, 4)
    alone; without limited balls -inf."""
    balls, parents, children, start = [], [], [], len(scene.bodies)
    for avatar in scene.avatars:
        index = {link.name: start + k for k, link in enumerate(avatar.links)}
        start += len(avatar.links)
        for link in avatar.links:
            if isinstance(link.joint, Ball) and link.joint.limits is not None and link.parent is not None:
                balls.append(link.joint)
                parents.append(index[link.parent])
                children.append(index[link.name])
    if not balls:
        return np.full(len(orientations), -np.inf)
    # limits are stated in the parent's frame, however the link is turned against it at rest
    above, below = (Rotation.from_quat(orientations[:, at].reshape(-1, 4), scalar_first=True) for at in (parents, children))
    excess: Array = swing_twist_excess(balls * len(orientations), above.inv() * below).reshape(-1, len(balls)).max(axis=1)
    return excess


def swing_twist_excess(balls: Sequence[Ball], turns: Rotation) -> Array:
    """Return excess (n,) of n rotations: swing of the limb from the centre, twist left after the shortest swing back."""
    limits = [ball.limits for ball in balls if ball.limits is not None]
    axes, centres = np.array([one.axis for one in limits]), np.array([one.centre for one in limits])
    most, (low, high) = np.array([one.swing for one in limits]), np.array([one.twist for one in limits]).T
    limbs = turns.apply(axes)
    swings = np.arctan2(np.linalg.norm(np.cross(limbs, centres), axis=1), (limbs * centres).sum(axis=1))
    start = Rotation.from_quat([between(one.axis, one.centre) for one in limits], scalar_first=True)
    twists = ((shortest(limbs, centres) * turns * start.inv()).as_rotvec() * centres).sum(axis=1)
    return np.maximum(swings - most, np.maximum(low - twists, twists - high))


between = cache(rotation.between)
"""The turn of a ball's axis to its centre, which every frame needs."""


def shortest(a: Array, b: Array) -> Rotation:
    """Return the shortest turns that take unit vectors a onto unit vectors b, one or many."""
    normal = np.cross(a, b)
    sine = np.linalg.norm(normal, axis=-1, keepdims=True)
    angle = np.arctan2(sine, (a * b).sum(axis=-1, keepdims=True))
    return Rotation.from_rotvec(np.where(sine < 1e-14, 0.0, normal / np.maximum(sine, 1e-14) * angle))
