"""Parts of scenes: the gallery, hulls, prisms, an open box, and the rigid hand of fifteen parts."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull as QuickHull

from avatarsim.assets.meshes.mesh import groups
from avatarsim.errors import MissingPackage
from avatarsim.scene.body import Role, solid
from avatarsim.scene.joint import Free
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import ConvexHull, Sphere
from avatarsim.scene.tracker import rest
from avatarsim.spatial import rotation
from reference.judging.judge import Judge, Verdict
from scenarios import data_folder
from scenarios.building.avatars.hand import DIGITS, MASS, hand_pieces, rigid_hand
from scenarios.building.cases import driven
from scenarios.building.gallery import MESHES, convex_pieces, gallery, meshes
from scenarios.building.reach import reach
from scenarios.building.things import drawn_hull, prism
from scenarios.data_folder import data_file, robotics_assets
from scenarios.motion.mocap import load_clip

SCENE = Scene("probed", gallery(), (driven("probe", Sphere(0.4), 1.0),))
"""Return the gallery with a ball in it as wide as a person."""
JUDGE = Judge(SCENE)


def probed(x: float, y: float, z: float) -> Verdict:
    """Return the judge's verdict on the ball at a position in the gallery."""
    positions = np.array([*(body.position for body in SCENE.bodies), (x, y, z)])
    return JUDGE.overlaps(positions, np.array([*(body.orientation for body in SCENE.bodies), rotation.IDENTITY]))


@pytest.mark.parametrize("name", sorted(MESHES))
def test_every_piece_of_a_mesh_is_already_convex(name: str) -> None:
    for vertices, triangles in groups(data_file(MESHES[name][0])):
        corners = vertices[triangles] - vertices.mean(axis=0)
        # a closed surface's volume by signed tetrahedra: that of its hull only if the surface is convex
        volume = abs(np.linalg.det(corners).sum()) / 6.0
        assert volume == pytest.approx(QuickHull(vertices).volume, rel=2e-3)


def test_the_doorway_lets_a_person_through() -> None:
    for x in np.linspace(-1.0, 1.0, 21):
        assert probed(x, 0.0, 1.2).deepest == 0.0
    assert probed(0.0, 1.2, 1.2).deepest > 0.4
    assert probed(0.0, 0.0, 2.3).deepest > 0.1


@pytest.mark.parametrize("turn", np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False))
def test_the_walls_are_closed_all_round(turn: float) -> None:
    d = np.array([np.cos(turn), np.sin(turn)])
    out = min(5.0 / max(abs(d[0]), 1e-9), 3.0 / max(abs(d[1]), 1e-9))
    x, y = out * d
    assert any(name.startswith("wall") for pair in probed(x, y, 2.6).pairs for name in pair[:2])


def test_objects_stand_in_nothing() -> None:
    bodies = tuple(
        body if body.name == "floor" or body.name.startswith("wall")
        else replace(body, role=Role.SIMULATED, mass=solid(body.pieces, 1.0))
        for body in gallery()
    )
    verdict = Judge(Scene("loose", bodies)).overlaps(
        np.array([body.position for body in bodies]), np.array([body.orientation for body in bodies]), 1e-3
    )
    # and they are supported: something is within a millimetre of its support
    assert verdict.deepest < 1e-6 and verdict.gap < 1e-3


def test_without_the_data_package_it_is_missing_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(data_folder, "find_spec", lambda name: None)
    packages = "pybullet_data", "pybullet_data", "gymnasium-robotics"
    doors = lambda: meshes.__wrapped__(), lambda: load_clip("walk"), lambda: robotics_assets()
    for needs_it, package in zip(doors, packages, strict=True):
        with pytest.raises(MissingPackage, match=package):
            needs_it()


def test_a_file_with_y_up_is_turned(tmp_path: Path) -> None:
    path = tmp_path / "post.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 5 0\nf 1 2 3\nf 1 2 4\n", encoding="utf-8")
    (piece,) = convex_pieces(path, 1.0, y_up=True)
    assert isinstance(piece.shape, ConvexHull) and piece.shape.vertices[:, 2].max() == 5.0


@given(st.integers(0, 2**32 - 1))
def test_drawn_hull_has_its_centre_and_principal_axes_at_origin(seed: int) -> None:
    piece = drawn_hull(np.random.default_rng(seed), 0.045)
    mass = solid((piece,), 0.2)
    off = mass.inertia - np.diag(np.diag(mass.inertia))
    assert np.abs(mass.centre).max() < 1e-12 and np.abs(off).max() < 1e-12 * np.abs(mass.inertia).max() + 1e-18
    # the centre of mass lies inside the ball that the corners are drawn from
    assert isinstance(piece.shape, ConvexHull) and np.linalg.norm(piece.shape.vertices, axis=1).max() < 2.0 * 0.045


def test_a_prism_has_the_moments_of_its_circle_as_its_sides_grow() -> None:
    inertia = solid((prism(200, 0.03, 0.01),), 2.0).inertia
    assert inertia[2, 2] == pytest.approx(0.5 * 2.0 * 0.03**2, rel=1e-3)
    assert inertia[0, 0] == pytest.approx(2.0 * (3.0 * 0.03**2 + 0.01**2) / 12.0, rel=1e-3)


def test_rigid_hand_has_parts_size_and_weight_of_a_hand() -> None:
    pieces, hand = hand_pieces(), rigid_hand()
    (link,), sample = hand.links, rest((hand,))
    assert len(pieces) == 15 == 1 + sum(len(digit.bones) for digit in DIGITS)
    for piece in pieces:
        assert isinstance(piece.shape, ConvexHull) and len(QuickHull(piece.shape.vertices).simplices) == 100
    assert isinstance(link.joint, Free) and link.material == "human" and link.mass.mass == pytest.approx(MASS)
    length, width, thickness = (
        float(reach((hand,), (sample,), axis)[0] + reach((hand,), (sample,), -axis)[0]) for axis in np.eye(3)
    )
    assert 0.18 < length < 0.21 and 0.08 < width < 0.15 and 0.02 < thickness < 0.05
    # the palm is level, so that it lies flat on a table
    assert reach((hand,), (sample,), (0.0, 0.0, -1.0))[0] == pytest.approx(0.0157, abs=2e-4)
