"""Built-in stages: a hand over a table or among toys, a human in two rooms; built of primitives, or for any avatar of a user.

Lengths and masses of the hand are an adult's (Garrett 1971; de Leva 1996), its ranges of motion those of the ASSH, rounded; the
human is built by `avatarsim.assets.models.from_skeleton` on shares of stature (Drillis and Contini).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from math import radians, tan

import numpy as np

from avatarsim.assets.models.from_skeleton import human
from avatarsim.assets.models.pieces_of_geoms import Visual
from avatarsim.assets.models.smpl_skeleton import approximate
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.live.drive.limbs import handle_links
from avatarsim.live.drive.tree import Tree
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.motion import Motion
from avatarsim.scene.moving import moving, with_moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere, reach
from avatarsim.scene.tracker import TrackerSample, link_poses, rest
from avatarsim.spatial import rotation
from avatarsim.spatial.rotation import Array

GAP = 1e-4
"""[m] Gap between stacked bodies at the start: it closes in the first frames, and rounding makes no overlap of it."""


@dataclass(frozen=True, eq=False)
class Stage:
    """A scene to drive, and surfaces that are drawn in place of pieces, as `Model.visuals`. Raises InvalidInput for a scene
    without an avatar."""

    scene: Scene
    visuals: Mapping[str, tuple[Visual, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.scene.avatars:
            raise InvalidInput(f"avatars of scene {self.scene.name}", 0, "at least 1, to be driven")

    @property
    def handles(self) -> tuple[str, ...]:
        """Names of the links of all avatars that get gizmos: free roots and ends of limbs; with several hands, no fingers."""
        names = self.scene.names[len(self.scene.bodies):]
        return tuple(names[k] for k in handle_links(Tree(self.scene.avatars)))


def stage(name: str) -> Stage:
    """Return a built-in stage. Raises UnknownName for a name that is not in `NAMES`."""
    if name not in _STAGES:
        raise UnknownName("stage", name, _STAGES)
    return _STAGES[name]()


# --- the hand

HAND_MASS = 0.46
"""[kg] Mass of the hand: 0.61 per cent of a body of 75 kg."""

PALM_SHARE = 0.6
"""Share of the hand's mass in the palm; the rest is distributed over the fingers by volume."""

PALM = Box((0.094, 0.080, 0.026))
"""Palm, with its centre at the origin of the hand, fingers along x, facing down; the thumb of the left hand towards -y."""

FLEXION = {1: (-20.0, 90.0), 2: (0.0, 100.0), 3: (0.0, 70.0)}
"""[degrees] Extension and flexion of the three joints of a finger, from the palm outwards."""

SPREAD = 15.0
"""[degrees] Range to either side of the joint nearest the palm."""


@dataclass(frozen=True)
class Digit:
    """A finger: base of its first joint on the palm [m], bearing [degrees from x], radius and bone lengths [m]."""

    name: str
    base: Vector
    bearing: float
    radius: float
    bones: tuple[float, float, float]


FINGERS = (
    Digit("index", (0.048, -0.030, 0.0), -5.0, 0.0085, (0.044, 0.026, 0.017)),
    Digit("middle", (0.051, -0.009, 0.0), 0.0, 0.0085, (0.048, 0.030, 0.018)),
    Digit("ring", (0.048, 0.012, 0.0), 4.0, 0.0080, (0.044, 0.028, 0.018)),
    Digit("little", (0.041, 0.032, 0.0), 10.0, 0.0070, (0.035, 0.020, 0.016)),
)
THUMB = Digit("thumb", (-0.018, -0.040, -0.004), -55.0, 0.0095, (0.044, 0.032, 0.024))


