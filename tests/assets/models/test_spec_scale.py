"""Other units of length: the same model as one written in metres, masses and kinematics, and refusals."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import avatarsim as av
from avatarsim.errors import InvalidInput
from avatarsim.scene.avatar import Link
from avatarsim.scene.tracker import link_poses
from tests.assets.models.test_links_of_tree import written
from tests.assets.motions.robots import Driven, driven


def body(s: float) -> str:
    """Return a torso with an arm, a stated inertia, a held slide, a loose ball and a floor; lengths are `s` a metre."""
    return (
        f'<geom name="ground" type="box" size="{4 * s} {4 * s} {0.1 * s}" pos="0 0 {-0.1 * s}"/>'
        f'<body name="torso" pos="0 0 {1.2 * s}"><freejoint/>'
        f'<geom type="capsule" size="{0.1 * s}" fromto="0 0 0 0 0 {0.4 * s}" mass="20"/>'
        f'<body name="arm" pos="0 {0.25 * s} {0.4 * s}"><inertial pos="0 0 {-0.1 * s}" mass="2" diaginertia="{0.02 * s * s} '
        f'{0.02 * s * s} {0.01 * s * s}"/><joint name="elbow" axis="1 0 0" range="-60 60" pos="0 0 {0.01 * s}"/>'
        f'<geom type="sphere" size="{0.05 * s}"/>'
        f'<body name="tool" pos="0 0 {-0.2 * s}">'
        f'<joint name="rail" type="slide" axis="0 0 1" range="0 {0.3 * s}" ref="{0.1 * s}"/>'
        f'<geom type="ellipsoid" size="{0.02 * s} {0.03 * s} {0.04 * s}" mass="1"/></body></body></body>'
        f'<body name="ball" pos="{1 * s} 0 {0.5 * s}"><freejoint/><geom type="sphere" size="{0.1 * s}" mass="3"/></body>'
    )


def model(folder: Path, s: float, scale: float) -> Driven:
    """Return the model, written with lengths of `s` a metre."""
    return driven(av.load_avatar(written(folder, body(s)), fix=("rail",), scale=scale, avatar="torso", size_range=(1e-6, 1e6)))


def test_at_scale_it_is_the_model_that_was_written_in_metres(tmp_path: Path) -> None:
    one, other = model(tmp_path, 1.0, 1.0), model(tmp_path, 100.0, 0.01)
    assert [slot.name for slot in one.coordinates.slots] == [slot.name for slot in other.coordinates.slots]
    rests = [[slot.rest for slot in found.coordinates.slots] for found in (one, other)]
    np.testing.assert_allclose(rests[0], rests[1], rtol=1e-9)
    parts: list[list[Link | av.Body]] = [[*found.avatar.links, *found.bodies] for found in (one, other)]
    for mine, theirs in zip(*parts, strict=True):
        assert mine.name == theirs.name
        for a, b in zip(mine.pieces, theirs.pieces, strict=True):
            np.testing.assert_allclose(a.position, b.position, atol=1e-9)
            assert type(a.shape) is type(b.shape)
        if mine.mass is not None and theirs.mass is not None:
            assert mine.mass.mass == pytest.approx(theirs.mass.mass)
            np.testing.assert_allclose(mine.mass.centre, theirs.mass.centre, atol=1e-9)
            np.testing.assert_allclose(mine.mass.inertia, theirs.mass.inertia, rtol=1e-6, atol=1e-12)
    assert one.start is not None and other.start is not None
    for here, there in zip(link_poses((one.avatar,), one.start), link_poses((other.avatar,), other.start), strict=True):
        np.testing.assert_allclose(here, there, atol=1e-9)
    assert one.avatar.span == pytest.approx(other.avatar.span)


@settings(max_examples=6)
@given(scale=st.floats(0.05, 20.0))
def test_what_density_gives_goes_with_the_volume(scale: float, tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = tmp_path_factory.mktemp("density")
    path = written(folder, '<body name="b"><freejoint/><geom type="sphere" size="0.1"/></body>')
    one, other = (driven(av.load_avatar(path, scale=s, size_range=(1e-6, 1e6))).avatar for s in (1.0, scale))
    assert other.links[0].mass.mass == pytest.approx(scale**3 * one.links[0].mass.mass)
    np.testing.assert_allclose(other.links[0].mass.inertia, scale**5 * one.links[0].mass.inertia, rtol=1e-6)


def test_a_room_has_its_scale_too(tmp_path: Path) -> None:
    room = av.load_room(written(tmp_path, body(1.0)), scale=0.5)
    (ball,) = [one for one in room.bodies if one.name == "ball"]
    np.testing.assert_allclose(ball.position, (0.5, 0.0, 0.25))


@pytest.mark.parametrize("scale", [0.0, -1.0, float("nan"), float("inf"), 1e9, "2", None])
def test_a_scale_that_is_none_is_refused(scale: object, tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match=r"metres a unit of length of model\.xml.*0\.0001 to 10000"):
        av.load_avatar(written(tmp_path, body(1.0)), fix="all", scale=scale)  # type: ignore[arg-type]
