"""Mocap bodies and welds of MJCF: doors that move, tools that are attached, and nothing dropped silently."""

from pathlib import Path

import numpy as np
import pytest

import avatarsim as av
from avatarsim.assets.models.model import in_room
from tests.assets.models.test_links_of_tree import written
from tests.assets.motions.robots import Driven, driven

FLOOR = '<geom name="floor" type="plane" size="1 1 1"/>'
ARM = (
    '<body name="base" pos="0 0 .5"><joint type="hinge" axis="0 1 0" range="-115 115"/>'
    '<geom type="capsule" fromto="0 0 0 .4 0 0" size=".04"/>'
    '<body name="wrist" pos=".5 0 0"><joint type="hinge" axis="0 1 0"/><geom type="box" size=".05 .05 .02"/></body></body>'
)
TOOL = '<body name="tool" pos=".5 0 .575"><freejoint/><geom type="box" size=".02 .02 .05"/></body>'
DOOR = '<body name="door" mocap="true" pos="1.5 0 .6"><geom type="box" size=".02 .4 .5"/></body>'
HANDLE = '<body name="handle" pos="1.45 0 .6"><freejoint/><geom size=".02"/></body>'
WELDS = '<equality><weld body1="wrist" body2="tool"/><weld body1="handle" body2="door"/></equality>'


def model_of(folder: Path, rest: str = WELDS) -> Driven:
    """Return the arm with its tool, the door with its handle."""
    return driven(av.load_avatar(written(folder, ARM + TOOL + DOOR + HANDLE + FLOOR, rest)))


def test_a_mocap_body_follows_its_pose_with_what_is_welded_to_it(tmp_path: Path) -> None:
    model = model_of(tmp_path)
    assert [one.name for one in model.moving] == ["door"] and model.start is not None
    scene = model.scene()
    with av.AvatarsimEngine() as engine:
        engine.load(scene, av.Settings(), 1 / 60)
        assert engine.attached() == {"tool": f"{model.avatar.name}/wrist", "handle": "door"}
        place = np.array(model.moving[0].links[0].anchor)
        for frame in range(60):
            place[0] -= 0.005
            sample = av.TrackerSample(frame / 60, model.start.positions, model.start.rotations, np.array([0.2, 0.0]))
            shown = engine.advance(sample, 1 / 60, moving={"door": (place, (1, 0, 0, 0))}).shown.positions
    at = dict(zip(scene.names, shown, strict=True))
    assert at["door"] == pytest.approx(place, abs=1e-4)
    assert at["handle"] == pytest.approx(place - (0.05, 0.0, 0.0), abs=1e-4)
    wrist = at[f"{model.avatar.name}/wrist"]
    assert np.linalg.norm(at["tool"] - wrist) == pytest.approx(0.075, abs=1e-4)


@pytest.mark.parametrize("weld", ['relpose="0 0 1 1 0 0 0"', 'torquescale="0"', 'active="false"'])
def test_a_weld_without_effect_here_attaches_nothing(weld: str, tmp_path: Path) -> None:
    assert not model_of(tmp_path, f'<equality><weld name="far" body1="door" body2="handle" {weld}/></equality>').attached


def test_refuses_a_welded_tool_that_starts_in_something_fixed(tmp_path: Path) -> None:
    """One that starts in what carries it never touches that."""
    weld = '<equality><weld body1="wrist" body2="tool"/></equality>'
    shelf = '<geom name="shelf" type="box" size=".1 .1 .04" pos=".5 0 .65"/>'
    with pytest.raises(av.StartOverlaps) as error:
        av.load_avatar(written(tmp_path, ARM + TOOL + shelf, weld))
    assert [set(pair[:2]) for pair in error.value.pairs] == [{"shelf", "tool"}]
    low = TOOL.replace(".575", ".565")
    model = driven(av.load_avatar(written(tmp_path, ARM + low, weld)))
    assert {frozenset(pair) for pair in model.exclude} >= {frozenset(("tool", f"{model.avatar.name}/wrist"))}
    assert next(body for body in model.bodies if body.name == "tool").position == (0.5, 0.0, 0.565)


def test_a_tool_whose_free_avatar_is_raised_goes_up_with_it(tmp_path: Path) -> None:
    man = '<body name="man" pos="0 0 .08"><freejoint/><geom size=".1"/><body><joint/><geom size=".05" pos="0 0 1"/></body></body>'
    hat = '<body name="hat" pos="0 .2 .08"><freejoint/><geom size=".02"/></body>'
    weld = '<equality><weld body1="man" body2="hat"/></equality>'
    model = av.load_avatar(written(tmp_path, man + hat + FLOOR, weld))
    hat_height = next(body.position[2] for body in model.bodies if body.name == "hat")
    assert model.start is not None
    assert hat_height == pytest.approx(float(model.start.positions[0, 2]), abs=1e-9) and hat_height > 0.09


def test_the_moving_bodies_of_a_room_stand_beside_an_avatar(tmp_path: Path) -> None:
    (tmp_path / "room").mkdir()
    weld = '<equality><weld body1="door" body2="handle"/></equality>'
    room = av.load_room(written(tmp_path / "room", DOOR + HANDLE + FLOOR, weld))
    model = av.load_avatar(written(tmp_path, ARM + '<geom name="door" type="box" size=".1 .1 .1" pos="-1 0 0"/>'))
    both = in_room(model, room)
    assert [one.name for one in both.moving] == ["room_door"] and both.attached == (("handle", "room_door"),)
    assert {"door", "room_door", "handle", "floor"} <= set(both.scene().names)


def test_what_moves_stands_still_where_clips_are_cleaned(tmp_path: Path) -> None:
    model = model_of(tmp_path)
    assert model.start is not None
    rows = 5
    motion = av.Motion(
        np.arange(rows) / 60, np.repeat(model.start.positions[None], rows, axis=0),
        np.repeat(model.start.rotations[None], rows, axis=0), np.zeros((rows, 2)),
    )
    assert {body.name for body in model.room} == {"floor", "tool", "handle", "door"}
    assert len(av.clean(motion, model).motion) >= rows