def hand() -> Avatar:
    """Return an articulated hand: palm, four fingers and a thumb of three links each, 16 links and 20 hinges, free in space."""
    links = [Link("palm", None, Free(), (Piece(PALM),), solid((Piece(PALM),), PALM_SHARE * HAND_MASS))]
    total = sum(digit.radius**2 * bone for digit in (THUMB, *FINGERS) for bone in digit.bones)
    for digit in (THUMB, *FINGERS):
        parent, anchor, bearing = "palm", digit.base, digit.bearing
        for number, bone in enumerate(digit.bones, start=1):
            last = number == len(digit.bones)
            # the last bone's length includes the round tip
            pieces = (_along_x(bone - (digit.radius if last else 0.0), digit.radius),)
            mass = solid(pieces, (1.0 - PALM_SHARE) * HAND_MASS * digit.radius**2 * bone / total)
            joint = _thumb_joint(number) if digit is THUMB else _finger_joint(number)
            name = f"{digit.name}{number}"
            links.append(Link(name, parent, joint, pieces, mass, anchor=anchor, orientation=_about("z", bearing)))
            parent, anchor, bearing = name, (bone, 0.0, 0.0), 0.0
    return Avatar("hand", tuple(links))


def _along_x(length: float, radius: float) -> Piece:
    """Return a capsule from the origin along x."""
    return Piece(Capsule(radius, length), (0.5 * length, 0.0, 0.0), _about("y", 90.0))


def _finger_joint(number: int) -> Hinges:
    """Return a joint of a finger, counted from the palm: it bends about y, the first one also spreads about z."""
    low, high = FLEXION[number]
    spread = (Hinge((0.0, 0.0, 1.0), radians(-SPREAD), radians(SPREAD)),) if number == 1 else ()
    return Hinges((*spread, Hinge((0.0, 1.0, 0.0), radians(low), radians(high))))


def _thumb_joint(number: int) -> Hinges:
    """Return a joint of the thumb: at the wrist it turns across the palm and in its plane, then it bends towards the fingers."""
    if number == 1:
        plane = Hinge((0.0, 0.0, 1.0), radians(-30.0), radians(30.0))
        return Hinges((plane, Hinge((0.0, 1.0, 0.0), radians(-10.0), radians(50.0))))
    return Hinges((Hinge((0.0, 0.0, 1.0), radians(-10.0), radians(60.0 if number == 2 else 80.0)),))


def _about(axis: str, degrees: float) -> Quaternion:
    """Return the rotation about an axis of the world."""
    w, x, y, z = rotation.from_axis_angle([axis == one for one in "xyz"], radians(degrees)).tolist()
    return w, x, y, z


TOP = 0.75
"""Height of the table [m]."""


def _table(half: float, rim: float) -> tuple[Body, Body]:
    """Return a floor, and on it a table of edge 2 ``half`` with a rim on three sides [m]."""
    table = fixed("table", (
        _box((0.0, 0.0, TOP - 0.02), (2.0 * half, 2.0 * half, 0.04)),
        *(_box((sx * (half - 0.04), sy * (half - 0.04), 0.5 * (TOP - 0.04)), (0.05, 0.05, TOP - 0.04))
          for sx in (-1.0, 1.0) for sy in (-1.0, 1.0)),
        *(_box((0.0, s * (half + 0.5 * rim), TOP), (2.0 * half, rim, 0.08)) for s in (-1.0, 1.0)),
        _box((-half - 0.5 * rim, 0.0, TOP), (rim, 2.0 * half + 2.0 * rim, 0.08)),
    ), "wood")
    return fixed("floor", (_box((0.0, 0.0, -0.05), (4.0, 4.0, 0.1)),), "wood"), table


def _above_table(
    name: str, bodies: tuple[Body, ...], high: float, roll: float = 0.0, doors: tuple[Avatar, ...] = ()
) -> Stage:
    """Return the hand, turned about its fingers by ``roll`` [degrees], ``high`` [m] above the table with bodies and doors."""
    avatars = hand(), *doors
    start = rest(avatars)
    start.positions[0], start.rotations[0] = (-0.05, 0.0, TOP + high), _about("x", roll)
    return Stage(Scene(name, bodies, avatars, start=start))


