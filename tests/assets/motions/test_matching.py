"""Columns to joints: by name if the file has names, else by their number; mismatches are named."""

import pytest

from avatarsim.assets.models.coordinates import Coordinates, Slot
from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.matching import Layout, columns, coordinates_of_model
from avatarsim.errors import InvalidFile
from tests.assets.motions.robots import JOINTS


def test_a_body_without_joints_is_driven_by_no_robots_motion() -> None:
    cube = Coordinates((Slot("cube", "free", 0),), 1, 0)
    with pytest.raises(InvalidFile, match="joints of a is '?waist, .*at least one of the avatar's: cube"):
        columns("a", Layout(JOINTS, "wxyz"), 11, cube)
    assert columns("a", Layout(("cube",), "wxyz"), 7, cube).tolist() == [*range(7)]
    assert columns("a", Layout((), "wxyz"), 7, cube).tolist() == [*range(7)]


def test_a_room_has_no_joints() -> None:
    with pytest.raises(InvalidFile, match=r"avatar for a\.csv"):
        coordinates_of_model("a.csv", Model(None, None, (), ()))
