"""The paper's art gallery, built by ourselves: two rooms with a doorway, and twenty objects in them.

Room one lies at x from -5 to 0, room two at x from 0 to 5; both reach from y = -3 to 3. Walls are ten boxes. Several
objects are real meshes of hundreds of triangles, read from pybullet_data, where they lie decomposed into convex pieces.
"""

from functools import cache

import numpy as np

from avatarsim.scene.body import Body, fixed
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere, ellipsoid_hull
from avatarsim.spatial import rotation
from scenarios.building.obj_pieces import convex_pieces
from scenarios.data_folder import data_file
from scenarios.scenario import Region

LENGTH, WIDTH, HEIGHT = 10.0, 6.0, 3.0
"""Both rooms together along x and y, and up to where the walls end [m]. There is no ceiling, so one can look in."""
THICK = 0.2
"""Thickness of walls and floor [m]."""
DOOR_WIDTH, DOOR_HEIGHT = 1.0, 2.1
"""The opening between the rooms [m], in the middle of the wall at x = 0."""

TABLE_TOP: Vector = (1.5, 1.0, 0.05)
"""Edges of the table's top [m]."""
TABLE_HEIGHT = 0.75
"""Upper face of the table [m]."""
TABLE_AT = (-2.5, 0.0)
"""Middle of the table, in room one [m]."""
LEG = 0.06
"""Edge of a table leg [m]."""

PEDESTALS = {
    "pedestal_duck": (-4.2, 2.2), "pedestal_teddy": (-1.0, 2.2), "pedestal_vase": (-4.2, -2.2),
    "pedestal_blob": (-1.0, -2.2), "pedestal_egg": (1.2, 2.2), "pedestal_tower": (4.2, 2.2), "pedestal_ball": (4.2, -2.2),
}
"""Where the pedestals stand [m]."""
PEDESTAL: Vector = (0.4, 0.4, 0.9)
"""Edges of a pedestal [m]."""

MESHES = {
    # name: (file, metres per unit, is y up, where it stands, material)
    "duck": ("duck_vhacd.obj", 0.2, True, (-4.2, 2.2, 0.9), "wood"),
    "teddy": ("teddy2_VHACD_CHs.obj", 0.4, True, (-1.0, 2.2, 0.9), "wood"),
    "blob": ("random_urdfs/000/000.obj", 0.04, False, (-1.0, -2.2, 0.9), "metal"),
    "tower": ("random_urdfs/010/010.obj", 0.04, False, (4.2, 2.2, 0.9), "metal"),
    "sculpture": ("random_urdfs/004/004.obj", 0.12, False, (2.5, 0.0, 0.0), "metal"),
    "bookend": ("random_urdfs/020/020.obj", 0.015, False, (-3.05, 0.38, TABLE_HEIGHT), "wood"),
    "paperweight": ("random_urdfs/003/003.obj", 0.012, False, (-1.92, 0.40, TABLE_HEIGHT), "metal"),
}
"""Objects read from files; they stand on what is below them."""


def walls() -> tuple[Body, ...]:
    """Ten boxes: six outside, two beside the doorway, its lintel, and a screen that makes a corner in room two."""
    x, y, t = 0.5 * LENGTH, 0.5 * WIDTH, 0.5 * THICK
    beside = 0.5 * (WIDTH - DOOR_WIDTH)
    along, across, half_door = (x, THICK, HEIGHT), (THICK, WIDTH + 2.0 * THICK, HEIGHT), (THICK, beside, HEIGHT)
    middle, next_to_door = 0.5 * HEIGHT, 0.5 * (DOOR_WIDTH + beside)
    above = HEIGHT - DOOR_HEIGHT
    boxes: dict[str, tuple[Vector, Vector]] = {
        "wall_north_one": (along, (-0.5 * x, y + t, middle)),
        "wall_north_two": (along, (0.5 * x, y + t, middle)),
        "wall_south_one": (along, (-0.5 * x, -y - t, middle)),
        "wall_south_two": (along, (0.5 * x, -y - t, middle)),
        "wall_west": (across, (-x - t, 0.0, middle)),
        "wall_east": (across, (x + t, 0.0, middle)),
        "wall_door_north": (half_door, (0.0, next_to_door, middle)),
        "wall_door_south": (half_door, (0.0, -next_to_door, middle)),
        "wall_lintel": ((THICK, DOOR_WIDTH, above), (0.0, 0.0, HEIGHT - 0.5 * above)),
        "wall_screen": ((THICK, 1.5, HEIGHT), (2.0, -y + 0.75, middle)),
    }
    return tuple(_box(name, size, at, "wood") for name, (size, at) in boxes.items())