def _hand_stage() -> Stage:
    half = 0.45
    wall = fixed("wall", (_box((half + 0.06, 0.0, 0.65), (0.1, 1.0, 1.3)),), "wood")
    lying = Piece(Capsule(0.025, 0.10), (0.0, 0.0, 0.0), _about("x", 90.0))
    loose = (
        _loose("ball", (Piece(Sphere(0.035)),), 0.08, (0.22, 0.16, TOP + 0.035)),
        _loose("box", (Piece(Box((0.07, 0.07, 0.07))),), 0.15, (0.26, -0.06, TOP + 0.035)),
        _loose("brick", (Piece(Box((0.12, 0.06, 0.04))),), 0.20, (0.05, -0.26, TOP + 0.02)),
        _loose("roller", (lying,), 0.12, (0.10, 0.28, TOP + 0.025)),
        _loose("marble", (Piece(Sphere(0.015)),), 0.02, (0.30, -0.24, TOP + 0.015), "metal"),
    )
    return _above_table("live hand", (*_table(half, 0.03), wall, *loose), 0.1)


def _toys_stage() -> Stage:
    """Return a mug, a tower, a row of dominoes and a small door; the palm faces them, the thumb up."""
    post = fixed("post", (_box((0.38, 0.08, TOP + 0.11), (0.02, 0.02, 0.22)),), "wood")
    leaf = (_box((0.0, 0.1, 0.1), (0.012, 0.18, 0.19)), _box((0.0, 0.17, 0.1), (0.05, 0.01, 0.04)))
    door = moving("door", leaf, "wood", position=(0.38, 0.08, TOP + 0.01), joint=_hinged(100.0), stiffness=0.0, mass=0.4,
                  damping=0.2)
    bodies = (
        *_table(0.45, 0.03), post, _mug((0.12, -0.05, TOP)),
        *_tower(6, (0.06, 0.06, 0.04), 0.1, (0.06, 0.3, TOP)),
        *_dominoes(14, (0.008, 0.024, 0.048), 0.015, 0.026, (-0.05, -0.28, TOP)),
    )
    return _above_table("live toys", bodies, 0.14, -90.0, (door,))


def _mug(foot: Vector) -> Body:
    """Return a mug of 0.3 kg with its foot at ``foot`` [m], its handle along x: four crossed boxes are a prism of eight sides."""
    slab, (x, y, z) = Box((0.07, 0.07 * tan(radians(22.5)), 0.1)), foot
    sides = tuple(Piece(slab, orientation=_about("z", 45.0 * k)) for k in range(4))
    handle = Piece(Box((0.03, 0.012, 0.06)), (0.05, 0.0, 0.0))
    return _loose("mug", (*sides, handle), 0.3, (x, y, z + 0.05))


def _hinged(most: float) -> Hinges:
    """Return a vertical hinge that opens by up to ``most`` [degrees] to either side."""
    return Hinges((Hinge((0.0, 0.0, 1.0), radians(-most), radians(most)),))


def _tower(count: int, size: Vector, mass: float, foot: Vector) -> tuple[Body, ...]:
    """Return blocks [kg, m] on top of one another."""
    x, y, z = foot
    return tuple(
        _loose(f"block {k + 1}", (Piece(Box(size)),), mass, (x, y, z + 0.5 * size[2] + k * (size[2] + GAP)))
        for k in range(count)
    )


def _dominoes(count: int, size: Vector, mass: float, apart: float, first: Vector) -> tuple[Body, ...]:
    """Return a row of upright tiles along x, ``apart`` [m]."""
    x, y, z = first
    return tuple(
        _loose(f"domino {k + 1}", (Piece(Box(size)),), mass, (x + apart * k, y, z + 0.5 * size[2])) for k in range(count)
    )


# --- the human

STATURE = 1.75
"""[m] Height of the human, near the mean of the tables that it is built from."""

ARMS_DOWN = 72.0
"""[degrees] by which the arms, which point sideways at rest, hang down at the start."""


