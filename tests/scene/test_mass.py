"""Mass properties against trimesh's integrals over meshes, and the inertias that no solid has."""

from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from avatarsim.scene.body import Mass, solid, volume
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere, ellipsoid_hull

RNG = np.random.default_rng(1)
LUMP = ConvexHull(RNG.normal(size=(20, 3)) * [0.3, 0.1, 0.2] + [1.0, -2.0, 0.5])


def mesh_of(shape: Shape) -> trimesh.Trimesh:
    """Return a fine mesh of the shape, from trimesh's own primitives."""
    if isinstance(shape, Sphere):
        return trimesh.creation.icosphere(5, shape.radius)
    if isinstance(shape, Capsule):
        return trimesh.creation.capsule(height=shape.length, radius=shape.radius, count=[128, 128])
    if isinstance(shape, Box):
        return trimesh.creation.box(shape.size)
    if isinstance(shape, Ellipsoid):
        mesh = trimesh.creation.icosphere(5)
        mesh.apply_transform(np.diag([*shape.radii, 1.0]))
        return mesh
    return trimesh.convex.convex_hull(shape.vertices)


SHAPES: list[tuple[Shape, float]] = [
    (Sphere(0.3), 1e-2), (Capsule(0.1, 0.4), 1e-2), (Ellipsoid((0.3, 0.1, 0.2)), 1e-2), (Box((0.3, 0.1, 0.2)), 1e-9),
    (LUMP, 1e-9), (ellipsoid_hull((0.3, 0.1, 0.2)), 1e-9),
]


@pytest.mark.parametrize(("shape", "tolerance"), SHAPES)
def test_moments_agree_with_trimesh(shape: Shape, tolerance: float) -> None:
    mesh = mesh_of(shape)
    mass = solid([Piece(shape)], 3.0)
    assert volume(shape) == pytest.approx(mesh.volume, rel=tolerance)
    assert mass.centre == pytest.approx(mesh.center_mass, abs=1e-3 * tolerance)
    wanted = mesh.moment_inertia * 3.0 / mesh.volume
    assert mass.inertia == pytest.approx(wanted, rel=tolerance, abs=tolerance * np.abs(wanted).max())


def test_a_body_of_turned_pieces_agrees_with_their_joint_mesh() -> None:
    """The middle of two boxes and a hull, apart from each other, of which each is turned its own way."""
    pieces, meshes = [], []
    shapes: tuple[Shape, ...] = Box((0.2, 0.3, 0.4)), Box((0.1, 0.1, 0.6)), LUMP
    for k, shape in enumerate(shapes):
        turn, place = Rotation.random(rng=k), np.array([2.0 * k, -k, 0.5])
        w, x, y, z = turn.as_quat(scalar_first=True)
        pieces.append(Piece(shape, tuple(place), (w, x, y, z)))
        mesh = mesh_of(shape)
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = turn.as_matrix(), place
        mesh.apply_transform(pose)
        meshes.append(mesh)
    whole: Any = trimesh.util.concatenate(meshes)
    mass = solid(pieces, 5.0)
    assert mass.mass == 5.0
    assert mass.centre == pytest.approx(whole.center_mass, abs=1e-9)
    assert mass.inertia == pytest.approx(whole.moment_inertia * 5.0 / whole.volume, rel=1e-9, abs=1e-9)


def test_a_thin_disc_is_a_solid() -> None:
    assert Mass(1.0, inertia=np.diag([1.0, 1.0, 2.0])).inertia[2, 2] == 2.0


def test_inertia_is_a_read_only_copy() -> None:
    given = np.eye(3)
    mass = Mass(1.0, inertia=given)
    given[0, 0] = 5.0
    assert mass.inertia[0, 0] == 1.0 and not mass.inertia.flags.writeable
