"""Generalized coordinates: rows to a motion and back, link by link and in a file's order; invalid ones are refused by name."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.assets.models.coordinates import coordinates_of
from avatarsim.errors import InvalidInput
from avatarsim.spatial import rotation
from tests.assets.motions.robots import puppet, robot

PUPPET = puppet().coordinates


def rows(frames: int, seed: int) -> np.ndarray:
    """Return rows (frames, 13) of the puppet: a free root, a ball, two hinges."""
    rng = np.random.default_rng(seed)
    root, ball = (rotation.normalised(rng.normal(size=(frames, 4))) for _ in range(2))
    return np.concatenate([rng.normal(size=(frames, 3)), root, ball, rng.normal(size=(frames, 2))], axis=1)


@given(st.integers(1, 6), st.integers(0, 99))
def test_rows_of_a_motion_are_the_rows_that_it_was_made_of(frames: int, seed: int) -> None:
    q = rows(frames, seed)
    motion = PUPPET.motion(q, np.arange(frames) / 30.0)
    assert (PUPPET.rows(motion) == q).all()


@given(st.integers(0, 99), st.floats(0.5, 2.0))
def test_quaternions_become_unit_ones_and_stay_what_they_became(seed: int, length: float) -> None:
    q = rows(3, seed)
    q[:, 3:7] *= length
    once = PUPPET.rows(PUPPET.motion(q, np.arange(3.0)))
    assert np.allclose(np.linalg.norm(once[:, 3:7], axis=1), 1.0, atol=1e-15)
    assert (PUPPET.rows(PUPPET.motion(once, np.arange(3.0))) == once).all()


def test_coordinates_in_file_order_without_reference_angles() -> None:
    coordinates = robot().coordinates
    q = np.array([[0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.3, 0.4]])
    motion = coordinates.motion(q, np.zeros(1))
    assert np.allclose(motion.angles, [[0.1, 0.2, 0.15, 0.3]])
    assert np.allclose(coordinates.rows(motion), q, atol=1e-15)


def test_coordinates_of_an_avatar_are_its_joints_link_by_link() -> None:
    avatar = robot().avatar
    found = coordinates_of(avatar)
    assert found.names == ("pelvis", "torso", "left_arm", "left_forearm", "right_arm")
    assert [slot.hinge for slot in found.slots] == [-1, 0, 1, 2, 3]
    assert (found.links, found.hinges) == (6, 4)


def changed(frame: int, column: int, value: float) -> np.ndarray:
    q = rows(3, 0)
    q[frame, column] = value
    return q


@pytest.mark.parametrize(("q", "says"), [
    (rows(3, 0)[:, :12], "shape of generalized coordinates.*12.*13.: root, head"),
    (rows(3, 0)[0], "shape of generalized coordinates"),
    (changed(1, 12, float("nan")), "column 12 of frame 1"),
    (changed(2, 0, float("inf")), "column 0 of frame 2"),
    (np.concatenate([rows(3, 0)[:, :3], np.zeros((3, 4)), rows(3, 0)[:, 7:]], axis=1), "quaternion of root in frame 0"),
    (np.full((3, 13), "1"), "generalized coordinates"),
    ([[1.0], [1.0, 2.0]], "generalized coordinates"),
])
def test_rows_that_are_none_are_refused_by_name(q: Any, says: str) -> None:
    with pytest.raises(InvalidInput, match=says):
        PUPPET.motion(q, np.arange(3.0))


def test_other_times_and_motions_of_other_avatars_are_refused() -> None:
    with pytest.raises(InvalidInput, match="frames in the"):
        PUPPET.motion(rows(3, 0), np.arange(4.0))
    motion = PUPPET.motion(rows(2, 0), np.arange(2.0))
    with pytest.raises(InvalidInput, match=r"links and hinges.*\(3, 2\).*\(6, 4\)"):
        robot().coordinates.rows(motion)