def body() -> tuple[Avatar, TrackerSample]:
    """Return a human of 24 links, and its start posture: upright, arms down, the root's joint at the origin."""
    skeleton = replace(approximate("SMPL", STATURE)[0], name="human")
    places, turns, angles = skeleton.still
    at = {bone.name: k for k, bone in enumerate(skeleton.bones)}
    turns = turns.copy()
    for side, sign in (("left", -1.0), ("right", 1.0)):
        turns[at[f"{side}_shoulder"]] = _about("x", sign * ARMS_DOWN)
        turns[at[f"{side}_elbow"]] = _about("z", sign * 15.0)
    clip = Motion(np.zeros(1), places[None], turns[None], angles[None])
    avatar = human(skeleton, STATURE, clip).avatar
    if avatar is None:
        raise InvalidInput("avatar of the human", None, "a tree of links")
    return avatar, TrackerSample(0.0, places, turns, angles)


def _gallery() -> Stage:
    avatar, start = body()
    positions, orientations = link_poses((avatar,), start)
    lowest = min(
        float((positions[k] + rotation.rotate(orientations[k], piece.position))[2]) - _half_height(piece, orientations[k])
        for k, link in enumerate(avatar.links) for piece in link.pieces
    )
    start = replace(start, positions=_first_root(avatar, (-2.2, 0.0, GAP - lowest)))
    return Stage(Scene("live gallery", (*_rooms(), *_furniture(), *_playthings()), (avatar,), start=start))


def _half_height(piece: Piece, orientation: Array) -> float:
    """Return how far a capsule or ball extends below its centre [m]."""
    shape = piece.shape
    if isinstance(shape, Capsule):
        axis = rotation.rotate(rotation.multiply(orientation, piece.orientation), (0.0, 0.0, 1.0))
        return shape.radius + 0.5 * shape.length * abs(float(axis[2]))
    return reach(Piece(shape))


def _rooms() -> tuple[Body, ...]:
    """Return two rooms of 4 by 5 m, separated by a wall with a doorway of 1 by 2.1 m; walls towards the eye are low."""
    height, thick = 2.6, 0.12
    middle = fixed("doorway", (
        _box((0.0, 1.5, 0.5 * height), (thick, 2.0, height)), _box((0.0, -1.5, 0.5 * height), (thick, 2.0, height)),
        _box((0.0, 0.0, 2.35), (thick, 1.0, 0.5)),
    ), "wood")
    outer = fixed("walls", (
        _box((4.06, 0.0, 0.5 * height), (thick, 5.0, height)), _box((-4.06, 0.0, 0.25), (thick, 5.0, 0.5)),
        _box((0.0, 2.56, 0.5 * height), (8.0, thick, height)), _box((0.0, -2.56, 0.25), (8.0, thick, 0.5)),
    ), "wood")
    return fixed("floor", (_box((0.0, 0.0, -0.1), (9.0, 6.0, 0.2)),), "wood"), middle, outer


def _furniture() -> tuple[Body, ...]:
    legs = [(sx, sy) for sx in (-1.0, 1.0) for sy in (-1.0, 1.0)]
    table = fixed("table", (
        _box((0.0, 0.0, 0.73), (1.4, 0.8, 0.04)), *(_box((0.64 * sx, 0.34 * sy, 0.355), (0.06, 0.06, 0.71)) for sx, sy in legs),
    ), "wood", (2.2, -0.9, 0.0))
    bench = fixed("bench", (
        _box((0.0, 0.0, 0.43), (0.4, 1.4, 0.05)), *(_box((0.0, 0.6 * s, 0.2), (0.36, 0.06, 0.40)) for s in (-1.0, 1.0)),
    ), "wood", (-3.6, 0.9, 0.0))
    shelf = fixed("shelf", (
        *(_box((0.0, 0.0, z), (1.2, 0.3, 0.03)) for z in (0.4, 0.9, 1.4)),
        *(_box((0.6 * s, 0.0, 0.8), (0.03, 0.3, 1.6)) for s in (-1.0, 1.0)),
    ), "wood", (-1.6, 2.3, 0.0))
    steps = fixed("steps", tuple(_box((0.3 * k, 0.0, 0.09 * (k + 1)), (0.3, 1.2, 0.18 * (k + 1))) for k in range(3)), "wood",
                  (2.6, 1.5, 0.0))
    return table, bench, shelf, steps


