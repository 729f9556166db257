"""Probes: a clip of a folder stands free at the start of each room, at the height that its name says; other names are refused."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.model.world import build
from avatarsim.pose_queries import require_free
from scenarios.building.reach import reach
from scenarios.motion.track import LEAD_IN
from scenarios.posture_table import probes
from scenarios.scenario import RENDERED


@pytest.fixture(autouse=True)
def clips(tmp_path: Path) -> Iterator[Path]:
    """One clip: the humanoid upright, a hand's breadth above where it would stand, carried 1 m to the left in half a second."""
    turn = [1.0, 0.0, 0.0, 0.0]
    joints = [*turn, *turn, *turn, *turn, 0.0, *turn, *turn, 0.0, *turn, 0.0, *turn, *turn, 0.0]
    frames = [[RENDERED, 0.0, 1.0, -k / 30.0, *joints] for k in range(31)]
    (tmp_path / "humanoid3d_slide.txt").write_text(json.dumps({"Loop": "none", "Frames": frames}))
    probes.use(tmp_path)
    yield tmp_path
    probes.use(None)


def test_every_clip_stands_in_three_rooms_at_two_heights() -> None:
    names = probes.names()
    assert len(names) == 6 and "probe_gallery_afloat_slide" in names
    assert {probes.group_of(name) for name in names} == {name.removesuffix("_slide") for name in names}


@pytest.mark.parametrize("name", [f"probe_{room}_sunk_slide" for room in ("wall", "gallery", "corridor")])
def test_a_probe_starts_free_and_leads_ahead(name: str) -> None:
    scenario = probes.get(name)
    scene = scenario.build()
    require_free(build(scene))
    motion = scenario.motion(scene, 0)
    assert scenario.frames == LEAD_IN + 62
    positions = np.array([motion(k).positions[0] for k in range(scenario.frames)])
    # there and back: the last posture but one is the second of the clip
    assert np.allclose(positions[-2], positions[LEAD_IN], atol=1e-12)
    if "gallery" not in name:
        way = positions[LEAD_IN + 30] - positions[LEAD_IN]
        assert way == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(("height", "lowest"), [("sunk", -0.05), ("afloat", 0.03)])
def test_the_soles_are_as_high_as_the_name_says(height: str, lowest: float) -> None:
    scenario = probes.get(f"probe_corridor_{height}_slide")
    scene = scenario.build()
    sample = scenario.motion(scene, 0)(LEAD_IN + 10)
    assert reach(scene.avatars, [sample], (0.0, 0.0, -1.0))[0] == pytest.approx(-lowest, abs=1e-9)


def test_the_wall_is_where_half_of_the_clip_is_beyond_it() -> None:
    scenario = probes.get("probe_wall_sunk_slide")
    scene = scenario.build()
    motion = scenario.motion(scene, 0)
    (wall,) = (body for body in scene.bodies if body.name == "wall")
    face = wall.position[0] - 0.1
    ahead = reach(scene.avatars, [motion(LEAD_IN + k) for k in range(31)], (1.0, 0.0, 0.0))
    assert 10 <= (ahead > face).sum() <= 21


def test_names_and_folders_that_there_are_not(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match="probe_wall_sunk_slide"):
        probes.get("probe_wall_sunk_run")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InvalidInput, match="--clips"):
        probes.use(tmp_path / "empty")