def floor() -> Body:
    """A slab under both rooms whose top is z = 0."""
    return _box("floor", (LENGTH + 2.0 * THICK, WIDTH + 2.0 * THICK, THICK), (0.0, 0.0, -0.5 * THICK), "wood")


def table() -> Body:
    """A wooden table: a top and four legs, one body of five pieces."""
    x, y, thick = TABLE_TOP
    under = TABLE_HEIGHT - thick
    legs = tuple(
        Piece(Box((LEG, LEG, under)), (sx * 0.5 * (x - LEG), sy * 0.5 * (y - LEG), 0.5 * under))
        for sx in (-1.0, 1.0) for sy in (-1.0, 1.0)
    )
    top = Piece(Box(TABLE_TOP), (0.0, 0.0, TABLE_HEIGHT - 0.5 * thick))
    return fixed("table", (top, *legs), "wood", (*TABLE_AT, 0.0))


@cache
def meshes() -> tuple[Body, ...]:
    """Duck, teddy and five more; MissingPackage when pybullet_data is not installed."""
    return tuple(
        fixed(name, convex_pieces(data_file(file), scale, y_up), material, at)
        for name, (file, scale, y_up, at, material) in MESHES.items()
    )


def furniture() -> tuple[Body, ...]:
    """Pedestals, the plain exhibits on some of them, and a bench in room two."""
    pedestals = tuple(
        _box(name, PEDESTAL, (x, y, 0.5 * PEDESTAL[2]), "metal") for name, (x, y) in PEDESTALS.items()
    )
    vase = tuple(
        Piece(ellipsoid_hull(radii), (0.0, 0.0, z))
        for radii, z in (((0.11, 0.11, 0.16), 0.16), ((0.05, 0.05, 0.12), 0.36), ((0.08, 0.08, 0.03), 0.47))
    )
    lamp = (Piece(Capsule(0.03, 1.5), (0.0, 0.0, 0.78)), Piece(Sphere(0.12), (0.0, 0.0, 1.6)))
    bench = (
        Piece(Box((1.4, 0.4, 0.06)), (0.0, 0.0, 0.42)),
        Piece(Box((0.06, 0.4, 0.39)), (-0.6, 0.0, 0.195)), Piece(Box((0.06, 0.4, 0.39)), (0.6, 0.0, 0.195)),
    )
    leaning = rotation.from_axis_angle((0.0, 1.0, 0.0), float(np.radians(20.0)))
    w, x, y, z = (float(value) for value in leaning)
    return (
        *pedestals,
        fixed("vase", vase, "metal", (-4.2, -2.2, 0.9)),
        fixed("egg", (Piece(ellipsoid_hull((0.09, 0.09, 0.12), 102)),), "metal", (1.2, 2.2, 1.02)),
        fixed("globe", (Piece(Sphere(0.15)),), "metal", (4.2, -2.2, 1.05)),
        fixed("lamp", lamp, "metal", (-4.6, 0.0, 0.0)),
        fixed("bench", bench, "wood", (3.6, 0.0, 0.0)),
        fixed("board", (Piece(Box((0.04, 0.8, 1.0))),), "wood", (0.5, -2.0, 0.5), (w, x, y, z)),
    )


def gallery() -> tuple[Body, ...]:
    """Floor, ten walls and twenty-one objects, all fixed."""
    return (floor(), *walls(), table(), *furniture(), *meshes())


def inside(*bodies: str) -> Region:
    """No frame origin outside the middle of the outer walls or below that of the floor: the house is closed."""
    half = 0.5 * THICK
    x, y = 0.5 * LENGTH + half, 0.5 * WIDTH + half
    return Region(bodies, (-x, -y, -half), (x, y, HEIGHT), "the gallery has walls all round; nothing passes them")


def _box(name: str, size: Vector, at: Vector, material: str) -> Body:
    return fixed(name, (Piece(Box(size)),), material, at)
