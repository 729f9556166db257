"""The file of a scene says what is needed to draw it, and is written once."""

import json
from pathlib import Path

import numpy as np
import pytest

from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Piece, Sphere, ellipsoid_hull
from scenarios.building.avatars.humanoid import humanoid
from scenarios.run import scene_mesh as drawn

KINDS = (Sphere(0.1), Capsule(0.1, 0.3), Box((0.1, 0.2, 0.3)), Ellipsoid((0.1, 0.2, 0.3)), ellipsoid_hull((0.1, 0.2, 0.3), 12))


def scene() -> Scene:
    pieces = tuple(Piece(shape, (0.1, 0.0, 0.0)) for shape in KINDS)
    ball = (Piece(Sphere(0.5)),)
    return Scene("drawn", (fixed("wall", pieces, "wood"), simulated("ball", ball, "wood", solid(ball, 2.0), (0.0, 0.0, 3.0))))


def test_every_kind_of_shape_is_there_with_its_measures(tmp_path: Path) -> None:
    drawn.write(scene(), tmp_path, "any")
    found = json.loads((tmp_path / drawn.FOLDER / "any.json").read_text())
    wall, ball = found["bodies"]
    assert [piece["kind"] for piece in wall["pieces"]] == ["sphere", "capsule", "box", "ellipsoid", "hull"]
    assert np.array(wall["pieces"][4]["vertices"]) == pytest.approx(KINDS[4].vertices, abs=1e-7)
    assert (wall["role"], wall["mass"], ball["role"], ball["mass"]["mass"]) == ("fixed", None, "simulated", 2.0)
    assert found["schema_version"] == drawn.SCHEMA_VERSION and found["gravity"] == [0.0, 0.0, -9.81]
    assert found["parents"] == []


def test_links_name_their_parents() -> None:
    human = humanoid()
    found = drawn.drawn(Scene("drawn", (), (human,)))
    names = [link.name for link in human.links]
    assert found["parents"] == [None if link.parent is None else names.index(link.parent) for link in human.links]


def test_it_is_written_once(tmp_path: Path) -> None:
    (tmp_path / drawn.FOLDER).mkdir()
    (tmp_path / drawn.FOLDER / "any.json").write_text("mine")
    drawn.write(scene(), tmp_path, "any")
    assert (tmp_path / drawn.FOLDER / "any.json").read_text() == "mine"