def _playthings() -> tuple[Body, ...]:
    ball, box = (Piece(Sphere(0.11)),), (Piece(Box((0.25, 0.25, 0.25))),)
    return (
        _loose("ball", ball, 0.45, (-1.2, 0.45, 0.11)),
        _loose("ball in the other room", ball, 0.45, (1.0, 0.3, 0.11)),
        _loose("ball on the table", (Piece(Sphere(0.06)),), 0.15, (1.9, -0.8, 0.75 + 0.06)),
        _loose("box on the table", (Piece(Box((0.2, 0.15, 0.12))),), 0.8, (2.4, -0.9, 0.75 + 0.06)),
        _loose("box", box, 2.0, (-1.0, -0.9, 0.125)),
        _loose("box on the box", (Piece(Box((0.18, 0.18, 0.18))),), 1.0, (-1.0, -0.9, 0.25 + GAP + 0.09)),
        _loose("book", (Piece(Box((0.18, 0.12, 0.04))),), 0.5, (-1.7, 2.3, 0.915 + 0.02)),
        _loose("ball on the shelf", (Piece(Sphere(0.07)),), 0.2, (-1.3, 2.3, 1.415 + 0.07)),
    )


def _house() -> Stage:
    """Return the human and the rooms of the gallery with a hinged door, a lift at a ledge, a mug, and boxes."""
    human_stage = _gallery()
    door = moving(
        "door", (_box((0.0, 0.47, 1.02), (0.05, 0.94, 2.0)), _box((0.0, 0.85, 1.0), (0.18, 0.03, 0.12))), "wood",
        position=(0.0, -0.47, 0.01), joint=_hinged(110.0), stiffness=0.0, mass=20.0, damping=10.0,
    )
    lift = moving("lift", (_box((0.0, 0.0, 0.05), (1.2, 1.2, 0.1)),), "wood", position=(2.6, -1.6, GAP), largest_force=3000.0)
    ledge = fixed("ledge", (_box((0.0, 0.0, 0.5), (1.2, 1.2, 1.0)),), "wood", (3.4, 0.2, 0.0))
    stand = fixed("stand", (_box((0.0, 0.2, 0.35), (0.4, 0.8, 0.7)),), "wood", (-1.0, -0.9, 0.0))
    things = tuple(
        _loose(name, (Piece(Box((size, size, size))),), mass, place) for name, size, mass, place in (
            ("box", 0.25, 2.0, (-1.0, -0.9, 0.7 + GAP + 0.125)),
            ("box on the lift", 0.25, 2.0, (2.8, -1.3, 0.1 + 2.0 * GAP + 0.125)),
            ("box behind the door", 0.4, 4.0, (0.9, 0.3, 0.2)),
        )
    )
    games = *_tower(5, (0.3, 0.3, 0.25), 1.5, (-2.2, 1.6, 0.0)), *_dominoes(7, (0.06, 0.35, 0.7), 1.0, 0.3, (-3.4, -1.8, 0.0))
    avatar, start = human_stage.scene.avatars[0], human_stage.scene.start
    assert start is not None
    avatars = avatar, door, lift
    whole = with_moving(avatars, start, {}, rest(avatars))
    return Stage(Scene("live house", (*_rooms(), ledge, stand, _mug((-1.1, -0.45, 0.7)), *things, *games), avatars, start=whole))


def _box(position: Vector, size: Vector) -> Piece:
    return Piece(Box(size), position)


def _loose(name: str, pieces: tuple[Piece, ...], mass: float, position: Vector, material: str = "wood") -> Body:
    x, y, z = position
    return simulated(name, pieces, material, solid(pieces, mass), (x, y, z + GAP))


def _first_root(avatar: Avatar, position: Vector) -> Array:
    places = np.zeros((len(avatar.links), 3))
    places[0] = position
    return places


_STAGES: dict[str, Callable[[], Stage]] = {
    "hand": cache(_hand_stage), "toys": cache(_toys_stage), "gallery": cache(_gallery),
    "house": cache(_house),
}
NAMES = tuple(_STAGES)
"""Built-in stages."""
