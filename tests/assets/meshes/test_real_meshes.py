"""Meshes from other packages: each is read from its package, and accepted or refused as it deserves."""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from avatarsim.assets.meshes import pieces_of_mesh
from avatarsim.assets.meshes.mesh import groups, read_mesh
from avatarsim.assets.meshes.repairs import mended
from avatarsim.errors import InvalidShape
from avatarsim.scene.shape import ConvexHull
from scenarios.building.gallery import MESHES
from scenarios.data_folder import data_file


def hand(name: str) -> Path:
    """Return a mesh of the Shadow hand in gymnasium-robotics, found without importing it."""
    found = find_spec("gymnasium_robotics")
    assert found is not None and found.submodule_search_locations
    return Path(next(iter(found.submodule_search_locations))) / "envs" / "assets" / "stls" / "hand" / name


@pytest.mark.parametrize("file", sorted({row[0] for row in MESHES.values()} | {
    f"random_urdfs/{k:03}/{k:03}.obj" for k in (1, 150, 500, 777, 999)
}))
def test_decomposed_objects_are_taken_vertex_by_vertex(file: str) -> None:
    found = pieces_of_mesh(data_file(file), 0.02, kept=False)
    assert found.source == "convex groups" and found.repairs == ()
    for piece, (vertices, _) in zip(found.pieces, groups(data_file(file)), strict=True):
        assert isinstance(piece.shape, ConvexHull)
        np.testing.assert_array_equal(piece.shape.vertices, 0.02 * vertices)
    # six digits in the file
    assert found.hausdorff <= 1e-5 * found.size


def test_groups_that_are_not_convex_are_not_taken_as_pieces() -> None:
    with pytest.raises(InvalidShape, match=r"border edges of mug_col\.obj"):
        pieces_of_mesh(data_file("objects/mug_col.obj"))


@pytest.mark.parametrize(("file", "faults"), [
    ("bunny.obj", []), ("torus/torus_textured.obj", []), ("duck.obj", ["crossing"]), ("objects/mug.obj", ["open"]),
])
def test_what_is_sound_and_what_is_not(file: str, faults: list[str]) -> None:
    sound = mended(read_mesh(data_file(file)))
    assert ["open" if fault.open else "crossing" for fault in sound.faults] == faults


def test_the_hull_of_the_bunny_fills_the_space_between_its_ears() -> None:
    found = pieces_of_mesh(data_file("bunny.obj"), 0.1, hull=True, kept=False)
    assert found.source == "hull" and found.vertices == (90,)
    assert 0.10 < found.reached / found.size <= found.hausdorff / found.size < 0.13


@pytest.mark.parametrize("name", ["F1.stl", "F3.stl", "TH1_z.stl", "knuckle.stl"])
def test_links_of_the_hand_as_hulls(name: str) -> None:
    found = pieces_of_mesh(hand(name), 0.001, hull=True, kept=False)
    assert len(found.pieces) == 1 and found.vertices[0] <= 128
    assert 0.02 < found.size < 0.08 and found.hausdorff < 0.13 * found.size
