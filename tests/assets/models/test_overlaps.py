"""Overlaps at the start: moved apart, guarded, or refused, and that the engine accepts the rest."""

from pathlib import Path

import pytest

import avatarsim as av
from avatarsim.assets.models.overlaps import ALLOWED
from avatarsim.errors import UnknownName
from tests.assets.models.test_links_of_tree import written
from tests.assets.motions.robots import driven

FLOOR = '<geom name="floor" type="plane" size="1 1 1"/>'


def loaded(model: av.Model) -> av.FrameRecord:
    """Return the first record of the model's scene; raises if it is not free."""
    with av.AvatarsimEngine() as engine:
        return engine.load(model.scene(), av.Settings(), dt=1 / 60)


def test_links_that_overlap_may_be_no_deeper_and_are_listed(tmp_path: Path) -> None:
    body = '<body name="a"><freejoint/><geom size="0.1"/><body name="b"><joint/><geom size="0.01" pos="1 0 0"/>' \
           '<body name="c" pos="0.15 0 0"><joint/><geom size="0.1"/></body></body></body>'
    model = av.load_avatar(written(tmp_path, body))
    assert model.avatar is not None and not model.avatar.ignore and not model.at_rest
    ((a, c, depth),) = model.avatar.at_rest
    assert (a, c) == ("a", "c") and depth == pytest.approx(0.05 + ALLOWED)
    loaded(model)


def test_free_avatars_and_loose_bodies_are_raised_out_of_floors(tmp_path: Path) -> None:
    body = '<body name="man" pos="0 0 0.08"><freejoint/><geom size="0.1"/>' \
           '<body><joint/><geom size="0.05" pos="0 0 1"/></body></body>' \
           '<body name="cube" pos="2 0 0.199"><freejoint/><geom type="box" size="0.2 0.2 0.2"/></body>'
    model = av.load_avatar(written(tmp_path, body + FLOOR))
    assert model.start is not None and not model.exclude
    assert model.start.positions[0, 2] == pytest.approx(0.1, abs=1e-3)
    assert loaded(model).shown.positions[1, 2] == pytest.approx(0.2, abs=1e-3)


def test_an_avatar_in_the_ground_is_put_on_its_feet(tmp_path: Path) -> None:
    leg = '<body pos="0 0 -0.5"><joint/><geom type="capsule" size="0.05 0.2"/>' \
          '<body pos="0 0 -0.5"><joint/><geom type="box" size="0.1 0.05 0.05"/></body></body>'
    model = av.load_avatar(written(tmp_path, f'<body name="hip"><freejoint/><geom size="0.1"/>{leg}</body>' + FLOOR))
    assert model.start is not None and not model.exclude
    assert model.start.positions[0, 2] == pytest.approx(1.05, abs=2e-3)
    loaded(model)


@pytest.mark.parametrize("count", [3, 12])
def test_piles_that_start_inside_one_another_are_moved_apart(tmp_path: Path, count: int) -> None:
    """Cubes of 200 mm, each 1.6 mm in the one below."""
    cubes = "".join(
        f'<body name="cube {k}" pos="0 0 {0.0984 + 0.1984 * k}"><freejoint/><geom type="box" size=".1 .1 .1"/></body>'
        for k in range(count)
    )
    model = av.load_room(written(tmp_path, FLOOR + cubes))
    heights = [body.position[2] for body in model.bodies if body.name.startswith("cube")]
    assert not model.exclude and not model.at_rest
    for k, height in enumerate(heights):
        assert 0.0 < height - (0.1 + 0.2 * k) < 2e-4 * (k + 1)
    assert loaded(model).shown.positions[-1, 2] == pytest.approx(heights[-1], abs=1e-3)


def test_loose_bodies_side_by_side_go_sideways(tmp_path: Path) -> None:
    row = "".join(
        f'<body name="ball {k}" pos="{0.19 * k} 0 1"><freejoint/><geom size=".1"/></body>' for k in range(3)
    )
    model = av.load_room(written(tmp_path, FLOOR + row))
    places = [body.position for body in model.bodies if body.name.startswith("ball")]
    gaps = [b[0] - a[0] - 0.2 for a, b in zip(places, places[1:], strict=False)]
    assert all(0.0 < gap < 1e-3 for gap in gaps) and all(place[2] == pytest.approx(1.0, abs=1e-9) for place in places)
    loaded(model)


def test_what_hangs_deep_in_a_wall_is_refused_by_name(tmp_path: Path) -> None:
    cube = '<body name="cube" pos="0 0 1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>'
    with pytest.raises(av.StartOverlaps) as error:
        av.load_room(written(tmp_path, f'<geom name="wall" type="box" size="5 5 5"/>{cube}'))
    assert [set(pair[:2]) for pair in error.value.pairs] == [{"wall", "cube"}]
    # the same without the geom of the wall
    assert not av.load_room(tmp_path / "model.xml", leave=("wall",)).exclude


def test_an_arm_whose_second_link_is_in_its_table_turns_there(tmp_path: Path) -> None:
    body = '<geom name="table" type="box" size="1 1 1" pos="0 0 -1"/><body name="base"><geom size="0.1"/>' \
           '<body name="turn"><joint/><geom size="0.1"/>' \
           '<body name="arm" pos="0 0 0.5"><joint/><geom size="0.1"/></body></body></body>'
    model = driven(av.load_avatar(written(tmp_path, body)))
    assert set(model.exclude) == {("table", f"{model.avatar.name}/base")}
    # the base is fixed like the table, whatever overlaps
    ((table, turn, depth),) = model.at_rest
    assert (table, turn) == ("table", f"{model.avatar.name}/turn") and depth == pytest.approx(0.1 + ALLOWED)
    loaded(model)


def test_a_link_inside_another_is_refused_unless_it_is_excluded(tmp_path: Path) -> None:
    body = '<body name="a"><freejoint/><geom size="0.2"/><body name="b"><joint/><geom size="0.01" pos="1 0 0"/>' \
           '<body name="c"><joint/><geom size="0.02"/></body></body></body>'
    path = written(tmp_path, body)
    with pytest.raises(av.StartOverlaps) as error:
        av.load_avatar(path)
    pairs = tuple(pair[:2] for pair in error.value.pairs)
    model = driven(av.load_avatar(path, exclude=pairs))
    assert model.avatar.ignore == (("a", "c"),) == driven(av.load_avatar(path, exclude=(("a", "c"),))).avatar.ignore
    loaded(model)
    with pytest.raises(UnknownName):
        av.load_avatar(path, exclude=(("a", "d"),))
