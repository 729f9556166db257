"""Files of a run: the mesh of a scene, figures in the meta of a recording, recordings with the arrays still needed."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from avatarsim.errors import InvalidFile
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Piece, Sphere, ellipsoid_hull
from runfiles.files import plain
from runfiles.record import Recording
from scenarios.building.avatars.humanoid import humanoid
from scenarios.measure.side import wrong_side
from scenarios.measure.value import Missing, Value
from scenarios.run.run_files import SCENES, figures, figures_meta, scene_mesh, thinned, write_scene
from scenarios.scenario import Region
from tests.scenarios.examples import drop, drop_scene, fist, fist_scene, resting, with_inside

KINDS = (Sphere(0.1), Capsule(0.1, 0.3), Box((0.1, 0.2, 0.3)), Ellipsoid((0.1, 0.2, 0.3)), ellipsoid_hull((0.1, 0.2, 0.3), 12))
VALUES: dict[str, Value] = {
    "third": 1.0 / 3.0, "numpy": float(np.float64(0.1)), "none": float("nan"), "far": float("-inf"), "minus zero": -0.0,
    "tiny": 5e-324, "absent": Missing("it never came down", "engine"),
}


def test_scene_file_has_every_shape_and_is_written_once(tmp_path: Path) -> None:
    pieces, ball = tuple(Piece(shape, (0.1, 0.0, 0.0)) for shape in KINDS), (Piece(Sphere(0.5)),)
    bodies = fixed("wall", pieces, "wood"), simulated("ball", ball, "wood", solid(ball, 2.0), (0.0, 0.0, 3.0))
    write_scene(Scene("any", bodies), tmp_path, "any")
    path = tmp_path / SCENES / "any.json"
    found = json.loads(path.read_text())
    wall, ball = found["bodies"]
    assert [piece["kind"] for piece in wall["pieces"]] == ["sphere", "capsule", "box", "ellipsoid", "hull"]
    assert np.array(wall["pieces"][4]["vertices"]) == pytest.approx(KINDS[4].vertices, abs=1e-7)
    assert (wall["role"], wall["mass"], ball["role"], ball["mass"]["mass"]) == ("fixed", None, "simulated", 2.0)
    assert found["schema_version"] == 1 and found["gravity"] == [0.0, 0.0, -9.81] and found["parents"] == []
    path.write_text("mine")
    write_scene(Scene("any", bodies), tmp_path, "any")
    assert path.read_text() == "mine"


def test_links_name_their_parents() -> None:
    human = humanoid()
    names = [link.name for link in human.links]
    parents = [None if link.parent is None else names.index(link.parent) for link in human.links]
    assert scene_mesh(Scene("any", (), (human,)))["parents"] == parents


def recording(meta: dict[str, object], overlap: int = 0) -> Recording:
    """Return a recording whose meta was written to a file and read back."""
    return replace(resting(drop_scene(), 3), meta=json.loads(json.dumps(plain(meta))), overlap=np.zeros(overlap))


def test_figures_come_back_to_the_last_bit() -> None:
    values, notes = figures(recording(figures_meta(VALUES, {"third": "every 3rd"})))
    assert repr(values) == repr(VALUES) and notes == {"third": "every 3rd"}


@pytest.mark.parametrize(("meta", "overlap"), [
    ({}, 0), ({"figures": []}, 0), ({"figures": {}, "notes": 3}, 0), ({"figures": {"a": True}, "notes": {}}, 0),
    ({"figures": {"a": "1.0"}, "notes": {}}, 0), ({"figures": {"a": ["why", "weather"]}, "notes": {}}, 0),
    ({"figures": {"a": ["why"]}, "notes": {}}, 0), ({"figures": {"a": None}, "notes": {}}, 0), ({"figures": {}, "notes": {}}, 2),
])
def test_malformed_figures_are_an_invalid_file(meta: dict[str, object], overlap: int) -> None:
    with pytest.raises(InvalidFile, match="recording"):
        figures(recording(meta, overlap))


def test_velocities_are_kept_of_bodies_and_not_of_links() -> None:
    scene, whole = fist_scene(), resting(fist_scene(), 4)
    whole.velocities[:] = 1.0
    kept = thinned(whole, fist(4), scene)
    links = kept.links
    assert np.isnan(kept.velocities[:, links]).all() and np.isnan(kept.angular_velocities[:, links]).all()
    assert kept.velocities[:, : links.start].tolist() == whole.velocities[:, : links.start].tolist()
    assert np.isfinite(whole.velocities).all() and links.stop > links.start


def test_first_snapshot_on_the_wrong_side_of_a_frame_is_kept() -> None:
    scene, base = drop_scene(), resting(drop_scene(), 4)
    positions = np.tile(base.positions[0], (7, 1, 1))
    positions[:, scene.names.index("ball"), 2] = [0.5, 0.6, 1.2, 1.3, 0.7, 1.4, np.nan]
    times = [0.01 * k for k in range(7)]
    whole = with_inside(base, times, [1, 1, 2, 2, 2, 3, 4], ["step"] * 7, positions, np.zeros((7, 2, 3)))
    low = Region(("ball",), (-9.0, -9.0, -9.0), (9.0, 9.0, 1.0), "a ceiling")
    scenario = replace(drop(), regions=(low,))
    kept = thinned(whole, scenario, scene)
    assert kept.inside_frame.tolist() == [2, 3, 4] and kept.inside_time.tolist() == [0.02, 0.05, 0.06]
    assert kept.positions is whole.positions and kept.inside_velocities.shape == (3, 2, 3)
    assert wrong_side(kept, scenario, scene) == wrong_side(whole, scenario, scene)
    assert len(thinned(whole, replace(scenario, regions=()), scene).inside_time) == 0
