"""The paper's art gallery, built by ourselves: two rooms with a doorway, and twenty objects in them.

Room one lies at x from -5 to 0, room two at x from 0 to 5; both reach from y = -3 to 3. Several objects are real meshes of
hundreds of triangles, read from pybullet_data, where they lie decomposed into convex pieces.
"""

from functools import cache
from pathlib import Path

import numpy as np

from avatarsim.assets.meshes.mesh import groups
from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Piece, Sphere, ellipsoid_hull
from scenarios.building.cases import fixture, turned_by
from scenarios.data_folder import data_file
from scenarios.scenario import Region

LENGTH, WIDTH, HEIGHT, THICK = 10.0, 6.0, 3.0, 0.2
"""Both rooms together along x and y, up to where the walls end, and thickness of walls and floor [m]. There is no ceiling."""
DOOR_WIDTH, DOOR_HEIGHT = 1.0, 2.1
"""The opening between the rooms [m], in the middle of the wall at x = 0."""

TABLE_TOP: Vector = (1.5, 1.0, 0.05)
"""Edges of the table's top [m]."""
TABLE_HEIGHT, TABLE_AT, LEG = 0.75, (-2.5, 0.0), 0.06
"""Upper face of the table, its middle in room one, and edge of a table leg [m]."""

PEDESTALS = {
    "pedestal_duck": (-4.2, 2.2), "pedestal_teddy": (-1.0, 2.2), "pedestal_vase": (-4.2, -2.2),
    "pedestal_blob": (-1.0, -2.2), "pedestal_egg": (1.2, 2.2), "pedestal_tower": (4.2, 2.2), "pedestal_ball": (4.2, -2.2),
}
"""Places of the pedestals [m], 0.9 m high."""

MESHES = {
    # name: (file, metres per unit, is y up, its place, material)
    "duck": ("duck_vhacd.obj", 0.2, True, (-4.2, 2.2, 0.9), "wood"),
    "teddy": ("teddy2_VHACD_CHs.obj", 0.4, True, (-1.0, 2.2, 0.9), "wood"),
    "blob": ("random_urdfs/000/000.obj", 0.04, False, (-1.0, -2.2, 0.9), "metal"),
    "tower": ("random_urdfs/010/010.obj", 0.04, False, (4.2, 2.2, 0.9), "metal"),
    "sculpture": ("random_urdfs/004/004.obj", 0.12, False, (2.5, 0.0, 0.0), "metal"),
    "bookend": ("random_urdfs/020/020.obj", 0.015, False, (-3.05, 0.38, TABLE_HEIGHT), "wood"),
    "paperweight": ("random_urdfs/003/003.obj", 0.012, False, (-1.92, 0.40, TABLE_HEIGHT), "metal"),
}
"""Objects read from files; each rests on the body below it."""


def convex_pieces(path: Path, scale: float, y_up: bool) -> tuple[Piece, ...]:
    """Return one hull per group of an OBJ file, `scale` metres per unit; the body frame is below the middle of its box, z up.

    The groups are taken to be convex, as their author decomposed them.
    """
    hulls = []
    for vertices, _ in groups(path):
        points = scale * vertices
        hulls.append(np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=-1) if y_up else points)
    low, high = np.vstack(hulls).min(axis=0), np.vstack(hulls).max(axis=0)
    foot = np.array([0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), low[2]])
    return tuple(Piece(ConvexHull(points - foot)) for points in hulls)


def walls() -> tuple[Body, ...]:
    """Return ten boxes: six outside, two next to the doorway, its lintel, and a screen that makes a corner in room two."""
    x, y, t = 0.5 * LENGTH, 0.5 * WIDTH, 0.5 * THICK
    side_width = 0.5 * (WIDTH - DOOR_WIDTH)
    along, across, half_door = (x, THICK, HEIGHT), (THICK, WIDTH + 2.0 * THICK, HEIGHT), (THICK, side_width, HEIGHT)
    middle, next_to_door = 0.5 * HEIGHT, 0.5 * (DOOR_WIDTH + side_width)
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
    return tuple(fixture(name, Box(size), "wood", at) for name, (size, at) in boxes.items())


def table() -> Body:
    """Return a wooden table: a top and four legs, one body of five pieces."""
    x, y, thick = TABLE_TOP
    under = TABLE_HEIGHT - thick
    legs = (
        Piece(Box((LEG, LEG, under)), (sx * 0.5 * (x - LEG), sy * 0.5 * (y - LEG), 0.5 * under))
        for sx in (-1.0, 1.0) for sy in (-1.0, 1.0)
    )
    top = Piece(Box(TABLE_TOP), (0.0, 0.0, TABLE_HEIGHT - 0.5 * thick))
    return fixture("table", (top, *legs), "wood", (*TABLE_AT, 0.0))


@cache
def meshes() -> tuple[Body, ...]:
    """Return duck, teddy and five more; MissingPackage when pybullet_data is not installed."""
    return tuple(
        fixture(name, convex_pieces(data_file(file), scale, y_up), material, at)
        for name, (file, scale, y_up, at, material) in MESHES.items()
    )


def furniture() -> tuple[Body, ...]:
    """Return pedestals, the plain exhibits on some of them, and a bench in room two."""
    vase = tuple(
        Piece(ellipsoid_hull(radii), (0.0, 0.0, z))
        for radii, z in (((0.11, 0.11, 0.16), 0.16), ((0.05, 0.05, 0.12), 0.36), ((0.08, 0.08, 0.03), 0.47))
    )
    lamp = (Piece(Capsule(0.03, 1.5), (0.0, 0.0, 0.78)), Piece(Sphere(0.12), (0.0, 0.0, 1.6)))
    bench = (
        Piece(Box((1.4, 0.4, 0.06)), (0.0, 0.0, 0.42)),
        Piece(Box((0.06, 0.4, 0.39)), (-0.6, 0.0, 0.195)), Piece(Box((0.06, 0.4, 0.39)), (0.6, 0.0, 0.195)),
    )
    leaning = turned_by((0.0, 1.0, 0.0), float(np.radians(20.0)))
    return (
        *(fixture(name, Box((0.4, 0.4, 0.9)), "metal", (x, y, 0.45)) for name, (x, y) in PEDESTALS.items()),
        fixture("vase", vase, "metal", (-4.2, -2.2, 0.9)),
        fixture("egg", ellipsoid_hull((0.09, 0.09, 0.12), 102), "metal", (1.2, 2.2, 1.02)),
        fixture("globe", Sphere(0.15), "metal", (4.2, -2.2, 1.05)),
        fixture("lamp", lamp, "metal", (-4.6, 0.0, 0.0)),
        fixture("bench", bench, "wood", (3.6, 0.0, 0.0)),
        fixture("board", Box((0.04, 0.8, 1.0)), "wood", (0.5, -2.0, 0.5), leaning),
    )


def gallery() -> tuple[Body, ...]:
    """Return floor, its top at z = 0, ten walls and twenty-one objects, all fixed."""
    size = (LENGTH + 2.0 * THICK, WIDTH + 2.0 * THICK, THICK)
    return (fixture("floor", Box(size), "wood", (0.0, 0.0, -0.5 * THICK)), *walls(), table(), *furniture(), *meshes())


def inside(*bodies: str) -> Region:
    """Return the region within the middle of the outer walls and above that of the floor: the house is closed."""
    half = 0.5 * THICK
    x, y = 0.5 * LENGTH + half, 0.5 * WIDTH + half
    return Region(bodies, (-x, -y, -half), (x, y, HEIGHT), "the gallery has walls all round; nothing passes them")
