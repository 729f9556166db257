"""Overlaps at the reference: what is raised, what is excluded, and that the engine takes what is left."""

from pathlib import Path

import pytest

import avatarsim as av
from tests.assets.models.test_links_of_tree import written

FLOOR = '<geom name="floor" type="plane" size="1 1 1"/>'


def loaded(model: av.Model) -> av.FrameRecord:
    """The first record of the model's scene; raises where it is not free."""
    with av.AvatarsimEngine() as engine:
        return engine.load(model.scene(), av.Settings(), dt=1 / 60)


def test_links_that_overlap_never_touch_and_are_listed(tmp_path: Path) -> None:
    body = '<body name="a"><freejoint/><geom size="0.1"/><body name="b"><joint/><geom size="0.01" pos="1 0 0"/>' \
           '<body name="c" pos="0.15 0 0"><joint/><geom size="0.1"/></body></body></body>'
    model = av.load_avatar(written(tmp_path, body))
    assert model.avatar is not None and model.avatar.ignore == (("a", "c"),)
    assert model.at_rest == ((f"{model.avatar.name}/a", f"{model.avatar.name}/c"),)
    loaded(model)


def test_a_free_avatar_and_a_loose_body_are_raised_out_of_the_floor(tmp_path: Path) -> None:
    body = '<body name="man" pos="0 0 0.08"><freejoint/><geom size="0.1"/>' \
           '<body><joint/><geom size="0.05" pos="0 0 1"/></body></body>' \
           '<body name="cube" pos="2 0 0.199"><freejoint/><geom type="box" size="0.2 0.2 0.2"/></body>'
    model = av.load_avatar(written(tmp_path, body + FLOOR))
    assert model.start is not None and not model.exclude
    assert model.start.positions[0, 2] == pytest.approx(0.1, abs=1e-3)
    assert loaded(model).shown.positions[1, 2] == pytest.approx(0.2, abs=1e-3)


def test_an_avatar_whose_root_lies_in_the_ground_is_put_on_its_feet(tmp_path: Path) -> None:
    leg = '<body pos="0 0 -0.5"><joint/><geom type="capsule" size="0.05 0.2"/>' \
          '<body pos="0 0 -0.5"><joint/><geom type="box" size="0.1 0.05 0.05"/></body></body>'
    model = av.load_avatar(written(tmp_path, f'<body name="hip"><freejoint/><geom size="0.1"/>{leg}</body>' + FLOOR))
    assert model.start is not None and not model.exclude
    assert model.start.positions[0, 2] == pytest.approx(1.05, abs=2e-3)
    loaded(model)


def test_what_hangs_deep_in_a_wall_stays_and_never_touches_it(tmp_path: Path) -> None:
    cube = '<body name="cube" pos="0 0 1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>'
    body = f'<geom name="wall" type="box" size="5 5 5"/>{cube}'
    model = av.load_room(written(tmp_path, body))
    assert model.exclude == (("wall", "cube"),) == model.at_rest and model.bodies[1].position == (0.0, 0.0, 1.0)
    loaded(model)


def test_the_base_of_an_arm_stands_in_its_table(tmp_path: Path) -> None:
    body = '<geom name="table" type="box" size="1 1 1" pos="0 0 -1"/><body name="base"><geom size="0.1"/>' \
           '<body name="turn"><joint/><geom size="0.1"/>' \
           '<body name="arm" pos="0 0 0.5"><joint/><geom size="0.1"/></body></body></body>'
    model = av.load_avatar(written(tmp_path, body))
    assert set(model.exclude) == {("table", f"{model.avatar.name}/base"), ("table", f"{model.avatar.name}/turn")}
    # the base is fixed as the table is, whatever overlaps
    assert model.at_rest == (("table", f"{model.avatar.name}/turn"),)
    loaded(model)
