"""Small scenes on which the engines must agree: every kind of joint, shape and mass with few bodies."""

import numpy as np

from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import Mass, fixed, simulated, solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, Rigid, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from tests.agreement.runs import FRAME

LIMITS = SwingTwist((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.8, (-0.5, 0.5))
"""Limits of a limb along x whose frame is its parent's at rest."""


def turned(seed: int) -> tuple[float, float, float, float]:
    """Return a rotation drawn from `seed`."""
    w, x, y, z = (float(v) for v in rotation.normalised(np.random.default_rng(seed).normal(size=4)))
    return w, x, y, z


def skewed(mass: float, seed: int) -> Mass:
    """Return a mass whose centre and principal axes are far from the frame's."""
    axes = rotation.to_matrix(np.array(turned(seed)))
    inertia = axes @ np.diag([0.02, 0.03, 0.04]) @ axes.T
    return Mass(mass, (0.02, -0.03, 0.04), 0.5 * (inertia + inertia.T))


def limb(name: str, parent: str, joint: Hinges | Ball | Rigid, seed: int) -> Link:
    """Return a capsule along x, its joint at 0.3 m, its frame rotated relative to the parent's."""
    piece = Piece(Capsule(0.03, 0.2), (0.15, 0.0, 0.0), rotation_of_z_to_x())
    return Link(name, parent, joint, (piece,), skewed(1.0, seed), anchor=(0.3, 0.01, 0.02), orientation=turned(seed))


def rotation_of_z_to_x() -> tuple[float, float, float, float]:
    """Quarter turn about y."""
    return float(np.sqrt(0.5)), 0.0, float(np.sqrt(0.5)), 0.0


def every_joint() -> Avatar:
    """Return a free root with a branch of hinges (one, three) and a branch of a ball and a rigid link; not in tree order."""
    three = Hinges((Hinge((1.0, 0.0, 0.0)), Hinge((0.0, 0.6, 0.8)), Hinge((0.0, 0.0, 1.0), -1.0, 1.0)))
    root = Link("root", None, Free(), (Piece(Box((0.1, 0.2, 0.3)), (0.01, 0.0, 0.0), turned(1)),), skewed(2.0, 2))
    return Avatar("all", (
        root, limb("one", "root", Hinges((Hinge((0.0, 1.0, 0.0), -2.0, 2.0),)), 3), limb("ball", "root", Ball(LIMITS), 4),
        limb("three", "one", three, 5), limb("stiff", "ball", Rigid(), 6),
    ))


def anchored(root: Hinges | Ball | Rigid) -> Avatar:
    """Return two links, the first joined to the world by `root`."""
    piece = Piece(Capsule(0.03, 0.2), (0.15, 0.0, 0.0), rotation_of_z_to_x())
    first = Link("first", None, root, (piece,), skewed(1.0, 7), anchor=(0.1, 0.2, 1.0), orientation=turned(8))
    return Avatar("tied", (first, limb("second", "first", Hinges((Hinge((0.0, 0.0, 1.0)),)), 9)))


def posture(avatar: Avatar, seed: int, time: float = 0.0) -> TrackerSample:
    """Return a posture within the limits of `every_joint`, drawn from `seed`."""
    draw = np.random.default_rng(seed)
    n = len(avatar.links)
    turns = rotation.from_rotation_vector(draw.uniform(-0.2, 0.2, (n, 3)))
    return TrackerSample(time, draw.uniform(1.0, 1.5, (n, 3)), turns, draw.uniform(-0.5, 0.5, avatar.hinge_count))


def bodies_of_all_shapes() -> Scene:
    """Return simulated bodies in empty space, far apart: skewed inertias, several pieces, offset hulls; no gravity."""
    hull = ConvexHull(np.random.default_rng(3).normal(size=(20, 3)) * 0.1 + np.array([0.05, 0.0, 0.02]))
    pieces = (
        (Piece(Sphere(0.1)),), (Piece(Box((0.1, 0.2, 0.3))),), (Piece(Capsule(0.05, 0.2), (0.1, 0.0, 0.0), turned(11)),),
        (Piece(hull),), (Piece(hull, (0.02, 0.03, 0.04), turned(12)), Piece(Sphere(0.05), (0.2, 0.0, 0.0))),
    )
    bodies = [
        simulated(f"body_{k}", p, "wood", skewed(1.0 + k, 20 + k), (2.0 * k, 0.1, 0.2), turned(30 + k),
                  (0.3, -0.2, 0.1), (0.4, 0.5, -0.6))
        for k, p in enumerate(pieces)
    ]
    return Scene("shapes", tuple(bodies), gravity=(0.0, 0.0, 0.0))


def ball_on_slab(gravity: float = 9.81, height: float = 1.0, material: str = "wood") -> Scene:
    """Return one ball above one slab, both of wood."""
    ball = (Piece(Sphere(0.05)),)
    return Scene("drop", (
        fixed("slab", (Piece(Box((2.0, 2.0, 0.1))),), "wood", (0.0, 0.0, -0.05)),
        simulated("ball", ball, material, solid(ball, 0.2), (0.0, 0.0, 0.05 + height)),
    ), gravity=(0.0, 0.0, -gravity))


def hull_on_slab() -> Scene:
    """Return a cube given by its eight corners, 1 mm above a slab given by its corners."""
    corners = np.array(np.meshgrid([-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0])).reshape(3, -1).T
    cube, slab = (Piece(ConvexHull(0.05 * corners)),), (Piece(ConvexHull(corners * np.array([1.0, 1.0, 0.05]))),)
    return Scene("cube", (
        fixed("slab", slab, "wood", (0.0, 0.0, -0.05)),
        simulated("cube", cube, "wood", solid(cube, 1.0), (0.0, 0.0, 0.051)),
    ))


def hand() -> Avatar:
    """Return a rigid hand of fifteen ellipsoids of about a hundred triangles each: a palm, five fingers."""
    pieces = [Piece(ellipsoid_hull((0.045, 0.04, 0.015)))]
    for finger in range(5):
        for length, x in ((0.025, 0.06), (0.018, 0.10), (0.014, 0.13)):
            pieces.append(Piece(ellipsoid_hull((length, 0.009, 0.009)), (x, -0.035 + 0.0175 * finger, 0.0)))
    chosen = tuple(pieces[:15])
    return rigid_avatar("hand", chosen, solid(chosen, 0.5))


def hand_over_table() -> Scene:
    """Return the hand 5 cm above a table top at z = 0."""
    table = fixed("table", (Piece(Box((1.5, 1.0, 0.05))),), "wood", (0.0, 0.0, -0.025))
    return Scene("press", (table,), (hand(),), start=pressed(0))


def pressed(frame: int) -> TrackerSample:
    """Return the hand's sample: lowered in 0.3 s to 2 cm below the table top, then moved along it."""
    t = frame * FRAME
    down = min(1.0, max(0.0, (t - 0.1) / 0.3))
    along = 0.2 * min(1.0, max(0.0, (t - 0.5) / 0.5))
    place = np.array([[along, 0.0, 0.05 - 0.058 * down]])
    return TrackerSample(t, place, np.tile(rotation.IDENTITY, (1, 1)), np.zeros(0))


def arm(wall: bool = True) -> Scene:
    """Return three capsules in a row with hinges about z, which reach 10 cm past a wall when stretched along x."""
    link = Piece(Capsule(0.03, 0.2), (0.15, 0.0, 0.0), rotation_of_z_to_x())
    mass = solid((link,), 1.0)
    hinge = Hinges((Hinge((0.0, 0.0, 1.0), -2.4, 2.4),))
    links = (
        Link("upper", None, hinge, (link,), mass, anchor=(0.0, 0.0, 1.0)),
        Link("fore", "upper", hinge, (link,), mass, anchor=(0.3, 0.0, 0.0)),
        Link("hand", "fore", hinge, (link,), mass, anchor=(0.3, 0.0, 0.0)),
    )
    avatar = Avatar("arm", links, chains=("hand",))
    face = 0.3 + 0.3 + 0.28 - 0.1
    bodies = (fixed("wall", (Piece(Box((0.2, 4.0, 4.0))),), "wood", (face + 0.1, 0.0, 1.0)),) if wall else ()
    return Scene("arm", bodies, (avatar,), start=bent(0))


def bent(frame: int) -> TrackerSample:
    """Return the arm's sample: the shoulder turns in a second from parallel to the wall to straight at it."""
    t = frame * FRAME
    first = 1.5 * (1.0 - min(1.0, t / 1.0))
    return TrackerSample(t, np.zeros((3, 3)), np.tile(rotation.IDENTITY, (3, 1)), np.array([first, 0.1, 0.1]))


def chain(limits: SwingTwist | None = None) -> Avatar:
    """Return three capsules in a row with ball joints, anchored to the world."""
    link = Piece(Capsule(0.03, 0.2), (0.15, 0.0, 0.0), rotation_of_z_to_x())
    mass = solid((link,), 1.0)
    return Avatar("chain", (
        Link("a", None, Ball(limits), (link,), mass, anchor=(0.0, 0.0, 1.0)),
        Link("b", "a", Ball(limits), (link,), mass, anchor=(0.3, 0.0, 0.0)),
        Link("c", "b", Ball(limits), (link,), mass, anchor=(0.3, 0.0, 0.0)),
    ))


def swung(frame: int, reach: float = 0.4) -> TrackerSample:
    """Return the sample with all three balls swung about y and z, by up to `reach` [rad] to each side."""
    t = frame * FRAME
    turn = rotation.from_rotation_vector(np.array([0.0, reach * np.sin(3.0 * t), reach * np.sin(2.0 * t)]))
    return TrackerSample(t, np.zeros((3, 3)), np.tile(turn, (3, 1)), np.zeros(0))
